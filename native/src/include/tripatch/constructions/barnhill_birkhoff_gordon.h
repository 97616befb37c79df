// Boolean sum of cubic lofts with slopes: position and tangent plane along all three sides, reproduces cubics.
// Barnhill, Birkhoff and Gordon 1973 (J. Approx. Theory 8, 114-128); what the data of the two sides disagree about at a corner
// enters by rational terms, after Barnhill and Gregory 1975 (J. Approx. Theory 15, 214-225), so the patch is G1 for any data.
#pragma once

#include "tripatch/boundary/ribbon.h"
#include "tripatch/patch/surface.h"

namespace tripatch {

/// The mean of the six sums P_a + P_b - P_a P_b, P_i the cubic Hermite lofts along lines parallel to side i, so that no corner is
/// favoured.
SurfacePtr barnhill_birkhoff_gordon(const Boundary& boundary);

}  // namespace tripatch
