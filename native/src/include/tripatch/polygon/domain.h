// A convex polygon as the domain of a patch of n sides, n from 3 to 12, for two sides a lens, and what every construction over it is made
// of.
//
// Corners are 0 .. n - 1, counterclockwise; side i runs from corner i to corner i + 1, t from 0 to 1. phi_i is the distance from the
// line of side i. With Wachspress's coordinates lambda the parameter t_i = lambda_{i+1} / (lambda_i + lambda_{i+1}) is linear on side i, 0
// on side i - 1 and 1 on side i + 1. Its level lines are those through the point where these two meet (Charrot and Gregory 1984; for a
// triangle the rays from the opposite corner).
//
// The lens lies between two parabolas over the line from corner 0 to corner 1, with s from 0 to 1 along that line. There
// phi_0 = 4 h s (1 - s) + v below and phi_1 = 4 h s (1 - s) - v above, t_0 = s, t_1 = 1 - s, and "inward" is across the line. Next to
// corner 0, phi_1 / (8 h (1 - s)) and phi_0 / (8 h (1 - s)) are what the parameters of the two sides are next to a polygon's corner:
// polynomials of s on the sides, with the sum s. So all that a polygon has is smooth here too, and nothing of it is rational on a side.
#pragma once

#include <array>
#include <vector>

#include "tripatch/math/jet.h"
#include "tripatch/math/plane.h"
#include "tripatch/math/thresholds.h"

namespace tripatch {

/// Sides that a polygon has at most: those of a regular one turn by 30 degrees, and parameters crowd the more the more there are. A choice.
constexpr int max_sides = count::dozen;

/// A point of a polygon seen from all its sides and corners.
template <int N>
struct Place {
  std::array<Jet<N>, max_sides> phi;    ///< distance from the line of each side
  std::array<Jet<N>, max_sides> t;      ///< parameter on each side
  std::array<Jet<N>, max_sides> side;   ///< weights 1 + O(phi_i^2) at side i, O(phi_j^2) at the others; sum 1; 0/0 at corners
  std::array<Jet<N>, max_sides> cubic;  ///< the same with cubes
  std::array<Jet<N>, max_sides>
      corner;     ///< smooth weights of the corners: those of the two ends of a side sum to 1 + O(phi^2) there
  Jet<N> bubble;  ///< smooth, O(phi_i) at each side, 1 at the center
};

/// Products of all factors but one, or but two neighbors, without dividing.
template <int N>
struct Products {
  std::array<Jet<N>, max_sides + 1> upto, from;
  int n;
  Products(const std::array<Jet<N>, max_sides>& f, int count) : n(count) {
    upto[0] = from[n] = Jet<N>(1.0);
    for (int k = 0; k < n; ++k) upto[k + 1] = upto[k] * f[k];
    for (int k = n; k-- > 0;) from[k] = f[k] * from[k + 1];
  }
  Jet<N> all() const { return upto[n]; }
  Jet<N> without(int i) const { return upto[i] * from[i + 1]; }
};

class PolygonDomain {
public:
  PolygonDomain() = default;
  /// Counterclockwise, convex, no angle straight. Throws InvalidArgument otherwise.
  explicit PolygonDomain(std::vector<Vec2> corners);

  /// Two sides: so long from corner to corner, and so high above and below the line between them.
  static PolygonDomain lens(double length, double height);

  int sides() const { return static_cast<int>(corners_.size()); }
  bool is_lens() const { return sides() == 2; }
  double height() const { return height_; }  ///< of a lens, above the line between its corners
  const Vec2& corner(int i) const { return corners_[wrap(i)]; }
  /// Unit vector into the domain in whose direction phi_i grows as the distance does; the normal of a polygon's side.
  const Vec2& inward(int i) const { return inward_[wrap(i)]; }
  Vec2 on_side(int i, double t) const { return (1 - t) * corner(i) + t * corner(i + 1) - 4 * height_ * t * (1 - t) * inward(i); }
  /// The derivative of on_side.
  Vec2 along(int i, double t) const { return corner(i + 1) - corner(i) - 4 * height_ * (1 - 2 * t) * inward(i); }
  double phi(int i, const Vec2& p) const { return phi(i, Jet<0>(p[0]), Jet<0>(p[1])).value(); }
  /// A point moved to the nearest places, about, that lie so far from the lines of all sides.
  Vec2 kept_inside(Vec2 p, double margin = 0) const;
  const Vec2& center() const { return center_; }  ///< of the corners
  double radius() const { return radius_; }       ///< the largest distance of a corner from the center
  int wrap(int i) const { return (i + sides()) % sides(); }

  template <int N>
  Jet<N> phi(int i, const Jet<N>& u, const Jet<N>& v) const {
    const Vec2 &n = inward(i), &p = corner(i);
    const Jet<N> line = n[0] * (u - p[0]) + n[1] * (v - p[1]);
    if (!is_lens()) return line;
    const Jet<N> s = share(u);
    return line + (4 * height_) * (s * (1.0 - s));
  }
  /// t_i from the distances from the lines of sides i - 1 and i + 1.
  template <int N>
  Jet<N> parameter(int i, const Jet<N>& before, const Jet<N>& after) const {
    const Jet<N> a = (1 / reach_[i][0]) * before, b = (1 / reach_[i][1]) * after;
    return a / (a + b);
  }

