// Lists of triangles, while they are made.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "tripatch/types.h"

namespace tripatch {

using Triangles = std::vector<std::array<Index, 3>>;

inline Faces faces_of(const Triangles& triangles) {
  Faces faces;
  faces.offsets.reserve(triangles.size() + 1);
  faces.corners.reserve(3 * triangles.size());
  for (const std::array<Index, 3>& t : triangles) faces.add(t);
  return faces;
}

/// Twice the vector area.
template <class Rows>
Vec3 triangle_normal(const Rows& points, const std::array<Index, 3>& t) {
  const Vec3 a = points.row(t[0]), b = points.row(t[1]), c = points.row(t[2]);
  return (b - a).cross(c - a);
}

}  // namespace tripatch
