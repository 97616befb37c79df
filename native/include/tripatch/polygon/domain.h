// A convex polygon as the domain of a patch of n sides, n from 3 to 12, and what every construction over it is made of.
//
// Corners are 0 .. n - 1, counterclockwise; side i runs from corner i to corner i + 1, t from 0 to 1. phi_i is the distance from the
// line of side i. With Wachspress's coordinates lambda the parameter t_i = lambda_{i+1} / (lambda_i + lambda_{i+1}) is linear on side i, 0
// on side i - 1 and 1 on side i + 1; its level lines are those through the point where these two meet (Charrot and Gregory 1984; for a
// triangle the rays from the opposite corner).
#pragma once

#include <array>
#include <vector>

#include "tripatch/math/jet.h"
#include "tripatch/math/plane.h"

namespace tripatch {


constexpr int most_sides = 12;

/// A point of a polygon seen from all its sides and corners.
template <int N>
struct Place {
  std::array<Jet<N>, most_sides> phi;    ///< distance from the line of each side
  std::array<Jet<N>, most_sides> t;      ///< parameter on each side
  std::array<Jet<N>, most_sides> side;   ///< weights 1 + O(phi_i^2) at side i, O(phi_j^2) at the others; sum 1; 0/0 at corners
  std::array<Jet<N>, most_sides> cubic;  ///< the same with cubes
  std::array<Jet<N>, most_sides>
      corner;     ///< smooth weights of the corners: those of the two ends of a side sum to 1 + O(phi^2) there
  Jet<N> bubble;  ///< smooth, O(phi_i) at each side, 1 at the center
};

class PolygonDomain {
public:
  PolygonDomain() = default;
  /// Counterclockwise, convex, no angle straight. Throws InvalidArgument otherwise.
  explicit PolygonDomain(std::vector<Vec2> corners);

  int sides() const { return static_cast<int>(corners_.size()); }
  const Vec2& corner(int i) const { return corners_[wrap(i)]; }
  const Vec2& inward(int i) const { return inward_[wrap(i)]; }  ///< unit normal of side i
  double length(int i) const { return (corner(i + 1) - corner(i)).norm(); }
  Vec2 on_side(int i, double t) const { return (1 - t) * corner(i) + t * corner(i + 1); }
  const Vec2& center() const { return center_; }  ///< of the corners
  double radius() const { return radius_; }       ///< the largest distance of a corner from the center
  int wrap(int i) const { return (i + sides()) % sides(); }

  template <int N>
  Jet<N> phi(int i, const Jet<N>& u, const Jet<N>& v) const {
    const Vec2 &n = inward(i), &p = corner(i);
    return n[0] * (u - p[0]) + n[1] * (v - p[1]);
  }
  /// t_i from the distances from the lines of sides i - 1 and i + 1.
  template <int N>
  Jet<N> parameter(int i, const Jet<N>& before, const Jet<N>& after) const {
    const Jet<N> a = (1 / reach_[i][0]) * before, b = (1 / reach_[i][1]) * after;
    return a / (a + b);
  }

  /// u, v: a point of the polygon that is no corner.
  template <int N>
  Place<N> place(const Jet<N>& u, const Jet<N>& v) const;

  /// The corner that a point is (within this share of the radius), or -1.
  int corner_at(const Vec2& p, double share) const;
  /// A point moved away from a corner to this share of the radius, along the ray that it is on; from the corner itself into the middle.
  Vec2 moved_off(int i, const Vec2& p, double share) const;

private:
  std::vector<Vec2> corners_, inward_;
  std::vector<std::array<double, 2>> reach_;  // of side i: distance of its end from side i - 1, of its start from side i + 1
  std::vector<double> turn_;                  // sine of the angle by which the border turns at corner i
  Vec2 center_ = Vec2::Zero();
  double radius_ = 0, bubble_at_center_ = 1;
};

/// Products of all factors but one, or but two neighbors, without dividing.
template <int N>
struct Products {
  std::array<Jet<N>, most_sides + 1> upto, from;
  int n;
  Products(const std::array<Jet<N>, most_sides>& f, int count) : n(count) {
    upto[0] = from[n] = Jet<N>(1.0);
    for (int k = 0; k < n; ++k) upto[k + 1] = upto[k] * f[k];
    for (int k = n; k-- > 0;) from[k] = f[k] * from[k + 1];
  }
  Jet<N> all() const { return upto[n]; }
  Jet<N> without(int i) const { return upto[i] * from[i + 1]; }
};

template <int N>
Place<N> PolygonDomain::place(const Jet<N>& u, const Jet<N>& v) const {
  const int n = sides();
  Place<N> p;
  for (int i = 0; i < n; ++i) p.phi[i] = phi(i, u, v);
  for (int i = 0; i < n; ++i) p.t[i] = parameter(i, p.phi[wrap(i - 1)], p.phi[wrap(i + 1)]);
  const Products<N> products(p.phi, n);
  Jet<N> squares(0.0), cubes(0.0);
  for (int i = 0; i < n; ++i) {
    const Jet<N> others = products.without(i);
    p.side[i] = square(others);
    p.cubic[i] = p.side[i] * others;
    squares += p.side[i];
    cubes += p.cubic[i];
  }
  squares = reciprocal(squares);
  cubes = reciprocal(cubes);
  for (int i = 0; i < n; ++i) {
    p.side[i] *= squares;
    p.cubic[i] *= cubes;
  }
  // Wachspress: C_i times the distances from all sides but the two at corner i
  Jet<N> sum(0.0), corners(0.0);
  for (int i = 0; i < n; ++i) {
    Jet<N> others = turn_[i];
    if (i > 0) {
      others *= products.upto[i - 1] * products.from[i + 1];
    } else {
      for (int k = 1; k < n - 1; ++k) others *= p.phi[k];
    }
    sum += others;
    p.corner[i] = square(others);
    corners += p.corner[i];
  }
  corners = reciprocal(corners);
  for (int i = 0; i < n; ++i) p.corner[i] *= corners;
  p.bubble = (1 / bubble_at_center_) * (products.all() / sum);
  return p;
}

/// Convex, with angles and sides like those of a hole: turns (radians) are scaled to sum to a whole one and kept from being too small
/// or large, lengths made such that the polygon closes. Mean side 1, center at the origin, side 0 towards +u from below.
PolygonDomain polygon_like(std::vector<double> turns, const std::vector<double>& lengths);

}  // namespace tripatch
