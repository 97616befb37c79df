#include "tripatch/polygon/boundary.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "tripatch/boundary/ribbon.h"
#include "tripatch/math/angle.h"
#include "tripatch/math/linear.h"
#include "tripatch/math/places.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/messages.h"

namespace tripatch {
namespace {

/// Degrees by which a rim turns back on itself: which way it turns there is rounding, and it counts as convex.
constexpr double turned_back = angle::reversed;

double size_of(const SideList& sides) {
  std::vector<Vec3> points;
  for (const Side& side : sides)
    for (const double t : evenly(8)) points.push_back(side.c(t));
  double size = 0;
  for (const Vec3& p : points)
    for (const Vec3& q : points) size = std::max(size, (p - q).norm());
  return size;
}

/// The turn of the rim between two directions about a normal, degrees, negative where the hole is not convex.
double turn_about(const Vec3& before, const Vec3& after, const Vec3& normal) {
  const double turn = degrees_between(before, after);
  return before.cross(after).dot(normal) < 0 && turn < turned_back ? -turn : turn;
}

/// v as a combination of a and b.
Vec2 combination(const Vec2& a, const Vec2& b, const Vec2& v) {
  const double det = a[0] * b[1] - a[1] * b[0];
  return {(v[0] * b[1] - v[1] * b[0]) / det, (a[0] * v[1] - a[1] * v[0]) / det};
}

/// A scalar as a field.
template <class F>
PiecewisePolynomial field_of(const F& f) {
  return PiecewisePolynomial::fit(
      [&](std::span<const double> t, std::span<double> out) {
        for (std::size_t k = 0; k < t.size(); ++k) out[k] = f(t[k]);
      },
      1);
}

/// (alpha, beta) in the middle of a side of a lens, such that a circular arc leads from there to the middle of the other.
Vec2 half_way(const PolygonDomain& lens, const Side& side, const Side& other) {
  const Vec3 r = side.r(0.5), gap = other.c(0.5) - side.c(0.5);
  const Vec2 toward = in_frame(r, side.c.derivative_at(0.5), -gap);
  const double turned = std::numbers::pi - degrees_between(r, other.r(0.5)) * std::numbers::pi / 180;
  const double longer = std::pow(std::cos(turned / 4), -2), flat = (toward[0] * r + toward[1] * side.c.derivative_at(0.5)).norm();
  return longer * gap.norm() / (flat * 2 * lens.height()) * toward;
}

/// alpha and beta along a side of a lens: "inward" leans against the side there, and it is the derivative along the normal for which
/// they are linear but for a hill that the middle asks for.
void lean(const PolygonDomain& lens, PolygonRibbon& ribbon, const CornerSlope& from, const CornerSlope& to, const Vec2& middle) {
  const double first = lens.along(0, 0).norm();
  const auto share = [&](double t) { return first / lens.along(0, t).norm(); };
  const auto own = [&](double t) { return -lens.inward(0).dot(lens.along(0, t)) / lens.along(0, t).squaredNorm(); };
  const auto between = [&](double a, double b, double t) { return share(t) * ((1 - t) * a + t * b); };
  const auto hill = [](double t) { return 16 * t * t * (1 - t) * (1 - t); };
  const double a = from.beta - own(0), b = to.beta - own(1);
  const bool known = middle.allFinite() && middle[0] > 0;
  const Vec2 more = known ? Vec2(middle - Vec2(between(from.alpha, to.alpha, 0.5), own(0.5) + between(a, b, 0.5))) : Vec2::Zero();
  ribbon.alpha = field_of([&](double t) { return between(from.alpha, to.alpha, t) + hill(t) * more[0]; });
  ribbon.beta = field_of([&](double t) { return own(t) + between(a, b, t) + hill(t) * more[1]; });
}

/// Places along a side at which it is turned evenly: a choice, a hook over a fiftieth of it has two.
constexpr int hook_places = count::block;

double value_at(const PiecewisePolynomial& scalar, double t) {
  double value = 0;
  scalar.taylor(t, 0, &value);
  return value;
}

/// By how much (radians) a side has turned in its planes more than evenly, at 0, 1 / hook_places, ... 1.
std::vector<double> ahead_of_even(const Side& side) {
  const PiecewisePolynomial first = side.c.derivative(), second = first.derivative();
  const auto turning = [&](double t) {
    const Vec3 along = first(t);
    return second(t).dot(side.normal(t).cross(along)) / along.squaredNorm();
  };
  std::vector<double> turned = {0};
  for (int k = 0; k < hook_places; ++k) {
    const double t = static_cast<double>(k) / hook_places, h = 1.0 / hook_places;
    turned.push_back(turned.back() + h / 6 * (turning(t) + 4 * turning(t + h / 2) + turning(t + h)));
  }
  const double whole = turned.back();
  for (int k = 0; k <= hook_places; ++k) turned[k] -= whole * k / hook_places;
  return turned;
}

/// Linear alpha and beta turn the derivative across a side as the side turns, all of it where it hooks; so that it turns evenly instead.
void turn_evenly(const Side& side, PolygonRibbon& ribbon) {
  const std::vector<double> ahead = ahead_of_even(side);
  std::vector<double> t, alpha, beta;
  for (int k = 0; k <= hook_places; ++k) {
    t.push_back(static_cast<double>(k) / hook_places);
    const Vec3 r = side.r(t[k]), along = side.c.derivative_at(t[k]);
    const Vec3 out = value_at(ribbon.alpha, t[k]) * r + value_at(ribbon.beta, t[k]) * along;
    const Vec2 turned = in_frame(r, along, std::cos(ahead[k]) * out - std::sin(ahead[k]) * side.normal(t[k]).cross(out));
    if (!(turned[0] > 0)) return;  // it would not lead inwards
    alpha.push_back(turned[0]);
    beta.push_back(turned[1]);
  }
  ribbon.alpha = PiecewisePolynomial::spline(t, alpha, 1);
  ribbon.beta = PiecewisePolynomial::spline(t, beta, 1);
}

}  // namespace

SideList closed(SideList sides) {
  const int n = static_cast<int>(sides.size());
  if (n < 2 || n > max_sides)
    throw InvalidArgument("a patch has from 2 to " + std::to_string(max_sides) + " sides; " + std::to_string(n) + " are given");
  const double size = size_of(sides);
  if (!(size > 0)) throw CodedRefusal(Code::sides_without_length);
  if (!std::isfinite(size)) throw CodedRefusal(Code::numbers_overflow);
  std::vector<Vec3> corner(n);
  for (int k = 0; k < n; ++k) {
    const int before = (k + n - 1) % n;
    const Vec3 end = sides[before].c(1), start = sides[k].c(0);
    if (!((end - start).norm() <= tolerance::same * size))
      throw CodedRefusal(Code::sides_apart, {{"first", before}, {"second", k}, {"corner", k}, {"gap", (end - start).norm()}});
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
  out.past_hooks = options.past_hooks;
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
  out.domain = domain ? *domain : n == 2 ? lens_like(turns) : polygon_like(turns, lengths);
  const PolygonDomain& d = out.domain;
  for (int i = 0; i < n; ++i) {
    const Side &side = sides[i], &before = sides[(i + n - 1) % n], &after = sides[(i + 1) % n];
    const Vec3 c0 = side.c.derivative_at(0), c1 = side.c.derivative_at(1);
    // the derivative along the inward normal at the two ends, from the two curves that meet there
    const Vec2 x0 = combination(d.along(i, 0), -d.along(i - 1, 1), d.inward(i)),
               x1 = combination(-d.along(i, 1), d.along(i + 1, 0), d.inward(i));
    const Vec3 tau0 = x0[0] * c0 - x0[1] * before.c.derivative_at(1), tau1 = -x1[0] * c1 + x1[1] * after.c.derivative_at(0);
    const CornerSlope a = corner_slope(side.r(0), c0, -tau0, length, share[i]),
                      b = corner_slope(side.r(1), c1, -tau1, length, share[(i + 1) % n]);
    PolygonRibbon ribbon;
    ribbon.c = side.c;
    ribbon.alpha = PiecewisePolynomial::linear(a.alpha, b.alpha);
    ribbon.beta = PiecewisePolynomial::linear(a.beta, b.beta);
    if (d.is_lens()) lean(d, ribbon, a, b, half_way(d, side, after));
    if (options.past_hooks) turn_evenly(side, ribbon);
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
