// Tangent planes that are known at vertices of a mesh before anything is estimated there.
#pragma once

#include <map>

#include "tripatch/types.h"

namespace tripatch {

/// Unit normals by vertex.
using VertexPlanes = std::map<Index, Vec3>;

}  // namespace tripatch
