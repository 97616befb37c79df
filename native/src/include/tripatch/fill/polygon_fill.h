// The path of n sides: what surrounds a hole between its corners, the patch over a polygon between them, and faces on it.
#pragma once

#include <functional>
#include <vector>

#include "tripatch/boundary/vertex_planes.h"
#include "tripatch/mesh/connectivity.h"
#include "tripatch/options.h"
#include "tripatch/output/fill_result.h"
#include "tripatch/patch_from_sides.h"
#include "tripatch/polygon/patch.h"
#include "tripatch/polygon/round.h"

namespace tripatch {

struct LayoutOptions;

/// The sides of a hole in a mesh as estimated from the faces around it, three corners at a time.
struct MeshPolygon {
  SideList sides;
  std::vector<std::vector<double>> parameters;  ///< of the rim's vertices on each side
  double surroundings_error = 0;                ///< degrees
};

/// rim: from corner 0 on, in the direction of new faces; corners: places in it, increasing, the first 0, two or more. alone: by side, or
/// none: as of Hole. Takes time by the hole.
MeshPolygon mesh_polygon(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim,
                         const std::vector<Index>& corners, const std::vector<bool>& alone = {}, const VertexPlanes& planes = {});

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

/// Called before a patch is made whose sides all have tangent planes, with the error of these in degrees; may throw to have it not made.
using PlanesEstimated = std::function<void(double degrees)>;

struct PolygonFill {
  Fill fill;
  bool gave_up = false;        ///< no energy serves: another kind of fill may do better
  bool of_revolution = false;  ///< as its surroundings are
};
/// folded_too: else a patch that folds has no faces, which take most of the time.
PolygonFill fill_with_polygon(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim,
                              const std::vector<Index>& corners, const FillOptions& options, bool folded_too = true,
                              const VertexPlanes& planes = {}, const PlanesEstimated& estimated = {});

/// A round rim has at least so many edges.
constexpr Index min_round = 6;
/// The patch over a disc whose rim has no corners. rim: in the direction of new faces, min_round edges or more. folded_too: as above. estimated:
/// not called if the surroundings are of revolution, and the patch with them.
PolygonFill fill_round(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim, const FillOptions& options,
                       bool folded_too = true, const VertexPlanes& planes = {}, const PlanesEstimated& estimated = {});

}  // namespace tripatch
