// Triangles of a simple polygon in the plane.
#pragma once

#include <array>
#include <vector>

#include "tripatch/math/plane.h"

namespace tripatch {

/// Of the polygon, counterclockwise, by cutting off ears (Meisters 1975): every triangle counterclockwise, its rows those of the
/// polygon. Empty where the polygon crosses or touches itself. A grid over the reflex vertices keeps the time of 10,000 vertices
/// below that of anything else done with them.
/// bridged: it may touch itself, where edges join its loops to one.
std::vector<std::array<Index, 3>> cut_ears(const PlanePoints& polygon, bool bridged = false);

}  // namespace tripatch
