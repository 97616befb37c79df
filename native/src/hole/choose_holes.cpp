#include "tripatch/hole/choose_holes.h"

#include <utility>

#include "tripatch/hole/corners.h"
#include "tripatch/hole/outer_borders.h"
#include "tripatch/messages.h"
#include "tripatch/options.h"

namespace tripatch {
namespace {

/// Detected; none where the faces around the rim do not tell.
int count_corners(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim) {
  try {
    return static_cast<int>(detect_corners(mesh, around, rim).size());
  } catch (const Refusal&) {
    return 0;
  }
}

}  // namespace

std::vector<std::vector<Index>> chosen_among(const std::vector<Border>& borders, const Mesh& mesh, const Connectivity& around,
                                             const HoleChoice& choice) {
  check(choice);
  if (choice.corner_count && (*choice.corner_count)[0] > (*choice.corner_count)[1])
    throw CodedArgument(Code::corner_counts_not_in_order, {{"option", "corner_count"}});
  std::vector<std::vector<Index>> chosen;
  for (const Border& border : borders) {
    if (border.outer && !choice.outer) continue;
    if (choice.max_edges && std::cmp_greater(border.loop.size(), *choice.max_edges)) continue;
    if (choice.max_diameter && !(border.diameter <= *choice.max_diameter)) continue;
    if (choice.corner_count) {
      const int corners = count_corners(mesh, around, border.loop);
      if (corners < (*choice.corner_count)[0] || corners > (*choice.corner_count)[1]) continue;
    }
    chosen.push_back(border.loop);
  }
  return chosen;
}

std::vector<std::vector<Index>> choose_holes(const Mesh& mesh, const HoleChoice& choice) {
  const Connectivity around(mesh);
  return chosen_among(borders_of(mesh, around), mesh, around, choice);
}

}  // namespace tripatch
