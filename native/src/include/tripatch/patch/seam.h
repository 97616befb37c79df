// Where seams are measured: all along a side, but next to a corner whose two sides have different planes no patch can have both.
#pragma once

#include "tripatch/patch/surface.h"

namespace tripatch {

inline constexpr double same_plane = 1e-6;     ///< degrees between the planes of two sides up to which a corner has one
inline constexpr double beside_corner = 0.01;  ///< of a side: what is left out next to a corner that has two

/// How a patch meets a side: angles between its normals and the side's where that has some, in degrees, and the largest distance.
struct SeamOfSide {
  double angle_max = 0, angle_rms = 0, gap = 0;
  Index compared = 0;
};
SeamOfSide seam_of(const Surface& patch, const Points& places, const Points& points, const Points& normals);

/// Parameter of a side, from a corner: where the normals of a patch around it are looked at. A choice: far more than rounding, far less than
/// curvature turns them by.
inline constexpr double around_corner = 1e-6;
/// The largest angle in degrees between normals of a patch around a corner: on the line between two places near it, one on each side.
double normals_spread(const Surface& patch, const Eigen::RowVector3d& one, const Eigen::RowVector3d& other);

}  // namespace tripatch
