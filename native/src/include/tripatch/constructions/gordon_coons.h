// Gordon-Coons triangle: the Boolean sum of three linear lofts along lines parallel to the sides, position only.
// Barnhill, Birkhoff and Gordon 1973 (J. Approx. Theory 8, 114-128); Szilvasi-Nagy and Szabo 2006, eq. (1). Reproduces quadratics.
#pragma once

#include "tripatch/boundary/ribbon.h"
#include "tripatch/patch/surface.h"

namespace tripatch {

/// Curve i runs along side i, from corner i + 1 to corner i + 2. Throws a Refusal where curves do not meet.
SurfacePtr gordon_coons(std::array<PiecewisePolynomial, 3> curves);

}  // namespace tripatch
