// Rows of quads continued across a hole: new vertices such that mixed differences of the rows are least.
#pragma once

#include "tripatch/grid/quad_rows.h"
#include "tripatch/types.h"

namespace tripatch {

/// What is made of rows around a hole.
struct ContinuedRows {
  Points inside;      ///< (n - 1) (m - 1): (i, j) is row (i - 1) (m - 1) + j - 1
  int order = 0;      ///< of the differences: 1, 2 or 3
  double missed = 0;  ///< scene units: see below
};

/// What cubics that meet two slopes miss in the middle of so many steps, over what they miss one step from an end. So are rows, of whatever
/// order: in 352 blocks of thirty kinds of meshes they are off by .23 times as much in the median, by 1 in nine of ten, alike where two
/// edges lie across and where eight do.
double middle_over_first(double across);

/// The vertices p(i, j) inside with the least sum of squares of their mixed differences, of order k along rows and columns. This
/// is the discrete form of the equation d^2k p / du^k dv^k = 0 of Birkhoff and Gordon (The draftsman's and related equations,
/// 1968). What it gives is blended from the rows around, k of them: for k = 1 a Coons patch of the rim, for k = 2 one that meets
/// the slopes around too, whatever creases and bevels run across. The order is the one that best predicts the rim from its
/// surroundings. `missed` by a side of the rim means missed where it is unknown too, in the median of the sides, as in the middle
/// of the block.
ContinuedRows continued_rows(const PointsRef& vertices, const QuadRows& rows);

}  // namespace tripatch
