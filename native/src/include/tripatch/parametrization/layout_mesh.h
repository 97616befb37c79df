// Triangles in space as what is laid into the plane: connected, without inner holes, a disc.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "tripatch/types.h"

namespace tripatch {

/// The triangles connected across edges with the first one, by their own count of vertices, its inner holes closed.
struct LayoutMesh {
  using Triangle = std::array<int, 3>;
  std::vector<Triangle> triangles;  // the first `real` of them are the caller's
  std::size_t real = 0;
  std::vector<Index> vertices;           // of the caller; those added to close holes come after them
  int count = 0;                         // of vertices, with those added
  std::vector<std::vector<int>> filled;  // the loops; loop k is closed by vertex vertices.size() + k
  std::vector<int> border;               // the outer one, as the triangles traverse it
};

/// None where it is no disc even so, see parametrize(). Throws InvalidArgument for triangles of rows that the points do not have.
std::optional<LayoutMesh> make_layout_mesh(const PointsRef& points, const std::vector<std::array<Index, 3>>& triangles);

}  // namespace tripatch
