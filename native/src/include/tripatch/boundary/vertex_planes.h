// Tangent planes that are known at vertices of a mesh before anything is estimated there.
#pragma once

#include <map>

#include "tripatch/types.h"

namespace tripatch {

/// Unit normals by vertex.
using VertexPlanes = std::map<Index, Vec3>;

/// A plane as one side of a rim tells it.
struct SeenPlane {
  Vec3 normal;
  double variance;  ///< radians squared
};

}  // namespace tripatch
