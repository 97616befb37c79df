// The corners of a rim, detected.
#pragma once

#include <array>
#include <vector>

#include "tripatch/mesh/connectivity.h"

namespace tripatch {

/// Places of the corners in the rim, in rim order: where it turns, read in the tangent plane of the surface, or where a rim of quads
/// leaves the lines of its grid, if that makes three. `rim` from its lowest vertex on, so that the same rim gives the same corners.
/// Thirteen where there are more than twelve, none of which is clear. Refusal: the faces around have no area.
std::vector<Index> detect_corners(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim);

/// The same where there are three; a Refusal else.
std::array<Index, 3> three_corners(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim);

}  // namespace tripatch
