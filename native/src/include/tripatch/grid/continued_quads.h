// Rows of quads continued across a hole of any outline, and past one pole in it.
#pragma once

#include <vector>

#include "tripatch/grid/continued_rows.h"
#include "tripatch/mesh/connectivity.h"

namespace tripatch {

/// Quads in a hole, whose vertices are the rim's and those inside.
struct QuadsInside {
  std::vector<Index> rim;  ///< vertices of the mesh, 0, 1, ... of the faces
  Faces faces;             ///< which traverse the rim forwards
  Index inside = 0;        ///< vertices, which follow
};

/// Whether all faces at a rim are known, and quads.
bool is_among_quads(const Connectivity& around, const std::vector<Index>& rim);

/// Poles past which rows continue: the rim does not tell the places of more.
inline constexpr Index max_poles = 1;

/// Whether a rim is among quads, and the rows that end there continue in these: four quads meet at each of its vertices and inside, but
/// for one vertex where three or five do.
bool go_on(const PointsRef& vertices, const Connectivity& around, const QuadsInside& quads);

/// The vertices inside with the least sum of squares of mixed differences, as continued_rows has them in blocks, over all quads that are
/// side by side in four and in nine around them. The order likewise, by the sides of the rim, which continue between its corners. That
/// tells little of the middle of many rows, and nothing of a pole: `missed` is what another order puts the vertices apart by, where that
/// is more. Order 0 where fewer than two orders determine them, or nothing tells how well.
ContinuedRows continued_quads(const PointsRef& vertices, const Connectivity& around, const QuadsInside& quads);

}  // namespace tripatch
