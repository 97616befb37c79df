// Creases of a cage that enter a hole and leave it again.
#pragma once

#include <array>
#include <vector>

#include "tripatch/boundary/limit_surface.h"
#include "tripatch/cage/closed_cage.h"

namespace tripatch {

struct InnerCrease {
  std::array<Index, 2> edge;  ///< of the closed cage
  double value = 0;
};

/// Edges inside fill `h` on which creases go straight on across it, from one edge of the rim to another or to a vertex inside at which others
/// end. Values run evenly between those at the two ends. whole: of the cage.
std::vector<InnerCrease> creases_through(const ClosedCage& cage, const Connectivity& whole, const CageHole& hole, std::size_t h,
                                         const Subdivision& settings);

}  // namespace tripatch
