#include "tripatch/patch/seam.h"

#include <algorithm>
#include <cmath>

#include "tripatch/math/angle.h"
#include "tripatch/math/thresholds.h"

namespace tripatch {

SeamOfSide seam_of(const Surface& patch, const Points& places, const Points& points, const Points& normals) {
  const auto [own, own_normals] = patch.positions_and_normals(places);
  SeamOfSide seam;
  double squares = 0;
  for (Index k = 0; k < places.rows(); ++k) {
    seam.gap = std::max(seam.gap, (own.row(k) - points.row(k)).norm());
    if (!(normals.row(k).norm() > 0)) continue;  // the surroundings have no plane there
    // no plane of the patch: as bad as at a right angle
    const double angle = own_normals.row(k).norm() > 0 ? degrees_between(own_normals.row(k), normals.row(k)) : 90;
    seam.angle_max = std::max(seam.angle_max, angle);
    squares += angle * angle;
    ++seam.compared;
  }
  if (seam.compared > 0) seam.angle_rms = std::sqrt(squares / static_cast<double>(seam.compared));
  return seam;
}

double normals_spread(const Surface& patch, const Eigen::RowVector3d& one, const Eigen::RowVector3d& other) {
  constexpr Index rays = count::places + 1;  // a choice
  Points places(rays, 3);
  for (Index k = 0; k < rays; ++k) places.row(k) = one + static_cast<double>(k) / (rays - 1) * (other - one);
  const Points normals = patch.normals(places);
  double spread = 0;
  for (Index a = 0; a < rays; ++a)
    for (Index b = 0; b < a; ++b) spread = std::max(spread, degrees_between(normals.row(a), normals.row(b)));
  return spread;
}

}  // namespace tripatch
