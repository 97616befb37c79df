#include "tripatch/estimate/meridian.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "tripatch/estimate/circle.h"
#include "tripatch/estimate/stencils.h"
#include "tripatch/math/angle.h"
#include "tripatch/math/decompositions.h"
#include "tripatch/math/thresholds.h"

namespace tripatch {
namespace {

/// Rim edges by which the vertices that are taken are apart, of which those are that say the least deviation. In uneven triangles in single
/// precision curvature is 2 to 60 times as far off by the first alone, up to 4 times by the first two; without noise they tell the same.
constexpr std::array<double, 3> apart_by = {0.1, 0.4, 1};
/// Vertices of the meridian besides the rim: of profiles that are no conic six leave a seventh of what four do.
constexpr int max_on_meridian = count::half_dozen;

/// Axis and circle of a rim.
struct RimCircle {
  Vec3 center, axis, start;  // axis: about which the rim runs counterclockwise; start: unit, towards the first vertex
  double radius = 0, noise = 0;

  Vec2 radius_and_height(const Vec3& p) const {
    const Vec3 d = p - center;
    const double height = d.dot(axis);
    return {(d - height * axis).norm(), height};
  }
};

std::optional<RimCircle> circle_of(const LocalMesh& w) {
  const Index n = static_cast<Index>(w.rim.size());
  const auto at = [&](Index k) -> const Vec3& { return w.position[w.rim[k % n]]; };
  RimCircle circle;
  Vec3 middle = Vec3::Zero(), area = Vec3::Zero();
  for (Index k = 0; k < n; ++k) middle += at(k) / static_cast<double>(n);
  for (Index k = 0; k < n; ++k) area += (at(k) - middle).cross(at(k + 1) - middle);
  circle.axis = area.stableNormalized();
  circle.start = (at(0) - middle - circle.axis * circle.axis.dot(at(0) - middle)).normalized();
  std::vector<Vec3> points;
  for (int v : w.rim) points.push_back(w.position[v]);
  const Circle seen = circle_along(points, middle, circle.start, circle.axis.cross(circle.start));
  circle.center = seen.center;
  circle.radius = seen.radius;
  circle.start = (at(0) - circle.center).normalized();
  double most = 0;
  for (Index k = 0; k < n; ++k) {
    const double off = (circle.radius_and_height(at(k)) - Vec2(circle.radius, 0)).norm();
    circle.noise += off * off / static_cast<double>(n);
    most = std::max(most, off);
  }
  circle.noise = std::sqrt(circle.noise);
  if (!(most <= tolerance::same * 2 * circle.radius)) return {};
  return circle;
}

/// Turns of the rim's vertices about the axis, where they increase and make a whole one.
std::optional<std::vector<double>> turns_of(const LocalMesh& w, const RimCircle& circle) {
  const Vec3 other = circle.axis.cross(circle.start);
  std::vector<double> turns = {0};
  for (std::size_t k = 1; k < w.rim.size(); ++k) {
    const Vec3 d = w.position[w.rim[k]] - circle.center;
    double turn = std::atan2(d.dot(other), d.dot(circle.start)) / (2 * std::numbers::pi);
    if (turn < 0) ++turn;
    if (!(turn > turns.back())) return {};
    turns.push_back(turn);
  }
  return turns;
}

/// A point of the half-plane, seen from the rim.
struct OnMeridian {
  double distance;
  Vec2 place;
};

/// Which way the faces next to the rim lead.
Vec2 leads_away(const LocalMesh& w, const RimCircle& circle) {
  Vec2 sum = Vec2::Zero();
  for (int f : w.beside)
    for (int v : w.part[f]) sum += circle.radius_and_height(w.position[v]) - Vec2(circle.radius, 0);
  return sum.normalized();
}

/// How far the farthest face next to the rim reaches with its nearest vertex: nearer ones need not lie all around, as on a bent tube, whose inner
/// side is shorter.
double reach_all_around(const LocalMesh& w, const RimCircle& circle) {
  double reach = 0;
  for (int f : w.beside) {
    double nearest = INFINITY;
    for (int v : w.part[f])
      if (std::ranges::find(w.rim, v) == w.rim.end())
        nearest = std::min(nearest, (circle.radius_and_height(w.position[v]) - Vec2(circle.radius, 0)).norm());
    if (std::isfinite(nearest)) reach = std::max(reach, nearest);
  }
  return reach;
}

/// All vertices that smooth edges connect with the rim, nearest first, without the rim's own.
std::vector<OnMeridian> points_around(const LocalMesh& w, const RimCircle& circle) {
  std::vector<char> taken(w.area.size(), 0), met(w.position.size(), 0);
  std::vector<int> faces = w.beside;
  for (int f : faces) taken[f] = 1;
  for (int v : w.rim) met[v] = 1;
  std::vector<OnMeridian> points;
  for (std::size_t at = 0; at < faces.size(); ++at)
    for (int c = w.part.offsets[faces[at]]; c < w.part.offsets[faces[at] + 1]; ++c) {
      if (const int g = w.across[c]; g >= 0 && !std::exchange(taken[g], 1)) faces.push_back(g);
      const int v = w.part.corners[c];
      if (std::exchange(met[v], 1) || w.on_chord[v]) continue;
      const Vec2 place = circle.radius_and_height(w.position[v]) - Vec2(circle.radius, 0);
      points.push_back({place.norm(), place});
    }
  std::sort(points.begin(), points.end(), [](const OnMeridian& a, const OnMeridian& b) { return a.distance < b.distance; });
  return points;
}

/// n . u + (bend . u^2) / 2, nothing on a conic through the rim, with a gradient of length 1 there; n: left of the way along the meridian.
struct Conic {
  Vec2 normal, bend;
  Vec2 along() const { return {normal[1], -normal[0]}; }
  double at(const Vec2& u) const { return normal.dot(u) + 0.5 * bend.dot(u.cwiseAbs2()); }
};

/// The circle, or the meridian of a quadric of revolution, through the rim and two points.
Conic conic_through(double radius, const Vec2& a, const Vec2& b, bool circle) {
  Eigen::Matrix<double, 2, 3> rows;  // of the squares' coefficient or of those of r and z, and of the gradient
  const double size = b.norm();
  for (int k = 0; k < 2; ++k) {
    const Vec2 u = (k == 0 ? a : b) / size;
    if (circle)
      rows.row(k) << u.squaredNorm(), u[0], u[1];
    else
      rows.row(k) << u[0] * u[0] + 2 * radius / size * u[0], u[1] * u[1], u[1];
  }
  const Vec3 x = Vec3(rows.row(0)).cross(Vec3(rows.row(1)));
  Conic conic;
  conic.normal = circle ? Vec2(x[1], x[2]) : Vec2(2 * radius / size * x[0], x[2]);
  conic.bend = (circle ? Vec2(x[0], x[0]) : Vec2(x[0], x[1])) * 2 / size;
  double length = conic.normal.norm();
  if (conic.along().dot(a) < 0) length = -length;
  conic.normal /= length;
  conic.bend /= length;
  return conic;
}

/// What a number of points tell.
struct MeridianReading {
  Vec2 along;
  double curvature = 0, left = 0;  // left: the most that they lie off the conic
  double slope_deviation = 0, curvature_deviation = 0;
  bool valid = false;
};

/// By a conic and the polynomial of the distance through what the points leave of it.
MeridianReading read_by(const Conic& conic, const std::vector<OnMeridian>& points, const std::vector<OnMeridian>& all, int count,
                        double noise) {
  const double reach = points[count - 1].distance;
  Eigen::MatrixXd powers(count, count);
  Eigen::VectorXd off(count);
  MeridianReading out;
  for (int k = 0; k < count; ++k) {
    for (int j = 0; j < count; ++j) powers(k, j) = std::pow(points[k].distance / reach, j + 1);
    off[k] = conic.at(points[k].place);
    if (k >= 2) out.left = std::max(out.left, std::abs(off[k]));
  }
  const Eigen::MatrixXd inverse = SquareSystem(powers).inverse();
  const Eigen::VectorXd x = inverse * off;
  const double sine = x[0] / reach, cosine = std::sqrt(1 - sine * sine);
  if (!(std::abs(sine) < 1)) return out;
  const auto lies_off = [&](const OnMeridian& p) {
    double sum = 0;
    for (int j = count; j-- > 0;) sum = (sum + x[j]) * p.distance / reach;
    return !(std::abs(conic.at(p.place) - sum) <= tolerance::close * p.distance);
  };
  for (const OnMeridian& p : all) {
    if (p.distance > reach) break;
    if (lies_off(p)) return out;
  }
  // y = n . u + bend . u^2 / 2 along the meridian: y' = n . t, y'' = t' bend t + n . c, and the distance is the length but for its cube
  out.along = cosine * conic.along() + sine * conic.normal;
  out.curvature = (2 * x[1] / (reach * reach) - conic.bend.dot(out.along.cwiseAbs2())) / cosine;
  out.slope_deviation = noise * inverse.row(0).norm() / reach;
  out.curvature_deviation = noise * 2 * inverse.row(1).norm() / (reach * reach);
  out.valid = true;
  return out;
}

/// What points apart by so much tell best, where they reach so far.
MeridianReading read_apart(const RimCircle& circle, const std::vector<OnMeridian>& all, double apart, double all_around) {
  std::vector<OnMeridian> points;
  for (const OnMeridian& p : all)
    if (static_cast<int>(points.size()) < max_on_meridian && p.distance >= apart + (points.empty() ? 0 : points.back().distance))
      points.push_back(p);
  MeridianReading best;
  if (points.size() < 3) return best;  // two are on any conic
  std::array<Conic, 2> conics;
  for (int c = 0; c < 2; ++c) conics[c] = conic_through(circle.radius, points[0].place, points[1].place, c == 0);
  std::array<MeridianReading, 2> before;
  for (int count = 2; count <= static_cast<int>(points.size()); ++count) {
    std::array<MeridianReading, 2> now;
    for (int c = 0; c < 2; ++c) now[c] = read_by(conics[c], points, all, count, circle.noise);
    const int c = now[0].valid && !(now[1].valid && now[1].left < now[0].left) ? 0 : 1;
    MeridianReading taken = now[c];
    if (taken.valid && before[c].valid) {  // of three points and more
      const MeridianReading& other = now[1 - c];
      const double counts = other.valid && other.left > 0 ? taken.left / other.left : 0;
      taken.slope_deviation = std::max({taken.slope_deviation, angle_in_plane(taken.along, before[c].along),
                                        counts > 0 ? counts * angle_in_plane(taken.along, other.along) : 0});
      taken.curvature_deviation = std::max({taken.curvature_deviation, std::abs(taken.curvature - before[c].curvature),
                                            counts > 0 ? counts * std::abs(taken.curvature - other.curvature) : 0});
      const bool reaches = points[count - 1].distance >= (1 - tolerance::same) * all_around;
      if (reaches && (!best.valid || taken.curvature_deviation < best.curvature_deviation)) best = taken;
    }
    before = now;
  }
  return best;
}

}  // namespace

std::optional<Meridian> meridian_at(const LocalMesh& w) {
  const std::optional<RimCircle> circle = circle_of(w);
  if (!circle) return {};
  std::optional<std::vector<double>> turns = turns_of(w, *circle);
  if (!turns) return {};
  const std::vector<OnMeridian> points = points_around(w, *circle);
  const double all_around = reach_all_around(w, *circle);
  MeridianReading best;
  for (double apart : apart_by) {
    const MeridianReading read = read_apart(*circle, points, apart, all_around);
    if (read.valid && (!best.valid || read.curvature_deviation < best.curvature_deviation)) best = read;
  }
  if (!best.valid || !(best.along.dot(leads_away(w, *circle)) > same_sheet)) return {};
  Meridian out;
  out.turn = std::move(*turns);
  for (int v : w.rim) {
    const Vec3 d = w.position[v] - circle->center;
    out.normal.push_back((best.along[0] * circle->axis - best.along[1] * (d - circle->axis * circle->axis.dot(d)).normalized()));
  }
  out.curvature = best.curvature / w.scale;
  out.curvature_deviation = best.curvature_deviation / w.scale;
  out.slope_deviation = best.slope_deviation;
  return out;
}

}  // namespace tripatch
