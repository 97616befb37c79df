// A fill for any rim: the surface of the surroundings is estimated as a field over a plane, and the hole is where its samples end.
//   1. a rough fill and rings of surroundings are laid into the plane with little distortion;
//   2. the samples get the parameters of their foot points on a smooth reference;
//   3. a Gaussian field goes through them, or near them where they are noisy;
//   4. what shall be met inside is added to it where it comes nearest;
//   5. the hole is triangulated in the plane, measured on the surface.
// A hole that is strongly curved is laid out a second time, with the fill instead of the rough one.
#pragma once

#include <memory>
#include <optional>

#include "tripatch/math/thresholds.h"
#include "tripatch/mesh/connectivity.h"
#include "tripatch/messages.h"
#include "tripatch/patch/through.h"
#include "tripatch/spline/polyharmonic_spline.h"

namespace tripatch {

/// Surroundings farther off than this share of the hole's diameter are not looked at.
constexpr double farthest_reach = share::half;

struct PlaneFillOptions {
  std::optional<int> resolution;  ///< a third of the rim has so many edges inside the fill; none: edges as long as the rim's
  /// Rows of the loops' vertices, loop by loop, that no inner edge may join, besides those that the mesh joins already.
  std::vector<std::array<Index, 2>> joined;
  /// What of the mesh is continued, where that is not all around; where nothing is, the loops alone are the samples.
  const Connectivity* continued = nullptr;
  std::vector<Through> through = {};  ///< met exactly inside; each is a vertex of the triangles
  Points planes = Points(0, 3);       ///< normals at the loops' vertices that the fill has there; no rows: what the samples say
  double size = 0;                    ///< of the hole that the loops go around a part of, scene units; less than their own: that
  bool only_likeliest = false;        ///< plain triangles follow if the likeliest way fails
};

struct PlaneFill {
  SurfacePtr surface;  ///< empty: plain triangles, no surface over a plane
  std::shared_ptr<const PolyharmonicSpline>
      field;                               ///< the same, but for an average with a second model, and points that are met inside
  PlanePoints rim_uv = PlanePoints(0, 2);  ///< of the loops' vertices, loop by loop
  Points vertices = Points(0, 3);          ///< the new ones
  PlanePoints uv = PlanePoints(0, 2);      ///< of these
  Points normals = Points(0, 3);
  /// Rows: the loops' vertices, loop by loop, then the new vertices.
  std::vector<std::array<Index, 3>> triangles;
  std::vector<std::array<Index, 2>> creases;  ///< edges of these along which the surface is sharp
  Points rim_normals = Points(0, 3);          ///< where creases end there; else those of the surface
  /// Edges folded by more than 120 degrees, those of the rim over the faces beyond too, but for such that are turned over.
  Index folds = 0;
  Index rim_folds = 0;            ///< the same of the rim's own triangulation without new vertices, and the faces turned over
  Eigen::VectorXd deviation;      ///< standard deviation at `vertices`, scene units; empty where there is no surface
  double fed_back = 0;            ///< share of an error that the layout hands on to the fill; `deviation` has it
  double surroundings_error = 0;  ///< degrees, root mean square: how well the samples determine the slope at the rim
  int rings = 0;
  std::optional<Message> plainer;  ///< why not the likeliest field through as many rings as there are
  bool doubles_edges = false;
};

/// Edges folded by more than 120 degrees in the rim's triangulation without new vertices, those of the rim over the faces beyond too, and
/// the faces beyond that are turned over: a fill that continues as those around them do folds there.
Index folds_of_rim(const Mesh& mesh, const Connectivity& around, const std::vector<std::vector<Index>>& loops);

/// loops: border loops in the direction of new faces, the outer one first, then islands. Choices that fold more than the rim does,
/// leave its neighborhood or double edges of the mesh give way to plainer ones: fewer rings, order 2, at last plain
/// triangles, which always exist.
PlaneFill fill_over_plane(const Mesh& mesh, const Connectivity& around, const std::vector<std::vector<Index>>& loops,
                          const PlaneFillOptions& options = {});

}  // namespace tripatch
