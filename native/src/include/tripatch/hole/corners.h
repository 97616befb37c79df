// The corners of a rim, detected.
#pragma once

#include <array>
#include <vector>

#include "tripatch/mesh/connectivity.h"

namespace tripatch {

/// Counted; a rim with more has none that is clear.
constexpr std::size_t max_corners = 12;

/// Places of the corners in the rim, in rim order: where it turns, read in the tangent plane of the surface, or where a rim of quads
/// leaves the lines of its grid, if that makes three. `rim` from its lowest vertex on, so that the same rim gives the same corners.
/// Thirteen where there are more than twelve, none of which is clear. Refusal: the faces around have no area.
std::vector<Index> detect_corners(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim);

/// The same where there are three; a Refusal else.
std::array<Index, 3> three_corners(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim);

/// Whether the rim is smooth all around: it has no corner, neither outwards nor inwards.
bool is_round(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim);

/// As detect_corners finds them: three, or two to twelve with smooth sides between them and no corner inwards; else none.
std::vector<Index> corners_between_sides(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim);

/// As detect_corners finds them, where the mesh meets the hole at an angle between them: there the rim alone tells its sides. Of a rim of
/// up to six edges every vertex may be one. Else none.
std::vector<Index> corners_between_sharp(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim);

/// Those of both kinds between which a patch is made where nobody gives any.
std::vector<Index> corners_of_fill(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim);

}  // namespace tripatch
