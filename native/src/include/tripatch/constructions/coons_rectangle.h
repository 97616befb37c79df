// Discrete Coons patches and permanence patches over rectangles: section 2 and 4 of Arnal and Lluch, after Farin and Hansford 1999
// (CAGD 16, 691-700). The reference that the triangular ones are compared with: here the permanence principle holds.
#pragma once

#include "tripatch/boundary/bezier_rectangle.h"

namespace tripatch {

/// The discrete Coons patch of a net's boundary: the bilinearly blended Coons patch of its four boundary curves. Interior points of
/// the net given are not read.
BezierRectangle coons_rectangle(const BezierRectangle& boundary);

/// The net each of whose interior points is alpha times its four diagonal and beta times its four other neighbors, with
/// 4 alpha + 4 beta = 1; alpha = -1/4 (eq. 10) gives the discrete Coons patch. A Refusal where the system is singular.
BezierRectangle permanence_rectangle(const BezierRectangle& boundary, double alpha = -0.25);

/// The functional (1): integral of |x_uv|^2 over the unit square.
double coons_energy(const BezierRectangle& surface);

}  // namespace tripatch
