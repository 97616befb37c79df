// Fills of the parts between creases as one fill of the rim, over one plane.
#pragma once

#include <vector>

#include "tripatch/creases/crease_division.h"

namespace tripatch {

/// fills: of each of the division's loops. Folds and crossings of the whole are not counted.
PlaneFill joined_parts(const VertexLoop& rim, const Division& division, const std::vector<PlaneFill>& fills);

}  // namespace tripatch
