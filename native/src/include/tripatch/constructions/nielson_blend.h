// Convex combination of three surfaces by the side weights: takes position and first derivatives of surface i along side i.
// Nielson 1979; Szilvasi-Nagy and Szabo 2006, eq. (2).
#pragma once

#include "tripatch/boundary/ribbon.h"
#include "tripatch/patch/surface.h"

namespace tripatch {

/// Surfaces over one triangle with common corners, surface i carries side i. Throws InvalidArgument where corners differ.
SurfacePtr nielson_blend(const std::array<SurfacePtr, 3>& surfaces);

/// From the sides of a hole: surface i is made of the parabolas from corner i to side i, with the side's slope there: the least that
/// eq. (2) asks of its surfaces, "one vertex and a vector field along its opposite side". Reproduces quadratics.
SurfacePtr nielson_blend(const Boundary& boundary);

}  // namespace tripatch
