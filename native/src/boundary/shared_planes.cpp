#include "tripatch/boundary/shared_planes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>

#include "tripatch/boundary/mesh_sides.h"
#include "tripatch/estimate/corner_planes.h"
#include "tripatch/hole/corners.h"
#include "tripatch/hole/rim_checks.h"
#include "tripatch/math/angle.h"
#include "tripatch/math/parallel.h"

namespace tripatch {
namespace {

using SeenPlanes = std::map<Index, std::vector<SeenPlane>>;

/// Variance of a normal by rounding.
constexpr double rounding_of_normals = std::numeric_limits<double>::epsilon() * std::numeric_limits<double>::epsilon();

/// Three places of a rim of n vertices among which a vertex is read: it lies on a side between two of its corners, or is one.
std::array<Index, 3> corners_about(Index place, Index n, const std::vector<Index>& corners) {
  const Index count = static_cast<Index>(corners.size());
  if (count < 3) return {place, (place + n / 3) % n, (place + n - n / 3) % n};
  const Index after = std::upper_bound(corners.begin(), corners.end(), place) - corners.begin();  // of the next corner
  const auto at = [&](Index k) { return corners[(k + count) % count]; };
  const bool is_corner = at(after - 1) == place;
  return is_corner ? std::array{at(after - 2), place, at(after)} : std::array{at(after - 1), at(after), at(after + 1)};
}

/// The planes at some vertices of a rim: of a corner those of both sides.
void look_at(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& given, const std::set<Index>& vertices,
             PlanesOfRim of_rim, SeenPlanes& seen) {
  std::vector<Index> rim = check_topology(around, given);
  std::rotate(rim.begin(), std::min_element(rim.begin(), rim.end()), rim.end());
  const std::vector<SeenPlane> known = of_rim ? of_rim(mesh, around, rim) : std::vector<SeenPlane>();
  for (std::size_t k = 0; k < known.size(); ++k)
    if (vertices.contains(rim[k])) seen[rim[k]].push_back(known[k]);
  if (!known.empty()) return;
  const Index n = static_cast<Index>(rim.size());
  std::vector<Index> corners = detect_corners(mesh, around, rim);
  std::sort(corners.begin(), corners.end());
  std::map<std::array<Index, 3>, std::vector<Index>> read;  // places by the corners among which they are
  for (Index place = 0; place < n; ++place) {
    if (!vertices.contains(rim[place])) continue;
    std::array<Index, 3> among = corners_about(place, n, corners);
    std::sort(among.begin(), among.end());
    read[among].push_back(place);
  }
  for (const auto& [among, places] : read) {
    Hole hole;
    for (Index k = 0; k < n; ++k) hole.rim.push_back(rim[(among[0] + k) % n]);
    hole.corners = {0, among[1] - among[0], among[2] - among[0]};
    const MeshSides three = mesh_sides(mesh, around, hole);
    for (int i = 0; i < 3; ++i) {
      const std::vector<Index> side = hole.side(i);
      for (std::size_t k = 0; k < side.size(); ++k)
        if (std::ranges::any_of(places, [&](Index place) { return rim[place] == side[k]; }))
          seen[side[k]].push_back({three.sides[i].normal(three.parameters[i][k]), three.slope_variances[i][k]});
    }
  }
}

/// The mean of planes; zero where they are several.
Vec3 mean_of(const std::vector<SeenPlane>& planes) {
  Vec3 sum = Vec3::Zero();
  for (const SeenPlane& each : planes) sum += each.normal / (each.variance + rounding_of_normals);
  const Vec3 mean = sum.stableNormalized();
  const auto is_off = [&](const SeenPlane& each) {
    const double angle = angle_between(each.normal, mean), deviation = std::sqrt(each.variance + rounding_of_normals);
    return !is_one_plane(angle * 180 / std::numbers::pi, angle / deviation);
  };
  return std::ranges::any_of(planes, is_off) ? Vec3::Zero() : mean;
}

}  // namespace

VertexPlanes shared_planes(const Mesh& mesh, const Connectivity& around, std::span<const std::vector<Index>> rims,
                           PlanesOfRim of_rim) {
  std::vector<Index> vertices;
  for (const std::vector<Index>& rim : rims) vertices.insert(vertices.end(), rim.begin(), rim.end());
  std::sort(vertices.begin(), vertices.end());
  std::set<Index> several;
  for (std::size_t k = 1; k < vertices.size(); ++k)
    if (vertices[k] == vertices[k - 1]) several.insert(vertices[k]);
  if (several.empty()) return {};
  std::vector<std::set<Index>> shared(rims.size());
  for (std::size_t k = 0; k < rims.size(); ++k)
    for (Index v : rims[k])
      if (several.contains(v)) shared[k].insert(v);
  std::vector<SeenPlanes> by_rim(rims.size());
  const auto look = [&](Index k) {
    if (shared[k].empty()) return;
    try {
      look_at(mesh, around, rims[k], shared[k], of_rim, by_rim[k]);
    } catch (const Refusal&) {  // told when it is filled
      by_rim[k].clear();
    }
  };
  each_at_once(static_cast<Index>(rims.size()), look, true);
  SeenPlanes seen;
  std::map<Index, int> told;
  for (const SeenPlanes& each : by_rim)
    for (const auto& [v, planes] : each) {
      seen[v].insert(seen[v].end(), planes.begin(), planes.end());
      ++told[v];
    }
  VertexPlanes planes;
  for (const auto& [v, all] : seen)
    if (const Vec3 mean = mean_of(all); told[v] > 1 && mean.norm() > 0) planes[v] = mean;
  return planes;
}

}  // namespace tripatch
