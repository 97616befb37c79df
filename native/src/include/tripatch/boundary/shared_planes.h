// Tangent planes at vertices where several holes meet, so that their fills have the same there.
#pragma once

#include <span>
#include <vector>

#include "tripatch/boundary/vertex_planes.h"
#include "tripatch/mesh/connectivity.h"

namespace tripatch {

/// By vertex of a rim the planes that are known otherwise; empty where none are.
using PlanesOfRim = std::vector<SeenPlane> (*)(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim);

/// At vertices of two or more of these rims the mean of the planes that each rim's surroundings tell, weighted by how well these are
/// known. None where they are several planes, as at the corner of a cube, and none of rims that cannot be read.
///
/// of_rim: asked first, in the direction of the new faces; may be null.
VertexPlanes shared_planes(const Mesh& mesh, const Connectivity& around, std::span<const std::vector<Index>> rims,
                           PlanesOfRim of_rim);

}  // namespace tripatch
