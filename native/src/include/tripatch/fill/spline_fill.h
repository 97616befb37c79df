// The whole path of a rim with any number of corners: the surface of its surroundings as a field over a plane, triangles on it.
#pragma once

#include <optional>
#include <vector>

#include "tripatch/mesh/connectivity.h"
#include "tripatch/output/fill_result.h"
#include "tripatch/patch/through.h"

namespace tripatch {

struct SplineFillOptions {
  /// Triangles: a third of the rim has so many edges inside the fill; none: edges as long as the rim's. Quads: extra rows around.
  std::optional<int> resolution;
  bool quads = false;    ///< that grow in from the rim; where these are no good, pairs of triangles that make good ones
  bool features = true;  ///< creases that end at the rim on both sides of the hole are continued across it
  /// What of the mesh is continued, where that is not all around; none: `around`.
  const Connectivity* continued = nullptr;
  std::vector<Through> through = {};  ///< met exactly inside
  Points planes = Points(0, 3);       ///< normals at the rim's vertices that the fill has there; no rows: what is continued tells
  /// Rows of the rim, in its order. Quads are a grid between four with as many edges on opposite sides.
  std::vector<Index> corners = {};
};

/// The hole of a rim that check_topology and check_positions let pass, with the islands in it (further border loops). `around` knows
/// all of the mesh.
Fill fill_with_spline(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim,
                      const std::vector<std::vector<Index>>& islands, const SplineFillOptions& options);

/// Whether a fill of four edges lies in their plane, so that two triangles do for it.
bool is_flat_quadrilateral(const Points& rim, const Points& inside);

}  // namespace tripatch
