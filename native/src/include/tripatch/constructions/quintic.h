// Quintic precision: a quintic Bezier triangle fitted to the boundary data, plus the side-vertex patch of what it misses there. G1
// along all sides, reproduces quintics. The class of Zhang, Ji and Yang 2005 (Sci. China F 48, 263-272): basic approximation
// operator plus additional interpolation operator.
#pragma once

#include "tripatch/boundary/ribbon.h"
#include "tripatch/patch/surface.h"

namespace tripatch {

SurfacePtr quintic(const Boundary& boundary);

/// The control net of the basic operator, in the order (5,0,0), (4,1,0), (4,0,1), ..., (0,0,5). Corners and end tangents of the
/// curves are kept; the two middle points of each side and the six inner points are least squares of positions and slopes, each
/// exact where the data are those of a quintic.
Points quintic_net(const Boundary& boundary);

}  // namespace tripatch
