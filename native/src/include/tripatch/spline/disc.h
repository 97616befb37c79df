// The surroundings of a hole as a disc with the hole in it: what is laid into the plane with the fill.
#pragma once

#include <array>
#include <vector>

#include "tripatch/estimate/long_edges.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/mesh/connectivity.h"

namespace tripatch {

/// Triangles of the surroundings, at most: laying them out must not take longer than all the rest.
constexpr Index max_laid_out = 12'000;
/// Rims of more edges are filled on coarser ones: laying out their thousands of triangles takes longer than all the rest. Where that is
/// not possible, or what is continued or met is given, they are seen from above if nothing leans by more than 60 degrees. Shorter ones
/// are not: laid out, spheres under noise are twice as near.
constexpr Index long_rim = 400;
/// What is decimated may have more triangles: no more than coarsening takes as long for as the rest does.
constexpr Index max_coarsened = count::million;
inline Index max_triangles_around(Index rim) { return rim > long_rim ? max_coarsened : max_laid_out; }

struct Disc {
  std::vector<Index> vertices;                  ///< of the mesh; those of the loops come first, loop by loop
  Index rim = 0;                                ///< how many these are
  Points points;                                ///< of `vertices`
  std::vector<std::array<Index, 3>> triangles;  ///< of the surroundings, by row of `vertices`; larger faces cut
  std::vector<double> distance;                 ///< of each vertex from the rim, along edges, scene units
  std::vector<Index> nearest;                   ///< the row in the rim from which that is measured
  Faces faces;                                  ///< the same as the mesh has them, but for those that no fan cuts
  int rings = 0;
  std::vector<OnEdge> on_edges;  ///< of a disc to sample: spread along edges, and across faces, that are much longer than others
};

/// What is known at the vertices of a disc, a row for each, and after these what lies between them at its points on edges.
template <class Rows>
Rows with_points_on_edges(const Disc& disc, const Rows& at_vertices) {
  const Index n = at_vertices.rows(), added = static_cast<Index>(disc.on_edges.size());
  Rows all(n + added, at_vertices.cols());
  all.topRows(n) = at_vertices;
  for (Index k = 0; k < added; ++k) {
    const auto& [ends, share] = disc.on_edges[static_cast<std::size_t>(k)];
    all.row(n + k) = (1 - share) * at_vertices.row(ends[0]) + share * at_vertices.row(ends[1]);
  }
  return all;
}

/// Rings of faces around loops of the border until half of the outermost vertices are `reach` away (scene units), `max_rings` at
/// most; as far as the outer border does not draw together (the far end of a limb). Vertices that are not finite end it.
/// max_triangles: after the ring with which there are so many none follows.
Disc disc_around(const Mesh& mesh, const Connectivity& around, const std::vector<std::vector<Index>>& loops, double reach,
                 int max_rings, Index max_triangles = max_laid_out);
/// The same with its points on long edges.
Disc disc_to_sample(const Mesh& mesh, const Connectivity& around, const std::vector<std::vector<Index>>& loops, double reach,
                    int max_rings);

/// Samples of the field: so many and the rim's. The time grows with their cube; with 240 at least the distances of 220 holes from
/// what was there are within 2% of those with 160, but for known surfaces without noise, where they are a hundredth of a baseline's.
constexpr Index min_samples = count::cubic, max_samples = 600;
constexpr Index more_than_rim = count::hundred;
/// The best spread samples, rows of the disc's vertices and of the points on its edges: all of the rim if there are not too many, then
/// always the one that is farthest from those taken, over its own distance from the rim. Were that in edges where the rim has more of them
/// than samples, all others would be of the rim too, and the slope next to it unseen. In an order of which every k-th is spread over all.
std::vector<Index> spread_samples(const Disc& disc, double edge, Index more = more_than_rim, Index most = max_samples);

}  // namespace tripatch
