// Side-vertex patch: three rays from the vertices to the opposite sides, blended by the side weights.
// Nielson 1979 (J. Approx. Theory 25, 318-336), vector-valued Hagen 1986. G1 along all sides; reproduces cubics.
#pragma once

#include "tripatch/boundary/ribbon.h"
#include "tripatch/patch/surface.h"

namespace tripatch {

SurfacePtr side_vertex(const Boundary& boundary);
/// The same with rays of degree 5: curvature is continuous at the corners too, where the cubic rays' has a value for each
/// direction and nothing added later mends it. What fairing starts from.
SurfacePtr curved_side_vertex(const Boundary& boundary);

}  // namespace tripatch
