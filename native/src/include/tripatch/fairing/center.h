// The center of a patch, b = (1/3, 1/3, 1/3), as a handle.
#pragma once

#include <utility>

#include "tripatch/patch/surface.h"

namespace tripatch {

/// Position and unit normal (P_b0 x P_b1).
std::pair<Vec3, Vec3> center_of(const Surface& patch);

/// `patch` plus the vector times (27 b0 b1 b2)^power that takes its center to `position`: with power 2 the sides keep their tangent
/// planes, with 3 their curvature too.
SurfacePtr with_center(const SurfacePtr& patch, const Vec3& position, int power = 2);

}  // namespace tripatch
