// The fill of B. Smits's page (2000): heights over a triangle, blended from those of its three edges. Position only: the patch does
// not take a normal field along its sides, for which sides_from_normals and a G1 method serve.
#pragma once

#include "tripatch/boundary/normal_sides.h"
#include "tripatch/patch/surface.h"

namespace tripatch {

/// Over the flat triangle, along the normalized blend of the normals, the Gordon-Coons blend (Szilvasi-Nagy and Szabo 2006, eq. 1)
/// of the heights that the curves of eqs. 4-9 have along that direction. Normals of any length; a Refusal where they are zero or
/// not finite.
SurfacePtr smits_patch(const std::array<Vec3, 3>& points, const std::array<Vec3, 3>& normals);

}  // namespace tripatch
