// A mesh of triangles with fewer of its own vertices, which stay where they are.
#pragma once

#include <array>
#include <vector>

#include "tripatch/types.h"

namespace tripatch {

struct CoarserMesh {
  std::vector<Index> kept;                      ///< vertices, by rising number
  std::vector<std::array<Index, 3>> triangles;  ///< by place in `kept`
};

/// Edges shorter than `length` (scene units) are collapsed into one of their ends as long as no triangle turns by more than 60 degrees and
/// what is joined to what stays the same. Borders are collapsed along themselves only, and keep eight vertices a loop. Short edges go
/// first, up to lengths that double; among these vertices go by their numbers, each to its nearest.
CoarserMesh decimated(const Points& points, const std::vector<std::array<Index, 3>>& triangles, double length);

}  // namespace tripatch
