// Lists of triangles, while they are made.
#pragma once

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

}  // namespace tripatch
