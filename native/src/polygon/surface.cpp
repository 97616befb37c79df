#include "tripatch/polygon/surface.h"

#include <cmath>
#include <memory>
#include <numbers>

#include "tripatch/math/thresholds.h"
#include "tripatch/patch/side_weights.h"

namespace tripatch {
namespace {

PiecewisePolynomial ramp(double a, double b) {
  const std::array<double, 2> net = {a, b};
  return PiecewisePolynomial::bezier(net, 1);
}

/// Cubic with these values and derivatives at 0 and 1.
PiecewisePolynomial hermite(const std::array<Vec3, 2>& value, const std::array<Vec3, 2>& derivative) {
  std::array<double, 12> net;
  Vec3::Map(net.data()) = value[0];
  Vec3::Map(net.data() + 3) = value[0] + derivative[0] / 3;
  Vec3::Map(net.data() + 6) = value[1] - derivative[1] / 3;
  Vec3::Map(net.data() + 9) = value[1];
  return PiecewisePolynomial::bezier(net, 3);
}

/// Of the longer derivative along the two sides at a corner: a larger twist is that of a hook, a side that turns within a small part of
/// its length, and says nothing of the patch away from it.
constexpr double max_twist = factor::large;
/// What is left of it then dies away along the side so fast that it comes to this share of that derivative, or as fast as this degree
/// lets it.
constexpr double max_left = share::fifth;
constexpr int fastest_degree = 40;

/// Where the two sides at a corner twist by a and b, one of which may hook there: then nearer to the lesser, at most twice as much.
/// size: the longer derivative along them.
Vec3 twist_between(const Vec3& a, const Vec3& b, double size) {
  if (std::max(a.norm(), b.norm()) <= max_twist * size) return 0.5 * (a + b);
  const Vec3 twist = (b.norm() * a + a.norm() * b) / (a.norm() + b.norm());
  return std::min(1.0, max_twist * size / twist.norm()) * twist;
}

/// Nothing at both ends but this derivative at 0 (or at 1), and dying away from there: of degree 3, but where it is large.
PiecewisePolynomial dying(const Vec3& derivative, bool at_start, double size) {
  const double peak = derivative.norm() / (std::numbers::e * max_left * size);
  const int degree = static_cast<int>(std::clamp(std::ceil(peak), 3.0, static_cast<double>(fastest_degree)));
  std::vector<double> net(3 * (degree + 1), 0.0);
  Vec3::Map(&net[at_start ? 3 : 3 * (degree - 1)]) = (at_start ? 1.0 : -1.0) / degree * derivative;
  return PiecewisePolynomial::bezier(net, 3);
}

/// How the parameters at its two corners change across side i, along it; all are polynomials of t.
struct AcrossSide {
  PiecewisePolynomial to_start, to_end;              ///< 1 over d(1 - t_{i-1}) / d nu and d t_{i+1} / d nu, linear
  PiecewisePolynomial along_to_start, along_to_end;  ///< that times d t_i / d nu, linear too
  std::array<double, 2> start, end, slant;           ///< the values of to_start, to_end and d t_i / d nu at 0 and 1

