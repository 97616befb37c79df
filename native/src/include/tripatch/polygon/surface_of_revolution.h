// The fairest cap of a surface of revolution, found among surfaces of revolution: eight unknowns of a profile instead of all of a disc's.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "tripatch/choices.h"
#include "tripatch/polygon/round_problem.h"

namespace tripatch {

/// How much the quadric energy counts, from nothing to 1. ratio: product of the rim's two curvatures over the sum of their squares, half on
/// spheres, nothing on cones and cylinders.
double quadrics_count(double ratio);

/// The terms of the fairest patch of revolution over `base`, whose rim and slopes are of revolution about the axis of `frame`
/// (see of_revolution), with a tangent plane and free slopes; none where descent finds nothing that does not cross its axis.
/// energy: automatic or minimum_variation. curvature_jump: of FairingOptions. minimum_variation alone leaves open how far a tube
/// continues before it closes, and sees ever less in the cap of a funnel the larger that is. So the logarithm of the energy of
/// the first derivatives is added. Then each cone has one cap, and surfaces without variation, such as spheres, stay as they are.
/// For the same reason quadrics count only where the surroundings' meridian bends as that of a quadric with a blunt end: a
/// cylinder's and a cone's are those of half-ellipsoids of any length, and of a tip.
std::optional<std::vector<Harmonic>> fairest_of_revolution(const RoundBase& base, const Eigen::Matrix3d& frame, Fairing energy,
                                                           double curvature_jump);

}  // namespace tripatch
