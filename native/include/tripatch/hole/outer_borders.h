// The one rule for which borders of a mesh are holes and which are its outer border.
#pragma once

#include <vector>

#include "tripatch/mesh/connectivity.h"

namespace tripatch {

/// For each border loop whether it is an outer border: one that as a whole turns the other way than a hole, which turns once round.
/// loops: as of border_loops. Takes time by the loops and the faces at them.
std::vector<char> outer_borders(const Mesh& mesh, const Connectivity& around, const std::vector<std::vector<Index>>& loops);

/// The border loops that are holes: without the outer borders, which count only where the mesh has no other.
std::vector<std::vector<Index>> inner_loops(const Mesh& mesh, const Connectivity& around, std::vector<std::vector<Index>> loops);

/// The same for one loop, which may be given in part of its mesh. Throws InvalidArgument for what is no loop of vertices.
bool is_outer_border(const Mesh& mesh, const std::vector<Index>& rim);

}  // namespace tripatch
