// Triangular Coons patch of three curves, position only: at each corner the sum of its two sides' curves, the three blended
// linearly. Nielson, Thomas and Wixom 1978 (GMR-2834); Arnal and Lluch, section 3. Curves of degree n give a polynomial of
// degree n + 1; reproduces planes only (a quadratic is missed by a multiple of b0 b1 b2).
#pragma once

#include "tripatch/boundary/ribbon.h"
#include "tripatch/patch/surface.h"

namespace tripatch {

/// Curve i runs along side i, from corner i + 1 to corner i + 2. Throws a Refusal where curves do not meet.
SurfacePtr triangular_coons(std::array<PiecewisePolynomial, 3> curves);

}  // namespace tripatch