  AcrossSide(const PolygonDomain& d, int i) {
    if (d.is_lens()) {
      // with the parameters of corners, phi / (8 h (1 - t_i)), in their places
      start = {8 * d.height(), 0};
      end = {0, 8 * d.height()};
      slant = {-1 / start[0], 1 / end[1]};
      to_start = ramp(start[0], start[1]);
      to_end = ramp(end[0], end[1]);
      along_to_start = ramp(-1, -1);
      along_to_end = ramp(1, 1);
      return;
    }
    const auto distance = [&](int side, const Vec2& p) { return d.inward(side).dot(p - d.corner(side)); };
    const double before = d.inward(i - 1).dot(d.inward(i)) / distance(i - 1, d.corner(i + 1)),
                 after = d.inward(i + 1).dot(d.inward(i)) / distance(i + 1, d.corner(i));
    slant = {before, -after};
    const PiecewisePolynomial along = ramp(slant[0], slant[1]);
    const double s = distance(i, d.corner(i - 1)) / distance(i - 2, d.corner(i)),
                 e = distance(i, d.corner(i + 2)) / distance(i + 2, d.corner(i + 1));
    start = {s * distance(i - 2, d.corner(i)), s * distance(i - 2, d.corner(i + 1))};
    end = {e * distance(i + 2, d.corner(i)), e * distance(i + 2, d.corner(i + 1))};
    to_start = ramp(start[0], start[1]);
    to_end = ramp(end[0], end[1]);
    along_to_start = to_start * along;
    along_to_end = to_end * along;
  }
};

class CornerBlend final : public CornerSafeSurface<CornerBlend> {
public:
  explicit CornerBlend(const PolygonBoundary& boundary) : CornerSafeSurface(boundary.domain) {
    const PolygonDomain& d = domain();
    const int n = d.sides();
    std::vector<AcrossSide> across;
    for (int i = 0; i < n; ++i) across.emplace_back(d, i);
    const auto& ribbons = boundary.ribbons;
    // At a corner, coordinates u = t_k along the side that starts there, v = 1 - t_{k-1} along the one that ends there. The derivative
    // by v along the first is start = (d - c' dt/dnu) / (dv/dnu), that by u along the second is `end`.
    const auto field = [&](int i, const PiecewisePolynomial& derivative, bool at_start) {
      const AcrossSide& of = across[i];
      return (at_start ? of.to_start : of.to_end) * derivative -
             (at_start ? of.along_to_start : of.along_to_end) * ribbons[i].c.derivative();
    };
    // What the two sides do not agree on at their corner: values of the derivative across, and twists.
    std::vector<std::array<Vec3, 2>> value(n), slope(n);
    std::vector<double> size(n);  // of the derivatives along the sides at each corner
    for (int k = 0; k < n; ++k) {
      const int in = d.wrap(k - 1), from = k;
      corner_.push_back(ribbons[from].c(0));
      to_next_.push_back(ribbons[from].c.derivative_at(0));
      to_previous_.push_back(-ribbons[in].c.derivative_at(1));
      const auto needed = [&](int i, bool start) {  // of the derivative along nu, by the curves
        const Vec3 dc = ribbons[i].c.derivative_at(start ? 0 : 1);
        const double scale = start ? across[i].start[0] : across[i].end[1], slant = across[i].slant[start ? 0 : 1];
        return Vec3((start ? to_previous_[k] : to_next_[k]) / scale + slant * dc);
      };
      value[from][0] = needed(from, true) - ribbons[from].d(0);
      value[in][1] = needed(in, false) - ribbons[in].d(1);
      // twists with the values mended
      const Vec3 a =
          field(from, ribbons[from].d, true).derivative_at(0) + (across[from].start[1] - across[from].start[0]) * value[from][0];
      const Vec3 b = -field(in, ribbons[in].d, false).derivative_at(1) - (across[in].end[1] - across[in].end[0]) * value[in][1];
      size[k] = std::max(to_next_[k].norm(), to_previous_[k].norm());
      twist_.push_back(boundary.past_hooks ? twist_between(a, b, size[k]) : 0.5 * (a + b));
      slope[from][0] = (twist_[k] - a) / across[from].start[0];
      slope[in][1] = -(twist_[k] - b) / across[in].end[1];
    }
    for (int i = 0; i < n; ++i) {
      rest_.push_back(boundary.past_hooks ? hermite(value[i], {Vec3::Zero(), Vec3::Zero()}) + dying(slope[i][0], true, size[i]) +
                                                dying(slope[i][1], false, size[d.wrap(i + 1)])
                                          : hermite(value[i], slope[i]));
      const PiecewisePolynomial& agreeing = across_.emplace_back(ribbons[i].d + rest_[i]);
      c_.push_back(ribbons[i].c);
      start_.push_back(field(i, agreeing, true));
      end_.push_back(field(i, agreeing, false));
    }
  }

  Vec3 corner(int i) const { return corner_[i]; }

