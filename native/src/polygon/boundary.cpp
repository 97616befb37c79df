#include "tripatch/polygon/boundary.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "tripatch/boundary/ribbon.h"
#include "tripatch/math/angle.h"

namespace tripatch {
namespace {

double size_of(const SideList& sides) {
  std::vector<Vec3> points;
  for (const Side& side : sides)
    for (int k = 0; k < 8; ++k) points.push_back(side.c(k / 8.0));
  double size = 0;
  for (const Vec3& p : points)
    for (const Vec3& q : points) size = std::max(size, (p - q).norm());
  return size;
}

/// The turn of the rim between two directions about a normal, degrees, negative where the hole is not convex.
double turn_about(const Vec3& before, const Vec3& after, const Vec3& normal) {
  const double turn = degrees_between(before, after);
  return before.cross(after).dot(normal) < 0 && turn < 179 ? -turn : turn;
}

/// v as a combination of a and b.
Vec2 combination(const Vec2& a, const Vec2& b, const Vec2& v) {
  const double det = a[0] * b[1] - a[1] * b[0];
  return {(v[0] * b[1] - v[1] * b[0]) / det, (a[0] * v[1] - a[1] * v[0]) / det};
}

}  // namespace

SideList closed(SideList sides) {
  const int n = static_cast<int>(sides.size());
  if (n < 2 || n > most_sides)
    throw InvalidArgument("a patch has from 2 to " + std::to_string(most_sides) + " sides; " + std::to_string(n) + " are given");
  const double size = size_of(sides);
  if (!(size > 0)) throw Refusal("The sides have no length");
  std::vector<Vec3> corner(n);
  for (int k = 0; k < n; ++k) {
    const int before = (k + n - 1) % n;
    const Vec3 end = sides[before].c(1), start = sides[k].c(0);
    if (!((end - start).norm() <= 1e-6 * size))
      throw Refusal("Sides " + std::to_string(before) + " and " + std::to_string(k) + " " +
                    gap_at_corner(k, (end - start).norm()));
    corner[k] = 0.5 * (end + start);
  }
  for (int i = 0; i < n; ++i) {
    const Vec3 start = corner[i] - sides[i].c(0), end = corner[(i + 1) % n] - sides[i].c(1);
    if (!start.isZero(0) || !end.isZero(0)) sides[i] = moved_ends(sides[i], start, end);
  }
  return sides;
}

PolygonBoundary polygon_boundary(const SideList& sides, const PolygonRibbonOptions& options, const PolygonDomain* domain) {
  const int n = static_cast<int>(sides.size());
  PolygonBoundary out;
  out.size = size_of(sides);
  std::vector<double> lengths, turns, share;
  double length = 0;
  for (const Side& side : sides) {
    lengths.push_back(arc_length(side.c));
    length += lengths.back() / n;
  }
  for (int k = 0; k < n; ++k) {
    const Side &in = sides[(k + n - 1) % n], &from = sides[k];
    const Vec3 before = in.c.derivative_at(1), after = from.c.derivative_at(0);
    const Vec3 n_in = in.normal(1), n_out = from.normal(0);
    out.corner_mismatch_deg.push_back(degrees_between(n_in, n_out));
    out.turn_deg.push_back(turn_about(before, after, n_in + n_out));
    turns.push_back(out.turn_deg.back() * std::numbers::pi / 180);
    share.push_back(floor_share(out.turn_deg.back()));
  }
  out.domain = domain ? *domain : polygon_like(turns, lengths);
  const PolygonDomain& d = out.domain;
  for (int i = 0; i < n; ++i) {
    const Side &side = sides[i], &before = sides[(i + n - 1) % n], &after = sides[(i + 1) % n];
    const Vec3 c0 = side.c.derivative_at(0), c1 = side.c.derivative_at(1);
    // the derivative along the inward normal at the two ends, from the two curves that meet there
    const Vec2 along = d.corner(i + 1) - d.corner(i);
    const Vec2 x0 = combination(along, d.corner(i - 1) - d.corner(i), d.inward(i)),
               x1 = combination(-along, d.corner(i + 2) - d.corner(i + 1), d.inward(i));
    const Vec3 tau0 = x0[0] * c0 - x0[1] * before.c.derivative_at(1), tau1 = -x1[0] * c1 + x1[1] * after.c.derivative_at(0);
    const CornerSlope a = corner_slope(side.r(0), c0, -tau0, length, share[i]),
                      b = corner_slope(side.r(1), c1, -tau1, length, share[(i + 1) % n]);
    PolygonRibbon ribbon;
    ribbon.c = side.c;
    ribbon.alpha = PiecewisePolynomial::linear(a.alpha, b.alpha);
    ribbon.beta = PiecewisePolynomial::linear(a.beta, b.beta);
    const double bulge = options.bulge.empty() ? 1 : options.bulge[i];
    if (bulge != 1) {
      const double e = (bulge - 1) * 16 / 6;  // 16 t^2 (1 - t)^2 in Bernstein form
      const std::array<double, 5> net = {1, 1, 1 + e, 1, 1};
      ribbon.alpha = PiecewisePolynomial::bezier(net, 1) * ribbon.alpha;
    }
    if (!options.tangent.empty() && !options.tangent[i]) {
      std::array<double, 6> net;
      Vec3::Map(net.data()) = tau0;
      Vec3::Map(net.data() + 3) = tau1;
      ribbon.d = PiecewisePolynomial::bezier(net, 3);
    } else {
      ribbon.d = -1.0 * (ribbon.alpha * side.r + ribbon.beta * side.c.derivative());
    }
    out.ribbons.push_back(std::move(ribbon));
  }
  return out;
}

}  // namespace tripatch
