// A fill for a hole that creases cross: they are continued across it as curves, and each of the parts between them is filled by
// itself, from the surroundings on its side of the creases and the curves' points.
#pragma once

#include <optional>

#include "tripatch/creases/features.h"
#include "tripatch/spline/plane_fill.h"

namespace tripatch {

/// rim: as new faces traverse it; `around` knows all of the mesh. None where a part has no surface, or the parts fold more than the
/// rim does.
std::optional<PlaneFill> fill_across_creases(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim,
                                             const Features& features, const PlaneFillOptions& options);

}  // namespace tripatch
