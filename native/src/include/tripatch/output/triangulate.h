// Splits the parameter triangle into triangles that match any edge counts on the three sides.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "tripatch/patch/surface.h"

namespace tripatch {

struct TriangleMesh {
  /// Barycentric coordinates. The first `rim` rows are the rim from corner 0 on, along side 2, then side 0, then side 1; rows on
  /// side i have b_i == 0 exactly.
  Points barycentric;
  Index rim = 0;
  std::vector<std::array<Index, 3>> triangles;  ///< traverse the rim forwards; all positively oriented in the parameter triangle
};

/// parameters[i]: increasing from 0 to 1, the rim's vertices on side i. patch: so that triangles are well shaped in space and not
/// only in the domain. resolution: edges per side inside the
/// fill, 1: no vertices inside. none: follow the rim, where three equal counts n of fairly even spacing give the regular grid of
/// n^2 triangles, and a rim so dense that a fill of its own density would be huge is decimated inwards.
/// The same input gives the same bits. Throws InvalidArgument for parameters that do not increase from 0 to 1.
TriangleMesh triangulate(const std::array<std::vector<double>, 3>& parameters, std::optional<int> resolution,
                         const Surface& patch);

}  // namespace tripatch
