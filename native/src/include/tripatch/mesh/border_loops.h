// The loops that the border of a mesh consists of.
#pragma once

#include <vector>

#include "tripatch/mesh/connectivity.h"

namespace tripatch {

/// Every border loop, shortest first (then by lowest index), each from its lowest index on, in the direction that new faces take:
/// against that of the faces at it. Where loops touch at a vertex, the fans of faces there part them. Linear in the mesh.
/// unclosed: gets the chains of border edges that close to no loop, as those next to a doubled face.
std::vector<std::vector<Index>> border_loops(const Connectivity& mesh, std::vector<std::vector<Index>>* unclosed = nullptr);

}  // namespace tripatch
