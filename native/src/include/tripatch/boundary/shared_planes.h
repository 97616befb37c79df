// Tangent planes at vertices where several holes meet, so that their fills have the same there.
#pragma once

#include <span>
#include <vector>

#include "tripatch/boundary/vertex_planes.h"
#include "tripatch/mesh/connectivity.h"

namespace tripatch {

/// At vertices of two or more of these rims the mean of the planes that each rim's surroundings tell, weighted by how well these are
/// known. None where they are several planes, as at the corner of a cube, and none of rims that cannot be read.
VertexPlanes shared_planes(const Mesh& mesh, const Connectivity& around, std::span<const std::vector<Index>> rims);

}  // namespace tripatch
