// Sides through mesh vertices without the noise of their third derivatives.
#pragma once

#include "tripatch/boundary/side.h"

namespace tripatch {

/// Sides through mesh vertices (Side::rim) as single polynomials of degree 6 to 16 by least squares, ends kept, where that comes
/// within a tenth of their extent; others as they are.
Sides smoothed(const Sides& sides);

}  // namespace tripatch
