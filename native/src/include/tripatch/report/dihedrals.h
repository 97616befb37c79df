// How sharply new faces meet the mesh where they are not tangent to it.
#pragma once

#include <array>
#include <vector>

#include "tripatch/mesh/connectivity.h"
#include "tripatch/output/fill_result.h"

namespace tripatch {

/// Where a vertex of the mesh or, counted on from these, of the fill is.
Vec3 place_of(const Mesh& mesh, const Fill& fill, Index v);

/// The vector area of a face of the fill.
Vec3 area_of(const Mesh& mesh, const Fill& fill, Index face);

/// An edge of the rim, as a new face runs, and the angle to the face beyond it.
struct RimDihedral {
  std::array<Index, 2> edge;
  double degrees;
};
std::vector<RimDihedral> rim_dihedrals(const Mesh& mesh, const Connectivity& around, const Fill& fill);

/// Takes into the report the largest angle between a new face and the face beyond the rim, and the root mean square, degrees.
void measure_dihedrals(const Mesh& mesh, const Connectivity& around, Fill& fill);

}  // namespace tripatch
