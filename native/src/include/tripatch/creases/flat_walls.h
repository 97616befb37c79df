// Holes whose rim is flat, in solids with walls.
#pragma once

#include <vector>

#include "tripatch/mesh/connectivity.h"

namespace tripatch {

/// Whether the rim, as new faces traverse it and `across` in diameter, lies in the plane of a wall that continues next to all or some of it, and
/// ends at the rest at an angle or not far from it. Where all around is flat any fill is.
bool is_in_ending_wall(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim, double across);

/// Whether the rim is flat, and the faces next to it are walls that end there at an angle, each with the next or round a straight tube: what is
/// lost is another wall of the solid.
bool walls_end_at_flat_rim(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim, double across);

}  // namespace tripatch
