#include "tripatch/triangulation/plane_triangles.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "tripatch/math/tolerant_compare.h"
#include "tripatch/triangulation/ear_clipping.h"
#include "tripatch/triangulation/min_weight_triangulation.h"

namespace tripatch {
namespace {

Triangles fan(Index corners, Index first) {
  Triangles triangles;
  for (Index k = 1; k + 1 < corners; ++k) triangles.push_back({first, (first + k) % corners, (first + k + 1) % corners});
  return triangles;
}

double turn_of(const PlanePoints& uv, Index a, Index b, Index c) {
  const Eigen::RowVector2d u = uv.row(b) - uv.row(a), v = uv.row(c) - uv.row(a);
  return u[0] * v[1] - u[1] * v[0];
}

/// Whether two edges without a common end cross or touch each other.
bool edges_meet(const PlanePoints& uv, const std::array<Index, 2>& one, const std::array<Index, 2>& other) {
  for (Index a : one)
    for (Index b : other)
      if (a == b) return false;
  const auto parted = [&](const std::array<Index, 2>& by, const std::array<Index, 2>& ends) {
    const Eigen::RowVector2d way = uv.row(by[1]) - uv.row(by[0]);
    const double first = way.dot(uv.row(ends[0]) - uv.row(by[0])), second = way.dot(uv.row(ends[1]) - uv.row(by[0]));
    const bool apart = std::max(first, second) < 0 || std::min(first, second) > way.squaredNorm();  // on one line too
    return apart || turn_of(uv, by[0], by[1], ends[0]) * turn_of(uv, by[0], by[1], ends[1]) > 0;
  };
  return !parted(one, other) && !parted(other, one);
}

/// Along the normal of the whole face.
PlanePoints seen_along_normal(const PointsRef& corners) {
  const Index n = corners.rows();
  const Vec3 origin = corners.row(0);
  Vec3 area = Vec3::Zero();
  for (Index k = 1; k + 1 < n; ++k) area += (Vec3(corners.row(k)) - origin).cross(Vec3(corners.row(k + 1)) - origin);
  const Vec3 up = area.stableNormalized(), u = up.unitOrthogonal(), v = up.cross(u);
  PlanePoints uv(n, 2);
  for (Index k = 0; k < n; ++k) {
    const Vec3 x = Vec3(corners.row(k)) - origin;
    uv.row(k) << x.dot(u), x.dot(v);
  }
  return uv;
}

}  // namespace

bool all_positive(const PlanePoints& uv, const Triangles& triangles) {
  for (const std::array<Index, 3>& t : triangles) {
    const Eigen::RowVector2d a = uv.row(t[1]) - uv.row(t[0]), b = uv.row(t[2]) - uv.row(t[0]);
    if (!(a[0] * b[1] - a[1] * b[0] > tie * a.norm() * b.norm())) return false;  // along straight rims many have no area
  }
  return true;
}

Triangles triangulate_polygon(const PlanePoints& uv, const std::vector<Index>& islands) {
  Points flat = Points::Zero(uv.rows(), 3);
  flat.leftCols(2) = uv;
  RimSurroundings in_plane;
  in_plane.islands = islands;
  Triangles triangles = min_weight_triangulation(flat, in_plane).triangles;
  if (all_positive(uv, triangles)) return triangles;
  return islands.empty() ? cut_ears(uv) : Triangles();
}

Triangles triangulate_bridged(const PlanePoints& uv, const std::vector<Index>& islands) {
  const Index n = uv.rows();
  std::vector<std::vector<Index>> loops(1);
  for (Index k = 0; k < n; ++k) {
    if (std::ranges::count(islands, k) > 0) loops.emplace_back();
    loops.back().push_back(k);
  }
  std::vector<std::array<Index, 2>> edges;
  for (const std::vector<Index>& loop : loops)
    for (std::size_t k = 0; k < loop.size(); ++k) edges.push_back({loop[k], loop[(k + 1) % loop.size()]});
  for (std::size_t k = 0; k < edges.size(); ++k)
    for (std::size_t j = 0; j < k; ++j)
      if (edges_meet(uv, edges[k], edges[j])) return {};
  std::vector<Index> joined = loops[0];
  loops.erase(loops.begin());
  while (!loops.empty()) {
    double least = std::numeric_limits<double>::infinity();
    std::size_t from = 0, which = 0, to = 0;
    for (std::size_t i = 0; i < joined.size(); ++i)
      for (std::size_t l = 0; l < loops.size(); ++l)
        for (std::size_t j = 0; j < loops[l].size(); ++j) {
          const double length = (uv.row(joined[i]) - uv.row(loops[l][j])).norm();
          const std::array<Index, 2> bridge = {joined[i], loops[l][j]};
          if (!(length < least) || std::ranges::any_of(edges, [&](const auto& edge) { return edges_meet(uv, bridge, edge); }))
            continue;
          least = length;
          from = i, which = l, to = j;
        }
    if (!std::isfinite(least)) return {};
    std::vector<Index> loop = loops[which];
    std::ranges::rotate(loop, loop.begin() + static_cast<std::ptrdiff_t>(to));
    edges.push_back({joined[from], loop[0]});
    loop.push_back(loop[0]);
    loop.push_back(joined[from]);
    joined.insert(joined.begin() + static_cast<std::ptrdiff_t>(from) + 1, loop.begin(), loop.end());
    loops.erase(loops.begin() + static_cast<std::ptrdiff_t>(which));
  }
  Triangles triangles = cut_ears(uv(joined, Eigen::all), true);
  for (std::array<Index, 3>& t : triangles)
    for (Index& v : t) v = joined[static_cast<std::size_t>(v)];
  return triangles;
}

Triangles triangulate_face(const PointsRef& corners) {
  const Index n = corners.rows();
  const auto across = [&](Index a, Index b) { return (corners.row(a) - corners.row(b)).squaredNorm(); };
  const Index first = n == 4 && clearly_less(across(1, 3), across(0, 2)) ? 1 : 0;
  Triangles plain = fan(n, first);
  if (n == 3) return plain;
  const PlanePoints uv = seen_along_normal(corners);
  if (!uv.allFinite() || all_positive(uv, plain)) return plain;
  if (n == 4) {
    Triangles other = fan(n, 1 - first);
    return all_positive(uv, other) ? other : plain;
  }
  Triangles cut = triangulate_polygon(uv);
  return cut.empty() ? plain : cut;
}

}  // namespace tripatch
