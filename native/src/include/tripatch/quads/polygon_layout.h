// All-quad layouts of a region with any number of sides and any edge counts on them.
//
// Sources: K. Takayama, D. Panozzo, O. Sorkine-Hornung, Pattern-based quadrangulation for n-sided patches, Computer Graphics Forum 33
// (2014); M. Tarini, Closed-form quadrangulation of n-sided patches, Computers & Graphics 107 (2022).
#pragma once

#include <vector>

#include "tripatch/quads/quad_smoothing.h"

namespace tripatch {

struct RimCorner {
  Index place = 0;  ///< in the rim
  /// How many quads are wanted there, where that is known of the faces around (4 - theirs): 1 at a corner, 2 where the rim continues.
  /// 0: it follows from the angle.
  int quads = 0;
};

/// rim: places in a convex plane domain, counterclockwise, a row each; corners: two or more, by rising place. rows: extra rows of
/// quads along the whole rim. The region is a grid (four corners, opposite counts equal), or has one pole from which a spoke goes
/// to each side (3, 5, 6). Else it is cut into two such pieces (2 = 3 + 3, 4 = 3 + 5, 6 = 5 + 5). A search finds the integers of the
/// most regular coarse layout in the domain. Corners so blunt that two quads fit them better than one may count as straight (a
/// regular octagon becomes a grid with four corners). Of the few best, embedded and smoothed, the one with the largest least
/// scaled Jacobian is taken; fewer poles win where that is equal. An even rim gives quads only, an odd one a triangle besides.
PlaneLayout polygon_layout(const PlanePoints& rim, const std::vector<RimCorner>& corners, int rows = 0);

}  // namespace tripatch
