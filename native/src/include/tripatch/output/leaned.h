// A fill over a plane that is given tangent planes at some vertices of its rim, which it shares with other fills.
#pragma once

#include "tripatch/boundary/vertex_planes.h"
#include "tripatch/output/fill_result.h"

namespace tripatch {

/// Leans the patch of a fill into planes at the vertices of its rim where they are known, and its vertices with it: what is added
/// vanishes at the other vertices of the rim, and its slopes with it. Of a fill without a surface only the normals change. Fills that
/// creases cross stay as they are, and patches between sides, which have the planes already.
void lean(const VertexPlanes& planes, Fill& fill);

}  // namespace tripatch
