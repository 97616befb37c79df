// Corners that a rim has beyond doubt, for patches of any number of sides.
#pragma once

#include <vector>

#include "tripatch/mesh/connectivity.h"

namespace tripatch {

/// Places in the rim, in rim order, where it turns at single vertices by so much more than next to them that what lies between is a
/// smooth side each: two to twelve of them, or none where it is not so. Where the mesh meets any of them at an angle the rim alone tells.
/// rim: in the direction of new faces.
std::vector<Index> clear_corners(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim);

/// Whether the rim is smooth all around: at no vertex it turns by much more than next to it, or back.
bool is_round(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim);

/// Places of the corners between smooth sides: four or more clear ones, else three as detect_corners finds them, else none.
std::vector<Index> corners_between_sides(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim);

/// As detect_corners finds them, where the mesh meets the hole at an angle between them: there the rim alone tells its sides. Of a rim of
/// up to six edges every vertex may be one. Else none.
std::vector<Index> corners_between_sharp(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim);

/// Those of both kinds between which a patch is made where nobody gives any.
std::vector<Index> corners_of_fill(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim);

}  // namespace tripatch
