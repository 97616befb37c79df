// The path of n sides: what surrounds a hole between its corners, the patch over a polygon between them, and faces on it.
#pragma once

#include <vector>

#include "tripatch/annulus/closed_side.h"
#include "tripatch/boundary/polygon_sides.h"
#include "tripatch/boundary/vertex_planes.h"
#include "tripatch/hole/sharp_sides.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/mesh/connectivity.h"
#include "tripatch/options.h"
#include "tripatch/output/fill_result.h"
#include "tripatch/patch_from_sides.h"
#include "tripatch/polygon/patch.h"
#include "tripatch/polygon/round.h"

namespace tripatch {

struct LayoutOptions;

/// What of the options concerns layouts of quads.
LayoutOptions layout_options(const FillOptions& options);
/// What of the options concerns a patch of n sides.
PolygonPatchOptions polygon_options(const FillOptions& options);

/// Places in the domain, those on the sides first, in rim order; and faces between them.
struct PolygonTriangles {
  PlanePoints uv;
  Faces faces;
};
/// parameters: of the points on each side, from 0 to 1. resolution: edges a side inside; none: as the sides.
PolygonTriangles triangulate_polygon(const PolygonSurface& patch, const std::vector<std::vector<double>>& parameters,
                                     std::optional<int> resolution);
/// The same of a disc, from parameters along its one side, 1 among them.
PolygonTriangles triangulate_disc(const Surface& patch, const std::vector<double>& parameters, std::optional<int> resolution);

/// As patch_from_sides, over a polygon: on sides of a cage. points: places (u, v, 0) where it is about to pass them.
MadePatch patch_over_polygon(const SideList& sides, const PolygonDomain& domain, const FillOptions& options,
                             const SurfacePoints* points);

/// What is reported of a patch, whatever is made of it; of three sides in the order of a triangle's.
void report_patch(const PolygonPatch& made, Report& report);
void report_patch(const RoundPatch& made, Report& report);

struct PolygonFill {
  Fill fill;
  bool gave_up = false;        ///< no energy serves: another kind of fill may do better
  bool of_revolution = false;  ///< as its surroundings are
};

/// The sides of a hole between its corners, read for a patch.
struct PolygonInput {
  std::vector<Index> rim, corners;  ///< as of polygon_sides
  std::vector<double> angles;       ///< by side, as of sharp_sides
  SideTerms terms;
  PolygonSides known;
  double planes_error = 0;  ///< degrees; 0: a side meets the mesh in position only
};
/// Takes account of the options' continuity.
PolygonInput polygon_input(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim,
                           const std::vector<Index>& corners, const FillOptions& options, const VertexPlanes& planes = {});
/// folded_too: else a patch that folds has no faces, which take most of the time.
PolygonFill fill_with_polygon(const Mesh& mesh, const Connectivity& around, const PolygonInput& input, const FillOptions& options,
                              bool folded_too = true);

/// A round rim has at least so many edges.
constexpr Index min_round = count::half_dozen;
/// The one side of a hole without corners, read for a patch over a disc.
struct DiscInput {
  std::vector<Index> rim;
  Index first = 0;  ///< the place of the rim's vertex that the side begins at
  ClosedSide known;
  double planes_error = 0;  ///< degrees; 0: the surroundings are of revolution, and the patch with them
};
/// rim: in the direction of new faces, min_round edges or more.
DiscInput disc_input(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim, const FillOptions& options,
                     const VertexPlanes& planes = {});
/// folded_too: as above.
PolygonFill fill_round(const Mesh& mesh, const Connectivity& around, const DiscInput& input, const FillOptions& options,
                       bool folded_too = true);

}  // namespace tripatch
