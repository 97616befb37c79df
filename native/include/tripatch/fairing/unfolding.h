// The last resort where a patch folds.
#pragma once

#include <functional>

#include "tripatch/boundary/side.h"
#include "tripatch/patch/surface.h"

namespace tripatch {

/// A little of the interior term against folds (report.h): points of a grid that face away from the blend of the rim's normals, and
/// neighbours whose normals are far apart. The least in third derivatives, with a penalty on each fold that grows. Returns the
/// first correction that leaves none and does not go far, or nothing. `folds` counts them.
SurfacePtr unfolding(const SurfacePtr& patch, const Sides& sides, double size, const std::function<Index(const Surface&)>& folds);

}  // namespace tripatch
