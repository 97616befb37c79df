// A long rim filled by way of a coarser one.
#pragma once

#include <optional>
#include <vector>

#include "tripatch/spline/plane_fill.h"
#include "tripatch/spline/plane_rim.h"

namespace tripatch {

/// A long rim by way of a coarser one's fill: thousands of triangles lay out slowly. By the places of the vertices on that the field is one
/// through more of them, or where there is noise one fitted to thousands. Nothing where that is no surface of all the surroundings, or
/// triangles on it will not do.
std::optional<PlaneFill> on_coarser_rim(const Mesh& mesh, const Connectivity& around,
                                        const std::vector<std::vector<Index>>& loops, const PlaneFillOptions& options,
                                        const PlaneRim& rim);

}  // namespace tripatch
