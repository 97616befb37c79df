// A patch over a polygon as quads: the layout with its vertices on the patch, as many rows as a tolerance asks for, and an even number
// of edges around.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tripatch/output/polygon_layout.h"
#include "tripatch/output/quad_cover.h"
#include "tripatch/patch/surface.h"

namespace tripatch {

struct PlaneCover {
  PlanePoints uv;  ///< the rim's rows first
  Index rim = 0;
  Faces faces;
  std::vector<Index> rim_rows;                ///< of the rim as given, one a rim row; -1 where an edge was split
  std::optional<std::array<Index, 2>> split;  ///< rows of the rim as given
  int rows = 0;                               ///< extra rows of quads
  std::vector<Index> poles;
  std::vector<std::string> warnings;
};

/// rim: places in a convex domain and `points` in space, a row each; corners: as polygon_layout takes them. met: places inside that
/// become vertices, as far as no quad is turned over by that; a warning else.
PlaneCover cover_polygon_with_quads(const PlanePoints& rim, const Points& points, std::vector<RimCorner> corners,
                                    const Surface& patch, const LayoutOptions& options, const std::vector<Vec2>& met = {});

}  // namespace tripatch
