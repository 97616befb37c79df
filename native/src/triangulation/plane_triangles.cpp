#include "tripatch/triangulation/plane_triangles.h"

#include <Eigen/Geometry>

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
