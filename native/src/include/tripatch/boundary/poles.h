// Poles of what surrounds a hole, where its sides end.
#pragma once

#include "tripatch/boundary/side.h"

namespace tripatch {

/// The side where its surroundings have a pole at an end, as a CAD face of three edges in four-sided parameters has: the plane there, which
/// is rounding, is continued from next to it. All others stay as they are, bit for bit.
Side without_poles(Side side);

}  // namespace tripatch