  template <int N>
  JetPoint<N> at(const Jet<N>& u, const Jet<N>& v) const {
    const int n = domain().sides();
    const Place<N> place = domain().place(u, v);
    if (domain().is_lens()) return in_lens(place);
    JetPoint<N> p;
    for (int i = 0; i < n; ++i) {
      const int next = domain().wrap(i + 1), previous = domain().wrap(i - 1);
      const Jet<N>&t = place.t[i], &w0 = place.corner[i], &w1 = place.corner[next];
      p += (w0 + w1) * compose(c_[i], t);
      // across this side: towards the corner where it starts, and where it ends
      p += (w0 * (1.0 - place.t[previous])) * compose(start_[i], t);
      p += (w1 * place.t[next]) * compose(end_[i], t);
      // what both sides at corner i have given
      p -= w0 * shared(i, t, 1.0 - place.t[previous]);
      p -= (place.phi[i] * place.side[i]) * compose(rest_[i], t);
    }
    return p;
  }

private:
  /// What both sides at a corner give.
  template <int N>
  JetPoint<N> shared(int i, const Jet<N>& x, const Jet<N>& y) const {
    const Jet<N> xy = x * y;
    JetPoint<N> both(corner_[i]);
    for (int c = 0; c < 3; ++c) both.x[c] += to_next_[i][c] * x + to_previous_[i][c] * y + twist_[i][c] * xy;
    return both;
  }

  /// Half way between the corners of a lens what they say has gone far: there the two sides are joined by cubics straight across.
  template <int N>
  JetPoint<N> in_lens(const Place<N>& place) const {
    const Jet<N> hill = 4.0 * (place.t[0] * place.t[1]), between = square(square(hill)), beside = 1.0 - between;
    const Jet<N> width = (2 * domain().height()) * hill;
    JetPoint<N> p;
    for (int i = 0; i < 2; ++i) {
      const Jet<N> left = (1 / (8 * domain().height())) * reciprocal(place.t[1 - i]), x = place.phi[1 - i] * left,
                   y = place.phi[i] * left, back = 1.0 - y;
      JetPoint<N> at_corner = compose(c_[i], x);
      at_corner += compose(c_[1 - i], back);
      at_corner += y * compose(start_[i], x);
      at_corner += x * compose(end_[1 - i], back);
      at_corner -= shared(i, x, y);
      p += (beside * place.corner[i]) * at_corner;
      const Jet<N> q = place.phi[i] / width, left_over = 1.0 - q, falling = square(left_over);
      p += (between * falling * (1.0 + 2.0 * q)) * compose(c_[i], place.t[i]);
      p += (between * falling * place.phi[i]) * compose(across_[i], place.t[i]);
      p -= (place.phi[i] * place.side[i]) * compose(rest_[i], place.t[i]);
    }
    return p;
  }

  std::vector<PiecewisePolynomial> c_, start_, end_;
  std::vector<PiecewisePolynomial> across_, rest_;  // the derivative across, and what it has too much for the corners' sake
  std::vector<Vec3> corner_, to_next_, to_previous_, twist_;
};

}  // namespace

SurfacePtr corner_blend(const PolygonBoundary& boundary) { return std::make_shared<CornerBlend>(boundary); }

Points polygon_grid(const PolygonDomain& domain, int rings, std::vector<std::array<Index, 2>>* edges) {
  const int n = domain.sides();
  Points points(1 + static_cast<Index>(n) * rings * rings, 3);
  const auto place = [&](int ring, int k) {
    return ring == 0 ? Index{0} : 1 + static_cast<Index>(ring - 1) * n * rings + k % (n * rings);
  };
  points.setZero();
  points.row(0).head<2>() = domain.center();
  for (int ring = 1; ring <= rings; ++ring)
    for (int k = 0; k < n * rings; ++k) {
      const Vec2 border = domain.on_side(k / rings, static_cast<double>(k % rings) / rings);
      points.row(place(ring, k)).head<2>() = domain.center() + (border - domain.center()) * ring / rings;
      if (!edges) continue;
      edges->push_back({place(ring, k), place(ring, k + 1)});
      edges->push_back({place(ring - 1, k), place(ring, k)});
    }
  return points;
}

}  // namespace tripatch
