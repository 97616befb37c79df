// Splits the parameter triangle into triangles that match any edge counts on the three sides.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "tripatch/types.h"

namespace tripatch {

struct TriangleMesh {
  /// Barycentric coordinates. The first `rim` rows are the rim from corner 0 on, along side 2, then side 0, then side 1.
  Points barycentric;
  Index rim = 0;
  std::vector<std::array<Index, 3>> triangles;  ///< traverse the rim forwards
};

/// parameters[i]: increasing from 0 to 1, the rim's vertices on side i. position: maps barycentric coordinates (n x 3) to the
/// patch's points, so that triangles are well shaped in space and not only in the domain. resolution: edges per side inside the
/// fill; none: follow the rim.
TriangleMesh triangulate(const std::array<std::vector<double>, 3>& parameters, std::optional<int> resolution,
                         const std::function<Points(const PointsRef&)>& position);

}  // namespace tripatch
