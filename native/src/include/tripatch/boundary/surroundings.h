// The sides of a hole in a mesh, whichever way they are known: estimated from the faces around, or the limit surface of a cage.
#pragma once

#include <array>
#include <vector>

#include "tripatch/boundary/limit_surface.h"
#include "tripatch/boundary/side.h"
#include "tripatch/boundary/vertex_planes.h"
#include "tripatch/hole/hole.h"
#include "tripatch/messages.h"

namespace tripatch {

struct Surroundings {
  Sides sides;
  std::array<std::vector<double>, 3> parameters;  ///< of the points that the fill takes along each side
  Messages warnings;
  double error = 0;  ///< degrees; 0 where they are known exactly
  Points border;     ///< points that the fill takes instead of the rim's own vertices; empty: those are reused
};

/// limit: the settings of the cage whose limit surface surrounds the hole; none: an estimate from the mesh, in the planes where these are known. whole: of the mesh; around:
/// without the faces that are replaced. Takes time by the hole, not by the mesh.
Surroundings surroundings_of(const Mesh& mesh, const Connectivity& whole, const Connectivity& around, const Hole& hole,
                             const Subdivision* limit, const VertexPlanes& planes = {});

/// Barycentric coordinates of the rim's own vertices, from corner 0 on: a border has several points an edge.
Points rim_barycentric(const Hole& hole, const Surroundings& surroundings);

}  // namespace tripatch
