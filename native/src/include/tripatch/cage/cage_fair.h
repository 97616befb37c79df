// The fairest cage: free vertices such that the curvature of the limit surface varies least in the holes. Unlike a patch, which
// has the kinks of its rim in its parameterisation, a cage continues the lines of its surroundings, and its limit surface their
// curvature.
#pragma once

#include <vector>

#include "tripatch/cage/cage_system.h"
#include "tripatch/math/thresholds.h"

namespace tripatch {

constexpr double anchor = 1e-10;  ///< relative, squared: keeps a vertex where it is where nothing else holds it

/// The nine derivatives of order 1 to 3 of the limit surface at a few places of a face, in the face's own u and v, in the order of
/// Derivatives (energy.h), place after place; each place stands for `area` of the parameter domain.
struct FaceShape {
  Sums derivatives;
  double area = 0;
};
/// From the positions on a face: of quads on a 4 x 4 grid of cell centres, the first index u, by the bicubic polynomial through
/// them; of triangles (Loop's scheme) the ten of `spread`, by the cubic polynomial.
FaceShape face_shape(const Sums& positions, bool triangle);

struct FairHole {
  std::vector<FaceShape> inside;  ///< the hole's faces
  /// The same faces and those that touch the rim from outside, where all are about as long across the rim: what parameters run along. Of
  /// longer ones only what lies as near to the rim as the fill's own faces are deep.
  std::vector<FaceShape> even;
  double size = 0;               ///< of the hole, scene units
  double before = 0, after = 0;  ///< the energy, see fair_cage
};

/// Adds weight times the integral of squared third derivatives of the even faces.
void add_third_derivatives(const CageSystem& system, const FairHole& hole, const Points& free, double weight,
                           CageSystem::Term& term);

struct FairCageOptions {
  double parameters = 0.5;  ///< a step may gain this part, relative, on third derivatives of what it loses on the energy
  int iterations = 8;
  double enough = share::hundredth;  ///< relative gain below which the iteration stops
};

/// Positions of the free vertices that make
///   sum over holes of log(energy) + parameters * log(third derivatives) + held
/// least, energy = size^2 integral |grad h|^2 dA inside, h the second fundamental form (no units; zero on planes, spheres and
/// cylinders). held: any sum of squares, in the movement from `start`; slots
/// in `fixed` do not move. Gauss-Newton from the least third derivatives, which are
/// linear. A cage with degenerate faces stays at those.
Points fair_cage(CageSystem& system, const Points& start, std::vector<FairHole>& holes, const CageSystem::Term& held,
                 const std::vector<int>& fixed, const FairCageOptions& options = {});

}  // namespace tripatch
