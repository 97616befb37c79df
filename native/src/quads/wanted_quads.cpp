#include "tripatch/quads/wanted_quads.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "tripatch/math/angle.h"
#include "tripatch/math/tolerant_compare.h"

namespace tripatch {
namespace {

/// From one direction to another, about an axis: from 0 to a whole turn.
double angle_about(const Vec3& axis, const Vec3& from, const Vec3& to) {
  const double angle = std::atan2(axis.dot(from.cross(to)), from.dot(to) - axis.dot(from) * axis.dot(to));
  return angle < 0 ? angle + 2 * std::numbers::pi : angle;
}

/// Of all that the faces at the k-th vertex of a rim leave, by the angles in its tangent plane, what lies between the rim's edges.
double share_of_rim(const PointsRef& vertices, const Connectivity& around, const std::vector<Index>& rim, std::size_t k) {
  const Index v = rim[k];
  Index next = rim[(k + 1) % rim.size()], previous = rim[(k + rim.size() - 1) % rim.size()];
  if (std::max(next, previous) >= around.vertices()) return 1;  // on an edge
  const auto begins_at = [&](Index w) { return std::ranges::any_of(around.at(v), [&](auto c) { return around.next(c) == w; }); };
  const auto ends_at = [&](Index w) {
    return std::ranges::any_of(around.at(v), [&](auto c) { return around.previous(c) == w; });
  };
  if (begins_at(next) || ends_at(previous)) std::swap(next, previous);  // it was walked backwards
  const auto fans = std::ranges::count_if(around.at(v), [&](auto c) { return !ends_at(around.next(c)); });
  if (fans == 1 && ends_at(next) && begins_at(previous)) return 1;
  const auto way = [&](Index w) -> Vec3 { return (vertices.row(w) - vertices.row(v)).transpose(); };
  Vec3 normal = Vec3::Zero();
  for (const Connectivity::Corner c : around.at(v)) normal += way(around.next(c)).cross(way(around.previous(c)));
  normal = normal.stableNormalized();
  double others = 2 * std::numbers::pi;
  for (const Connectivity::Corner c : around.at(v)) others -= angle_about(normal, way(around.next(c)), way(around.previous(c)));
  const double own = angle_about(normal, way(next), way(previous));
  others = std::max(others - own, 0.0);
  return own > 0 ? own / (own + others) : 1;
}

}  // namespace

double quads_left(const PointsRef& vertices, const Connectivity& around, const std::vector<Index>& rim, std::size_t k,
                  WantedQuads which) {
  const Index v = rim[k];
  if (v >= around.vertices()) return 2;
  double left = 4;
  for (const Connectivity::Corner c : around.at(v)) {
    const Vec3 at = vertices.row(v), next = vertices.row(around.next(c)), previous = vertices.row(around.previous(c));
    const bool counts = which == WantedQuads::by_number && around.faces()[around.face(c)].size() == 4;
    left -= counts ? 1 : angle_between(next - at, previous - at) / (std::numbers::pi / 2);
  }
  return left * share_of_rim(vertices, around, rim, k);
}

std::vector<int> wanted_quads(const PointsRef& vertices, const Connectivity& around, const std::vector<Index>& rim,
                              WantedQuads which) {
  std::vector<int> wanted;
  double owed = 0;
  for (std::size_t k = 0; k < rim.size(); ++k) {
    const double exact = quads_left(vertices, around, rim, k, which);
    const bool whole = coarse(exact) == std::round(exact);
    const int quads = std::max(1, static_cast<int>(std::lround(coarse(exact + (whole ? 0 : owed)))));
    if (!whole) owed += exact - quads;
    wanted.push_back(quads);
  }
  return wanted;
}

}  // namespace tripatch
