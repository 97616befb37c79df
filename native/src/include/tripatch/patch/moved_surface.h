// A surface in another place, or in a mirror: what was computed about a local origin, or of the mirrored mesh, is handed over where it
// belongs.
#pragma once

#include "tripatch/patch/surface.h"

namespace tripatch {

SurfacePtr moved(SurfacePtr surface, const Vec3& by);
/// Of a surface over a plane: x is -x, v is -v, so that normals stay on their side.
SurfacePtr mirrored(SurfacePtr surface);

}  // namespace tripatch
