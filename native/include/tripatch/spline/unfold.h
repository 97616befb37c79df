// Folds of a few triangles beside a noisy rim, where the surface passes the rim's vertices at the noise's distance.
#pragma once

#include <array>
#include <vector>

#include "tripatch/report/folded_triangles.h"

namespace tripatch {

/// Moves vertices of folded edges (report/folded_triangles.h) from row `fixed` on to the middle of their neighbors until no more
/// than `allowed` edges are folded. Points stay as they are where that does not succeed, or where more than a few are folded:
/// returns how many edges are folded then.
Index unfold(Points& points, const std::vector<std::array<Index, 3>>& triangles, Index fixed, Index allowed,
             std::span<const FaceBeyond> beyond = {});

}  // namespace tripatch