  /// u, v: a point of the domain that is no corner.
  template <int N>
  Place<N> place(const Jet<N>& u, const Jet<N>& v) const;
  /// The bubble of that place alone.
  template <int N>
  Jet<N> bubble(const Jet<N>& u, const Jet<N>& v) const;
  /// How far along a lens.
  template <int N>
  Jet<N> share(const Jet<N>& u) const {
    return (0.5 / radius_) * (u + radius_);
  }

  /// The corner that a point is (within this share of the radius), or -1.
  int corner_at(const Vec2& p, double share) const;
  /// A point moved away from a corner to this share of the radius, along the ray that it is on; from the corner itself into the middle.
  Vec2 moved_off(int i, const Vec2& p, double share) const;

private:
  template <int N>
  Place<N> place_in_lens(const Jet<N>& u, const Jet<N>& v) const;
  template <int N>
  Jet<N> bubble_in_lens(const std::array<Jet<N>, max_sides>& phi) const {
    return (1 / (height_ * height_)) * (phi[0] * phi[1]);
  }
  /// Wachspress: C_i times the distances from all sides but the two at corner i.
  template <int N>
  Jet<N> corner_product(int i, const std::array<Jet<N>, max_sides>& phi, const Products<N>& products) const;

  std::vector<Vec2> corners_, inward_;
  std::vector<std::array<double, 2>> reach_;  // of side i: distance of its end from side i - 1, of its start from side i + 1
  std::vector<double> turn_;                  // sine of the angle by which the border turns at corner i
  Vec2 center_ = Vec2::Zero();
  double radius_ = 0, bubble_at_center_ = 1;
  double height_ = 0;  // 0: a polygon
};

template <int N>
Place<N> PolygonDomain::place_in_lens(const Jet<N>& u, const Jet<N>& v) const {
  Place<N> p;
  const Jet<N> s = share(u), rest = 1.0 - s;
  for (int i = 0; i < 2; ++i) p.phi[i] = phi(i, u, v);
  p.t[0] = s;
  p.t[1] = rest;
  const std::array<Jet<N>, 2> squares = {square(p.phi[0]), square(p.phi[1])};
  const Jet<N> both = reciprocal(squares[0] + squares[1]), cubes = reciprocal(squares[0] * p.phi[0] + squares[1] * p.phi[1]);
  for (int i = 0; i < 2; ++i) {
    p.side[i] = squares[1 - i] * both;
    p.cubic[i] = squares[1 - i] * p.phi[1 - i] * cubes;
  }
  // what belongs to a corner has bounded parameters at the other, not smooth ones: there its weight is of fourth order
  const auto weight = [](const Jet<N>& x, const Jet<N>& y) {
    return square(square(x)) * (1.0 + 4.0 * y + 10 * square(y) + 20 * (square(y) * y));
  };
  p.corner[0] = weight(rest, s);
  p.corner[1] = weight(s, rest);
  p.bubble = bubble_in_lens(p.phi);
  return p;
}

template <int N>
Place<N> PolygonDomain::place(const Jet<N>& u, const Jet<N>& v) const {
  if (is_lens()) return place_in_lens(u, v);
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
  Jet<N> sum(0.0), corners(0.0);
  for (int i = 0; i < n; ++i) {
    const Jet<N> others = corner_product(i, p.phi, products);
    sum += others;
    p.corner[i] = square(others);
    corners += p.corner[i];
  }
  corners = reciprocal(corners);
  for (int i = 0; i < n; ++i) p.corner[i] *= corners;
  p.bubble = (1 / bubble_at_center_) * (products.all() / sum);
  return p;
}

template <int N>
Jet<N> PolygonDomain::corner_product(int i, const std::array<Jet<N>, max_sides>& phi, const Products<N>& products) const {
  Jet<N> others = turn_[i];
  if (i > 0) return others * (products.upto[i - 1] * products.from[i + 1]);
  for (int k = 1; k < sides() - 1; ++k) others *= phi[k];
  return others;
}

template <int N>
Jet<N> PolygonDomain::bubble(const Jet<N>& u, const Jet<N>& v) const {
  std::array<Jet<N>, max_sides> distances;
  for (int i = 0; i < sides(); ++i) distances[i] = phi(i, u, v);
  if (is_lens()) return bubble_in_lens(distances);
  const Products<N> products(distances, sides());
  Jet<N> sum(0.0);
  for (int i = 0; i < sides(); ++i) sum += corner_product(i, distances, products);
  return (1 / bubble_at_center_) * (products.all() / sum);
}

/// Convex, with angles and sides like those of a hole: turns (radians) are scaled to sum to a whole one and kept from being too small
/// or large, lengths made such that the polygon closes. Mean side 1, center at the origin, side 0 towards +u from below.
PolygonDomain polygon_like(std::vector<double> turns, const std::vector<double>& lengths);

/// A lens with corners like those of a hole, which turn by these angles (radians) in the mean. Mean side 1.
PolygonDomain lens_like(const std::vector<double>& turns);

}  // namespace tripatch
