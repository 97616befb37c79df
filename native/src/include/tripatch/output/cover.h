// A patch covered with faces: barycentric coordinates that match the rim, and how they become the faces of a fill.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "tripatch/hole/hole.h"
#include "tripatch/mesh/connectivity.h"
#include "tripatch/messages.h"
#include "tripatch/output/fill_result.h"
#include "tripatch/patch/surface.h"
#include "tripatch/types.h"

namespace tripatch {

/// Rows of barycentric coordinates, the first `rim` of them around, and faces by row.
struct Cover {
  Points barycentric;
  Index rim = 0;
  Faces faces;
  std::vector<Index> rim_vertices;  ///< of the mesh, one a rim row; -1 where an edge was split
  std::vector<std::array<Index, 2>> split_edges;
  std::vector<double> split_t;
  std::vector<Index> poles;  ///< rows inside where other than four quads meet
  int rows = 0;              ///< extra rows of quads
  Messages warnings;
};

/// parameters, resolution: see triangulate. mesh: whose edges the fill must not have inside; none where it is a mesh of its own.
Cover cover_with_triangles(const Hole& hole, const std::array<std::vector<double>, 3>& parameters, const Surface& patch,
                           std::optional<int> resolution, const Connectivity* mesh);

/// Vertices, normals and faces of a fill that has its patch: faces of the mesh, of `vertices` vertices, whose rim is reused, or with
/// a border (its points, from corner 0 on) a mesh of its own.
void deliver(Cover cover, const Points& border, Index vertices, Fill& fill);

}  // namespace tripatch
