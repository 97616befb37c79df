// Folds of the faces that are delivered. (count_folds in report.h asks the patch on a grid of its own.)
#pragma once

#include "tripatch/types.h"

namespace tripatch {

/// Degrees between the normals of two triangles at an edge beyond which they lie folded over each other: the measure of the
/// comparisons with other hole fillers.
constexpr double folded_degrees = 120;

/// Edges whose triangles are folded over each other, every face cut into a fan from its first corner. Where an edge has more than
/// two triangles each is compared with the first. vertices: of the mesh; v >= their number is row v - number of `added`.
Index count_folded_edges(const PointsRef& vertices, const PointsRef& added, const Faces& faces);

}  // namespace tripatch
