// What keeps the filled mesh a manifold where the fill has an edge that the mesh has already.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "tripatch/mesh/connectivity.h"

namespace tripatch {

/// Gives every inner edge of a fill between two rim vertices that the mesh joins already a vertex in its middle: four faces would
/// share it. rim: of the mesh, vertices 0, 1, ... of the triangles; count: of all their vertices. Returns the ends of each halved
/// edge, whose middle is vertex count, count + 1, ...
std::vector<std::array<Index, 2>> halve_doubled_edges(const Connectivity& mesh, std::span<const Index> rim, Index count,
                                                      std::vector<std::array<Index, 3>>& triangles);

/// Pairs of rows of a rim's vertices that the mesh joins by an edge, the lower first, sorted; rim edges are among them.
std::vector<std::array<Index, 2>> joined_rows(const Connectivity& around, const std::vector<Index>& rim);

/// Whether an inner edge of faces joins two of the rim's vertices, which are the first rows, that the mesh joins.
bool doubles_edges(const Connectivity& around, const std::vector<Index>& rim, const Faces& faces);
/// The same of faces by the mesh's own vertices and further ones.
bool doubles_edges_of_mesh(const Connectivity& around, const std::vector<Index>& rim, Faces faces);

}  // namespace tripatch
