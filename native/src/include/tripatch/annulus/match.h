// Which points of two closed boundaries belong together.
#pragma once

#include "tripatch/annulus/rib_directions.h"

namespace tripatch {

/// The parameter of the second side for u of the first is match(u) - u: the second runs against the first. Ribs are as short as a turn of one
/// boundary against the other makes them, then lean to neither side of the arcs that their ends ask for.
PiecewisePolynomial match_boundaries(const Side& first, const Side& second, const RibDirections& out_of_first,
                                     const RibDirections& out_of_second);

/// t in [0, 1) of a closed side.
double wrapped_parameter(double t);

}  // namespace tripatch
