// A patch as quads: the layout with its vertices on the patch, as many rows as a tolerance asks for, and an even number around.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "tripatch/hole/hole.h"
#include "tripatch/hole/rim_shape.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/output/cover.h"
#include "tripatch/patch/surface.h"
#include "tripatch/types.h"

namespace tripatch {

/// Extra rows that are tried, at most: beyond them the edges of the rim decide how near the quads come.
constexpr int max_extra_rows = count::several;
constexpr double default_tolerance = tolerance::slight;  ///< of the hole's diameter

struct LayoutOptions {
  std::optional<int> rows;          ///< extra rows of quads round the pole(s); none: the fewest under `tolerance`, 0 to 4
  std::optional<double> tolerance;  ///< deviation from the patch, scene units; none: 1e-3 of the diameter where rows reach that
  bool split_odd = true;            ///< an odd rim: its longest edge is split, else a triangle is left at the pole
  std::array<double, 2> pole_offset = {0, 0};
};

/// parameters[i]: of the rim's vertices on side i. own_rim: the rim's vertices are the fill's own, and no edge is split.
Cover cover_with_quads(const Mesh& mesh, const Hole& hole, std::array<std::vector<double>, 3> parameters, const Surface& patch,
                       const LayoutOptions& options, bool own_rim);

/// The place in a rim where its longest edge starts: the first of those that are equal to rounding.
std::size_t longest_edge(const PointsRef& rim);
inline std::size_t longest_edge(const Mesh& mesh, const std::vector<Index>& rim) {
  return longest_edge(Points(mesh.vertices(rim, Eigen::all)));
}

}  // namespace tripatch
