// A surface in another place: what was computed about a local origin is handed over where it belongs.
#pragma once

#include "tripatch/patch/surface.h"

namespace tripatch {

SurfacePtr moved(SurfacePtr surface, const Vec3& by);

}  // namespace tripatch
