// The sides of a hole between any number of corners, estimated from the faces around it.
#pragma once

#include <vector>

#include "tripatch/boundary/side.h"
#include "tripatch/boundary/vertex_planes.h"
#include "tripatch/mesh/connectivity.h"

namespace tripatch {

/// The sides of a hole in a mesh as estimated from the faces around it, three corners at a time.
struct PolygonSides {
  std::vector<Side> sides;
  std::vector<std::vector<double>> parameters;  ///< of the rim's vertices on each side
  double surroundings_error = 0;                ///< degrees
};

/// rim: from corner 0 on, in the direction of new faces; corners: places in it, increasing, the first 0, two or more. alone: by side, or
/// none: as of Hole. Takes time by the hole.
PolygonSides polygon_sides(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim,
                           const std::vector<Index>& corners, const std::vector<bool>& alone = {},
                           const VertexPlanes& planes = {});

}  // namespace tripatch
