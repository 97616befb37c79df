// All-quad layouts of a three-sided region with any edge counts on its sides. One pole of valence 3 where each count is less than
// the sum of the others (Takayama, Panozzo and Sorkine-Hornung 2014, the first triangular pattern; the spoke lengths are Tarini's
// 2022 closed form). The other cases by strips round the corner opposite the long side, which take two edges off it each.
#pragma once

#include <array>
#include <vector>

#include "tripatch/types.h"

namespace tripatch {

struct QuadLayout {
  /// Barycentric coordinates. The first `rim` rows are the rim from corner 0 on, along side 2, then side 0, then side 1.
  Points barycentric;
  Index rim = 0;
  Faces faces;               ///< traverse the rim forwards; all quads, but one triangle where the sum of the counts is odd
  std::vector<Index> poles;  ///< inside vertices whose valence is not 4
  bool in_plane = false;     ///< of other than three sides: rows of `barycentric` are (u, v, 0) in a convex domain
  bool grown = false;        ///< from the rim, whatever its corners
};

/// parameters[i]: increasing from 0 to 1, the rim's vertices on side i. rows: extra rows of quads round the pole(s), 0 the plain
/// layout. pole_offset: moves the pole in the equilateral triangle of unit side, along side 2 and towards corner 2.
QuadLayout quad_layout(const std::array<std::vector<double>, 3>& parameters, int rows, const std::array<double, 2>& pole_offset);

}  // namespace tripatch
