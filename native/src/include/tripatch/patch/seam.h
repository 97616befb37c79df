// Where seams are measured: all along a side, but next to a corner whose two sides have different planes no patch can have both.
#pragma once

#include "tripatch/math/thresholds.h"
#include "tripatch/patch/surface.h"

namespace tripatch {

inline constexpr int seam_samples = count::hundreds;       ///< places along a side, a choice
inline constexpr double beside_corner = share::hundredth;  ///< of a side: what is left out next to a corner that has two

/// How a patch meets a side: angles between its normals and the side's where that has some, in degrees, and the largest distance.
struct SeamOfSide {
  double angle_max = 0, angle_rms = 0, gap = 0;
  Index compared = 0;
};
SeamOfSide seam_of(const Surface& patch, const Points& places, const Points& points, const Points& normals);

/// The largest angle in degrees between normals of a patch around a corner: on the line between two places near it, one on each side.
double normals_spread(const Surface& patch, const Eigen::RowVector3d& one, const Eigen::RowVector3d& other);

}  // namespace tripatch
