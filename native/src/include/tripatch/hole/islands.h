// Which borders of a mesh lie inside other holes: one fill joins them.
#pragma once

#include <vector>

#include "tripatch/mesh/connectivity.h"

namespace tripatch {

/// For each of some border loops the numbers of those that are islands in it; an island has none, and belongs to one hole. An island
/// is the border of another part of the mesh. In the plane fitted to the larger loop that winds once around the middle of the smaller,
/// which runs the other way; and from each of both the faces, continued, lead to the other.
/// parts: false: of borders that a person has chosen only the last is asked.
std::vector<std::vector<std::size_t>> islands_of(const Mesh& mesh, const Connectivity& around,
                                                 const std::vector<std::vector<Index>>& loops, bool parts = true);

}  // namespace tripatch
