// Sides of a hole whose surroundings meet it at an angle: whatever fills it smoothly cannot be tangent to them.
#pragma once

#include <span>
#include <vector>

#include "tripatch/choices.h"
#include "tripatch/mesh/connectivity.h"
#include "tripatch/messages.h"

namespace tripatch {

/// For each side between two corners (places in the rim, in rim order; two or more) the angle, degrees, at which the faces next to it
/// meet the hole, 0 where a smooth fill may continue them. At a corner a smooth fill's tangent plane is that of the rim's own tangents,
/// and of every side that it continues: a side whose faces lie in another plane at both of its corners is sharp. What coarse sides leave
/// open counts for smooth: a side of one edge is sharp between three or more others of one edge where all of them stand upright, sides of
/// two where all are.
std::vector<double> sharp_sides(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim,
                                std::span<const Index> places);

/// Whether any is.
bool any_sharp(const std::vector<double>& angles);

/// By side, what of its surroundings a fill continues: Free where that is left open and the side is sharp; and whether nothing is taken
/// from beyond it. The angles of sides that nobody has left open become 0.
struct SideTerms {
  std::vector<SideContinuity> continuity;
  std::vector<bool> alone;
};
SideTerms terms_of_sides(const BySide<SideContinuity>& given, std::vector<double>& angles);

/// What a user reads of them, a warning a side, or one of all.
void tell_sharp(const std::vector<double>& angles, Messages& warnings);

/// The faces that a fill does not continue, sorted: all but those that smooth edges connect with the faces next to the sides that are
/// not sharp, as far as those beyond the sharp ones.
std::vector<Index> not_continued(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim,
                                 std::span<const Index> places, const std::vector<double>& angles);

}  // namespace tripatch
