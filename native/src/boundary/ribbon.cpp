#include "tripatch/boundary/ribbon.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "tripatch/math/angle.h"
#include "tripatch/math/linear.h"
#include "tripatch/math/places.h"
#include "tripatch/math/smoothstep.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/math/tolerant_compare.h"
#include "tripatch/messages.h"

namespace tripatch {
namespace {

/// 1 up to `low`, 0 from `high` on, smooth in between.
double fading(double x, double low, double high) { return smoothstep((high - x) / (high - low)); }

/// Degrees that a rim turns by at a corner: up to the first it is smooth there and takes all of the floor, from the second on none. A round
/// rim between three sides turns by 4 where it has 90 edges; sides of the ten test holes turn by no more than 27 where they have no corner.
constexpr double smooth_turn = angle::slight, corner_turn = angle::crease;
/// From here on a rim turns back on itself: which way is rounding, and it counts as convex.
constexpr double turns_back = angle::reversed;
/// Of what the two tangents at a corner span over what the chords do, 1 for straight sides, 0 on a round rim: up to the first all of the
/// floor is taken, from the second on none. A choice between the two.
constexpr double round_opening = share::tenth, straight_opening = share::half;

/// How much of the floor a triangle's corner takes. An obtuse triangle may turn little and still be an affine image of a plain
/// one, which keeps its alpha (Theorem 2). `opening` tells the two apart: the area that the two tangents span, over that of the
/// chords. It is 1 for straight sides and 0 on a round rim.
double triangle_floor_share(double turn_deg, double opening) {
  return floor_share(turn_deg) * fading(opening, round_opening, straight_opening);
}

/// max(a, b) with a corner rounded over a width of b / 2; a itself where b is 0.
double smooth_max(double a, double b) { return 0.5 * (a + b + std::sqrt((a - b) * (a - b) + 0.25 * b * b)); }

/// Sides that meet to the last bits: a gap, however small, would be divided by the distance from the corner in the derivatives.
Sides closed(Sides sides) {
  std::array<Vec3, 3> corner;
  for (int k = 0; k < 3; ++k) corner[k] = 0.5 * (sides[(k + 1) % 3].c(1) + sides[(k + 2) % 3].c(0));
  for (int i = 0; i < 3; ++i) {
    const Vec3 start = corner[(i + 1) % 3] - sides[i].c(0), end = corner[(i + 2) % 3] - sides[i].c(1);
    if (start.isZero(0) && end.isZero(0)) continue;
    sides[i] = moved_ends(sides[i], start, end);
  }
  return sides;
}

/// Whether the surroundings are degenerate all along: no more than the line of the side itself.
bool no_planes(const Side& side) {
  for (const double t : evenly(8)) {
    const Vec3 r = side.r(t), dc = side.c.derivative_at(t);
    if (r.cross(dc).norm() > tolerance::solved * r.norm() * dc.norm()) return false;
  }
  return true;
}

/// alpha at a corner by equations (10) and (12) as printed, with 0 on the right of their second line.
double printed_alpha(const Vec3& r, const Vec3& dc, const Vec3& tau) {
  return tau.dot(r) * dc.squaredNorm() / r.cross(dc).squaredNorm();
}

/// beta = -alpha A / B, A = r . c', B = c' . c' (eq. 7): the derivative across is orthogonal to the side.
PiecewisePolynomial printed_beta(const Side& side, const PiecewisePolynomial& alpha) {
  return PiecewisePolynomial::fit(
      [&](std::span<const double> t, std::span<double> out) {
        for (std::size_t k = 0; k < t.size(); ++k) {
          double a = 0;
          alpha.taylor(t[k], 0, &a);
          const Vec3 dc = side.c.derivative_at(t[k]);
          out[k] = -a * side.r(t[k]).dot(dc) / dc.squaredNorm();
        }
      },
      1);
}

}  // namespace

double floor_share(double turn_deg) { return fading(turn_deg, smooth_turn, corner_turn); }

CornerSlope corner_slope(const Vec3& r, const Vec3& dc, const Vec3& tau, double height, double share) {
  const double rn = r.norm();
  if (!(rn > tolerance::rounding * height)) return {0, 0, Vec3::Zero()};
  Eigen::Vector2d x;
  if (dc.norm() > tolerance::rounding * height) {
    x = in_frame(r, dc, tau);
  } else {
    x << tau.dot(r) / (rn * rn), 0;
  }
  const double whole = height / rn;  // what an equilateral patch of this size has
  const double kept = share > 0 ? smooth_max(x[0], share * whole) : x[0];
  const double alpha = std::max(kept, tolerance::slight * whole);
  return {alpha, x[1], (alpha - x[0]) * r};
}

Boundary make_boundary(const Sides& given, const RibbonOptions& options) {
  Boundary boundary;
  boundary.size = check_sides(given);
  const Sides sides = closed(given);
  double length = 0;
  for (const Side& side : sides) length += arc_length(side.c) / 3;
  const double unit_height = 0.5 * std::sqrt(3.0), height = unit_height * length;  // of the equilateral triangle of unit side

  std::array<double, 3> share;
  for (int k = 0; k < 3; ++k) {
    const Side& out = sides[(k + 2) % 3];  // starts at corner k
    const Side& in = sides[(k + 1) % 3];   // ends at corner k
    const Vec3 before = in.c.derivative_at(1), after = out.c.derivative_at(0);
    const Vec3 n_in = in.normal(1), n_out = out.normal(0);
    boundary.corner_mismatch_deg[k] = degrees_between(n_in, n_out);
    const double turn = degrees_between(before, after);
    const Vec3 up = before.cross(after);  // across the normals at a corner of a box whose face is gone: a tie
    const bool backwards = up.dot(n_in + n_out) < -tie * up.norm() && turn < turns_back;
    boundary.turn_deg[k] = backwards ? -turn : turn;
    const double tangents = before.cross(after).norm(), chords = (in.c(1) - in.c(0)).cross(out.c(1) - out.c(0)).norm();
    const double opening = backwards || !(chords > 0) ? 0 : tangents / chords;
    share[k] = options.cross_boundary == CrossBoundary::consistent ? triangle_floor_share(boundary.turn_deg[k], opening) : 0;
  }

  for (int i = 0; i < 3; ++i) {
    const Side& side = sides[i];
    const int first = (i + 1) % 3, second = (i + 2) % 3;
    const Vec3 r0 = side.r(0), r1 = side.r(1);
    const Vec3 c0 = side.c.derivative_at(0), c1 = side.c.derivative_at(1);
    Ribbon& ribbon = boundary.ribbons[i];
    ribbon.c = side.c;
    ribbon.rim = side.rim;
    std::array<Vec3, 2> lifted = {Vec3::Zero(), Vec3::Zero()};
    // the derivative in the direction -delta_i, from the two curve tangents at each corner (eqs. 9 and 11)
    const Vec3 tau0 = sides[second].c.derivative_at(1) + 0.5 * c0;
    const Vec3 tau1 = -sides[first].c.derivative_at(0) - 0.5 * c1;
    if (options.cross_boundary == CrossBoundary::given) {
      ribbon.alpha = PiecewisePolynomial::linear(unit_height, unit_height);
      ribbon.beta = PiecewisePolynomial::linear(0, 0);
    } else if (options.cross_boundary == CrossBoundary::as_printed) {
      const double a = printed_alpha(r0, c0, tau0), b = printed_alpha(r1, c1, tau1);
      if (!std::isfinite(a) || !std::isfinite(b)) throw CodedRefusal(Code::printed_slopes_parallel, {{"side", i}});
      ribbon.alpha = PiecewisePolynomial::linear(a, b);
      ribbon.beta = printed_beta(side, ribbon.alpha);
    } else {
      const CornerSlope a = corner_slope(r0, c0, tau0, height, share[first]);
      const CornerSlope b = corner_slope(r1, c1, tau1, height, share[second]);
      if (share[first] > 0) boundary.inward[first] -= 0.5 * a.lifted;
      if (share[second] > 0) boundary.inward[second] -= 0.5 * b.lifted;
      lifted = {a.lifted, b.lifted};
      ribbon.alpha = PiecewisePolynomial::linear(a.alpha, b.alpha);
      ribbon.beta = PiecewisePolynomial::linear(a.beta, b.beta);
    }
    if (options.bulge[i] != 1) {
      const double e = (options.bulge[i] - 1) * 16 / 6;  // 16 t^2 (1 - t)^2 in Bernstein form
      const std::array<double, 5> net = {1, 1, 1 + e, 1, 1};
      const PiecewisePolynomial bump = PiecewisePolynomial::bezier(net, 1);
      ribbon.alpha = bump * ribbon.alpha;
      if (options.cross_boundary == CrossBoundary::as_printed) {  // the only one whose beta has a part that is not linear
        double b0 = 0, b1 = 0;
        ribbon.beta.taylor(0, 0, &b0);
        ribbon.beta.taylor(1, 0, &b1);
        ribbon.beta = PiecewisePolynomial::linear(b0, b1) + bump * (ribbon.beta - PiecewisePolynomial::linear(b0, b1));
      }
    }
    if (options.tangent[i] && no_planes(side)) throw CodedRefusal(Code::side_without_planes, {{"side", i}});
    if (options.tangent[i]) {
      ribbon.d = ribbon.alpha * side.r + ribbon.beta * side.c.derivative();
    } else {  // linear between the corners' own derivatives, kept open at smooth corners
      const Vec3 d0 = tau0 + lifted[0], d1 = tau1 + lifted[1];
      const std::array<double, 6> net = {d0[0], d0[1], d0[2], d1[0], d1[1], d1[2]};
      ribbon.d = PiecewisePolynomial::bezier(net, 3);
    }
    if (!ribbon.c.is_finite() || !ribbon.d.is_finite()) throw CodedRefusal(Code::numbers_overflow);
  }
  return boundary;
}

}  // namespace tripatch
