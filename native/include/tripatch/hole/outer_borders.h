// The one rule for which borders of a mesh are holes and which are its outer border.
#pragma once

#include <vector>

#include "tripatch/mesh/connectivity.h"

namespace tripatch {

/// For each border loop whether it is an outer border: one that as a whole turns the other way than a hole, which turns once round.
/// loops: as of border_loops. Takes time by the loops and the faces at them.
std::vector<char> outer_borders(const Mesh& mesh, const Connectivity& around, const std::vector<std::vector<Index>>& loops);

/// A border loop of a mesh, with what decides whether it is filled where all holes are.
struct Border {
  std::vector<Index> loop;  ///< as of border_loops
  bool outer = false;       ///< is left out, unless outer borders are asked for: never where the mesh has no other
  double diameter = 0;      ///< largest distance between its vertices
};
/// All of them, in the order of border_loops, in one pass over the mesh.
std::vector<Border> borders_of(const Mesh& mesh, const Connectivity& around);
std::vector<Border> borders_of(const Mesh& mesh);

/// Whether one loop turns the other way, or `of_sheet` so much that its fill would lie on the mesh; its mesh may be given in part. Throws
/// InvalidArgument for what is no loop of vertices.
bool is_outer_border(const Mesh& mesh, const std::vector<Index>& rim, bool of_sheet = false);

}  // namespace tripatch
