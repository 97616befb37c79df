// The sides of a hole, and what follows from them for its fill.
#pragma once

#include <vector>

#include "tripatch/fill/fill_context.h"
#include "tripatch/messages.h"

namespace tripatch {

/// What an exact patch of the hole lies over.
enum class PatchDomain { none, triangle, polygon, disc };

struct SidesFound {
  PatchDomain domain = PatchDomain::none;
  Reason reason;                    ///< why there is no patch, or of the domain
  Hole hole = {};                   ///< of a triangle
  std::vector<Index> corners = {};  ///< of a polygon
  Corners of_spline = {};
  FillOptions options = {};    ///< with what the sides change in them
  bool has_lost_wall = false;  ///< which closes the hole
  bool is_flat = false;        ///< given corners, of a hole that has lost a wall
};

/// rim: checked; given: its corners, if they are known.
SidesFound found_sides(const FillContext& context, const std::vector<Index>& rim, const Corners& given,
                       const FillOptions& options);

}  // namespace tripatch
