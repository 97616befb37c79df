// An edge by its vertices, whichever way it is traversed.
#pragma once

#include <algorithm>
#include <array>

#include "tripatch/types.h"

namespace tripatch {

using EdgeKey = std::array<Index, 2>;  ///< the lower vertex first
inline EdgeKey edge_key(Index a, Index b) { return {std::min(a, b), std::max(a, b)}; }

}  // namespace tripatch
