// A patch over a polygon as quads: the layout with its vertices on the patch, as many rows as a tolerance asks for, and an even number
// of edges around.
#pragma once

#include <optional>
#include <vector>

#include "tripatch/messages.h"
#include "tripatch/output/quad_cover.h"
#include "tripatch/patch/surface.h"
#include "tripatch/quads/polygon_layout.h"

namespace tripatch {

struct PlaneCover {
  PlanePoints uv;  ///< the rim's rows first
  Index rim = 0;
  Faces faces;
  std::vector<Index> rim_rows;                ///< of the rim as given, one a rim row; -1 where an edge was split
  std::optional<std::array<Index, 2>> split;  ///< rows of the rim as given
  int rows = 0;                               ///< extra rows of quads
  std::vector<Index> poles;
  Messages warnings;
};

/// rim: places in a convex domain and `points` in space, a row each; corners: as polygon_layout takes them. met: places inside that
/// become vertices, as far as no quad is turned over by that; a warning else. Without corners, and where neither rows nor a tolerance are
/// given, as many rows as make the quads about as large as squares of the rim's edges. No faces where a rim that stays odd has neither corners
/// nor a layout with one triangle.
PlaneCover cover_polygon_with_quads(const PlanePoints& rim, const Points& points, std::vector<RimCorner> corners,
                                    const Surface& patch, const LayoutOptions& options, const std::vector<Vec2>& met = {});

/// A layout in the unit circle, the rim's vertices evenly around it from (1, 0) on: rows along the rim, and within them a grid whose four corners
/// are poles of valence 3. An odd rim leaves one triangle, or has no such layout.
std::optional<PlaneLayout> disc_layout(Index edges, int rows);
/// A grid in a square with its corners at these four rows of the rim; none where opposite sides have not as many edges.
std::optional<PlaneLayout> square_layout(Index edges, const std::vector<Index>& corners, int rows);

}  // namespace tripatch
