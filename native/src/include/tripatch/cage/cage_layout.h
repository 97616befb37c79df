// The layout of the new faces of a cage: an even number of edges around, then quads (or triangles, for Loop's scheme) that match.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "tripatch/boundary/limit_surface.h"
#include "tripatch/cage/sided_rim.h"
#include "tripatch/output/quad_cover.h"
#include "tripatch/quads/quad_layout.h"

namespace tripatch {

/// A mesh with the longest edge of each odd rim split in its middle, the holes in it and its creases.
struct SplitMesh {
  struct SplitEdge {
    Index middle;  ///< the new vertex
    std::array<Index, 2> edge;
  };
  Points vertices;  ///< the mesh's own first
  Faces faces;
  std::vector<SidedRim> holes;
  std::vector<std::optional<SplitEdge>> split;  ///< of each hole
  Subdivision settings;
  Mesh mesh() const { return {vertices, faces}; }
};
/// wanted: else everything stays.
SplitMesh split_odd_rims(const Mesh& mesh, const std::vector<SidedRim>& holes, const Subdivision& settings, bool wanted);

/// Of three sides. rows: see quad_layout; triangles follow the rim.
QuadLayout cage_layout(const Hole& hole, const Points& vertices, bool loop, int rows, const std::array<double, 2>& pole_offset);

/// Extra rows that are tried one after the other, until the cage is near enough to its patch. But for an exact rim quads as large as
/// those around come first, whatever is asked for: only with them do the lines of the surroundings continue, as a fair cage needs them.
std::vector<int> rows_to_try(const LayoutOptions& options, bool loop, bool exact);

}  // namespace tripatch
