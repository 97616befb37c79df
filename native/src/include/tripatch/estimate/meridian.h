// The meridian of surroundings of revolution where it begins at a round rim.
#pragma once

#include <optional>
#include <vector>

#include "tripatch/estimate/local_mesh.h"

namespace tripatch {

/// Deviations are standard ones.
struct Meridian {
  std::vector<double> turn;    ///< of the rim's vertices about the axis, from the first on, a whole one being 1
  std::vector<Vec3> normal;    ///< of the surroundings there, unit, on the outer side
  double curvature = 0;        ///< along the meridian at the rim, towards the normal, 1 / length in scene units
  double slope_deviation = 0;  ///< radians
  double curvature_deviation = 0;
};

/// None where the rim is no circle, or the vertices around it are on no surface of revolution about its axis, or on three circles or less.
///
/// There all vertices lie on one curve in the half-plane of radius and height. It is read against the conic through the rim and the next
/// two of them, a circle or the meridian of a quadric of revolution, by which spheres, tori, cones, cylinders and quadrics are exact: by
/// the polynomial through what further ones leave of it. How many are taken, and which conic, is what changes least when one more is: of
/// planes and curvatures no vertex tells more. A polynomial of heights over a plane sees a strongly bent rim, not the meridian.
std::optional<Meridian> meridian_at(const LocalMesh& w);

}  // namespace tripatch
