// The regular grid of n^2 triangles of a patch whose three sides have n edges each.
#pragma once

#include "tripatch/output/triangulate.h"

namespace tripatch {

/// rim: barycentric coordinates of the rim as in TriangleMesh. None where a triangle would be turned over or squeezed, in the
/// domain or in space.
std::optional<TriangleMesh> regular_grid(const std::array<std::vector<double>, 3>& parameters, const Points& rim,
                                         const Surface& patch);

}  // namespace tripatch
