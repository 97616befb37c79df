// The last resort where a patch folds.
#pragma once

#include "tripatch/boundary/side.h"
#include "tripatch/fairing/folds.h"
#include "tripatch/patch/surface.h"

namespace tripatch {

/// A little of the interior term against folds (folds.h): points of a grid that face away from the blend of the rim's normals, and
/// neighbors whose normals are far apart. The least in third derivatives, with a penalty on each fold that grows. Returns the
/// first correction (to be added to `patch`) that leaves none and does not go far, or nothing.
SurfacePtr fold_removal(const SurfacePtr& patch, const Sides& sides, double size, const FoldCounter& folds);

}  // namespace tripatch
