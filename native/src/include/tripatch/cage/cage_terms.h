// What a cage is fitted to, as sums of squares: the patch, the old limit surface around, and along an exact rim its tangent planes.
#pragma once

#include <vector>

#include "tripatch/boundary/side.h"
#include "tripatch/cage/cage_options.h"
#include "tripatch/cage/cage_samples.h"

namespace tripatch {

/// Adds distances of the samples inside from points of a surface, one each, with its normals.
void add_points(const CageSystem& system, const Points& free, const Points& target, const Points& normal, const HoleSamples& hole,
                const CageOptions& options, CageSystem::Term& term);
/// Adds movements of the old limit surface.
void add_surroundings(const CageSystem& system, const Points& free, const HoleSamples& hole, const CageOptions& options,
                      CageSystem::Term& term);
/// The same while the cage is made fair: their mean square over that which is tolerated.
void hold_surroundings(const CageSystem& system, const Points& free, const HoleSamples& hole, double tolerated,
                       CageSystem::Term& term);

/// The rows of an exact rim: at a few places of each of its edges the derivative across.
struct Seam {
  struct Row {
    Sums across;
    Vec3 normal, inwards;
    double trust;
  };
  std::vector<Row> rows;
  double size = 0;  ///< of the hole
};
/// sides: what the fill is to be tangent to.
Seam seam_of(const CageSurfaces& surfaces, const SidedRim& hole, const CageSides& sides, const DirectedEdges& edges);
/// The derivative across shall lie in the tangent plane of the surroundings.
void add_seam(const CageSystem& system, const Points& free, const Seam& seam, const CageOptions& options, CageSystem::Term& term);

}  // namespace tripatch
