// The one rule for which borders of a mesh are holes and which are its outer border.
#pragma once

#include <vector>

#include "tripatch/mesh/connectivity.h"
#include "tripatch/messages.h"

namespace tripatch {

struct HoleChoice;

/// A border loop of a mesh, with what decides whether it is filled where all holes are.
struct Border {
  std::vector<Index> loop;  ///< as of border_loops
  /// Left open unless outer borders are asked for: as a whole it turns the other way than a hole, and no border of its connected
  /// component is longer. If all borders of a mesh are outer ones, only those of sheets stay so: their fills would lie on the mesh.
  bool outer = false;
  double diameter = 0;  ///< largest distance between its vertices
};
/// All of them, in the order of border_loops, in one pass over the mesh.
std::vector<Border> borders_of(const Mesh& mesh, const Connectivity& around);
std::vector<Border> borders_of(const Mesh& mesh, const Connectivity& around, const std::vector<std::vector<Index>>& loops);
std::vector<Border> borders_of(const Mesh& mesh);
/// Of all borders of a mesh those that are chosen, as of choose_holes.
std::vector<std::vector<Index>> chosen_among(const std::vector<Border>& borders, const Mesh& mesh, const Connectivity& around,
                                             const HoleChoice& choice);

/// Why a chain of border edges that closes to no loop is no hole.
Message told_of_unclosed(const std::vector<Index>& chain);
/// Refuses a mesh without holes; borders, unclosed: all of the mesh, as of border_loops.
[[noreturn]] void refuse_no_hole(const std::vector<Border>& borders, const std::vector<std::vector<Index>>& unclosed);

/// Whether one loop turns the other way, or `of_sheet` so much that its fill would lie on the mesh; its mesh may be given in part. Throws
/// InvalidArgument for what is no loop of vertices.
bool is_outer_border(const Mesh& mesh, const std::vector<Index>& rim, bool of_sheet = false);

}  // namespace tripatch
