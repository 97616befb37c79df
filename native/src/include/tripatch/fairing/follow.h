// A patch near to points of another surface, in place of a fair one.
#pragma once

#include "tripatch/fairing/fairing.h"
#include "tripatch/math/thresholds.h"

namespace tripatch {

/// Points of a surface that a patch shall follow, with the barycentric coordinates where it is about to pass them, and unit normals.
struct SurfacePoints {
  Points barycentric = Points(0, 3), points = Points(0, 3), normals = Points(0, 3);
};

/// What a distance along the surface counts next to one across it: where on a surface a point lies matters little, but must be held.
constexpr double follow_along = share::tenth;

/// Of the patches that differ from `base` in the terms above the one that is nearest to the points, by least squares: distances along
/// the surface count a tenth. Of `options` the numbers of coefficients and slopes_free are read.
SurfacePtr follow(const FairingBase& base, SurfacePoints points, const FairingOptions& options = {});

}  // namespace tripatch
