// What is wrong with quads that are pairs of triangles.
#pragma once

#include "tripatch/quads/quad_smoothing.h"
#include "tripatch/types.h"

namespace tripatch {

/// Inside vertices of which just two quads are left go, and the two become one.
void remove_doublets(PlaneLayout& layout);

/// Faces with quads halved that are nearly turned over, so that the halves bend least.
Faces with_bad_quads_halved(const Points& points, const Faces& faces);

}  // namespace tripatch
