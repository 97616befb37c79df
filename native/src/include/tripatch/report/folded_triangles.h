// Folds of the faces that are delivered. (count_folds in report.h asks the patch on a grid of its own.)
#pragma once

#include <array>
#include <span>
#include <vector>

#include "tripatch/mesh/connectivity.h"
#include "tripatch/mesh/triangles.h"
#include "tripatch/report/edges_by_vertex.h"

namespace tripatch {

/// Degrees between the normals of two triangles at an edge beyond which they lie folded over each other: the measure of the
/// comparisons with other hole fillers.
constexpr double folded_degrees = 120;

/// The face of the mesh beyond an edge of the rim.
struct AdjacentFace {
  Index from, to;  ///< the edge, either way round
  Vec3 normal;     ///< of any length; zero: nothing folds over it
};

/// Those of loops of border edges, one for each edge in their order.
std::vector<AdjacentFace> faces_beyond(const Mesh& mesh, const Connectivity& around,
                                       const std::vector<std::vector<Index>>& loops);

/// The same with the rows of the loops' vertices for the vertices, one loop after another.
std::vector<AdjacentFace> faces_beyond_rows(const Mesh& mesh, const Connectivity& around,
                                            const std::vector<std::vector<Index>>& loops);

/// Of faces beyond, those that are turned over: folded over one next to, and more than 100 degrees from what the other faces at their
/// vertices are together. A fill that continues as those do folds over them. Other faces that face all ways have no say.
std::vector<char> flipped(const Mesh& mesh, const Connectivity& around, const std::vector<std::vector<Index>>& loops);

/// Whether the faces at the vertices of one bound a body that is convex, no two of them in a plane: then it is no fold that they make, they
/// meet sharply, as at the tip of a pyramid.
bool is_of_convex_body(const Mesh& mesh, const Connectivity& around, Index face);

/// Turns quads so that each begins where its shorter diagonal does: cut into fans they are then cut along that, whichever corner they began at
/// and in a mirror too. Numbers as of count_folded_edges.
void begin_at_shorter_diagonals(const PointsRef& vertices, const PointsRef& added, Faces& faces);

/// Edges of triangles, every face cut into a fan from its first corner: 2 t + 1 comes along from the lower vertex of an edge of triangle
/// t to its higher one, 2 t the other way. The faces beyond count on after the triangles. of_mesh, own: numbers of vertices.
EdgesByVertex edges_of_triangles(Index of_mesh, Index own, const Faces& faces, std::span<const AdjacentFace> beyond);

/// Whether rounding has no say in that no two triangles are folded over each other: all lean from the vector area of the loops, which the
/// faces beyond go along, by less than half of what makes a fold. False says nothing. Numbers as of count_folded_edges.
bool surely_unfolded(const PointsRef& vertices, const PointsRef& added, const Faces& faces, std::span<const AdjacentFace> beyond);

/// Edges whose triangles are folded over each other, and edges of the rim where they are folded back over the faces beyond. Where an edge
/// has more than two triangles each is compared with the first. vertices: of the mesh; v >= their number is row v - number of `added`.
/// edges: of the triangles and the same faces beyond.
Index count_folded_edges(const PointsRef& vertices, const PointsRef& added, const Faces& faces,
                         std::span<const AdjacentFace> beyond, EdgesByVertex& edges);
Index count_folded_edges(const PointsRef& vertices, const PointsRef& added, const Faces& faces,
                         std::span<const AdjacentFace> beyond = {});
/// The same of triangles by row of all points that they use.
Index count_folded_edges(const PointsRef& points, const Triangles& triangles, std::span<const AdjacentFace> beyond);
/// Edges so counted, both vertices of each, of faces that measure_faces has measured.
std::vector<std::array<Index, 2>> folded_edges(const PointsRef& vertices, const PointsRef& added, const Faces& faces,
                                               std::span<const AdjacentFace> beyond);

}  // namespace tripatch
