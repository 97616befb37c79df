// The vertices of a cage where rows of quads around the hole go on.
#pragma once

#include <optional>

#include "tripatch/cage/closed_cage.h"
#include "tripatch/fill/ground.h"

namespace tripatch {

/// Places of the vertices inside a layout that is such rows, in its order: what continues the cage's own points continues the limit surface
/// that they carry. replaced: faces that count as not there. None where rows do not go on in it, or where the surface around it tells more.
std::optional<Points> cage_in_rows(const Ground& ground, const CageHole& laid_out, const std::vector<Index>& replaced);

}  // namespace tripatch
