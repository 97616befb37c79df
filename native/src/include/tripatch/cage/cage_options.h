// How cages are fitted.
#pragma once

#include "tripatch/choices.h"
#include "tripatch/math/thresholds.h"

namespace tripatch {

/// Weights are against 1 for distances across the patch.
struct CageOptions {
  CageRim rim = CageRim::smooth;
  double tangential = share::tenth;      ///< distances along the patch: where on it a point lies matters little
  double surroundings = 0.15;            ///< distances across the old limit surface around an open hole
  double surroundings_tangential = 0.5;  ///< and along it
  double corner = share::tenth;       ///< times these on faces at a corner, where an open border is round and a closed one is not
  double whole = 1;                   ///< around a region to be replaced, where the old limit surface is that of the whole cage
  double seam = 5;                    ///< exact: tangent planes along the rim, radians times the size of the hole
  double seam_width = share::little;  ///< exact: times `seam`: how far the first row reaches inwards
  /// The same of fills that keep to the points of a fair cage with a smooth rim, from which an exact one differs: with more, few quads turn
  /// over next to short sides, and the angles at the seam fall by a degree only.
  double seam_of_points = share::tenth, seam_width_of_points = 0.5;
  double lines = share::hundredth;  ///< third derivatives in the faces' parameters: where along the patch the lines run
  int rounds = 3;                   ///< how often it is fitted, each time to the points of the patch that have become the nearest
  /// Movements of the old limit surface (rms, over the hole's size) that weigh as much as an energy of the fair cage e times as
  /// large: around an open hole, and around a region to be replaced.
  double fair_open = 6e-3, fair_whole = 6e-4;
};

}  // namespace tripatch
