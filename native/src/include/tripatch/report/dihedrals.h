// How sharply new faces meet the mesh where they are not tangent to it.
#pragma once

#include "tripatch/mesh/connectivity.h"
#include "tripatch/output/fill_result.h"

namespace tripatch {

/// Where a vertex of the mesh or, counted on from these, of the fill is.
Vec3 place_of(const Mesh& mesh, const Fill& fill, Index v);

/// Takes into the report the largest angle between a new face and the face beyond the rim, and the root mean square, degrees.
void measure_dihedrals(const Mesh& mesh, const Connectivity& around, Fill& fill);

}  // namespace tripatch
