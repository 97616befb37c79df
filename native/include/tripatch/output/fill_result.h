// What a fill is: new vertices and faces, what changes in the mesh around, the patch that they lie on, and the report.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "tripatch/boundary/side.h"
#include "tripatch/math/plane.h"
#include "tripatch/patch/surface.h"
#include "tripatch/report/report.h"
#include "tripatch/types.h"

namespace tripatch {

/// Made once by `fill` and completed by the rooms that it passes through.
struct Fill {
  Points vertices;                     ///< the new vertices only
  Faces faces;                         ///< 0 .. n-1 are the mesh's own vertices, n .. are `vertices`, in each of several fills
  Points normals = Points(0, 3);       ///< exact unit normals of the patch at `vertices`
  Points barycentric = Points(0, 3);   ///< of `vertices`, on a patch of three sides
  PlanePoints uv = PlanePoints(0, 2);  ///< of `vertices`, on a patch over a plane domain
  std::vector<Index> rim;              ///< from corner 0 on
  Points rim_normals = Points(0, 3);   ///< exact one-sided normals of the fill at the rim
  Points rim_barycentric = Points(0, 3);
  PlanePoints rim_uv = PlanePoints(0, 2);
  /// Posterior standard deviation at each of `vertices`, scene units; empty: the method does not know it.
  Eigen::VectorXd deviation;
  /// Of a cage whose vertices lie on another fill: the expected error of that one, scene units.
  std::optional<double> known_error;
  /// Limit surroundings: a cage's vertices do not lie on its surface, so the fill is a mesh of its own (faces use n .. only);
  /// indices into `vertices` of its border, which takes the points that the modifier makes.
  std::vector<Index> border;
  /// Rim edges that were split, and where; the k-th takes vertices[k].
  std::vector<std::array<Index, 2>> split_edges;
  std::vector<double> split_t;
  std::vector<Index> moved;        ///< cage, rim `move`: vertices of the mesh
  Points moved_to = Points(0, 3);  ///< and where they go
  /// Cage: edges to be creased, those of an exact rim with 1, and others on which creases continue across the hole; how much.
  std::vector<std::array<Index, 2>> creases;
  std::vector<double> crease_values;
  /// Edges of the fill on which creases of the surroundings continue across the hole, and those of the rim where a lid meets the mesh at an angle.
  std::vector<std::array<Index, 2>> feature_edges;
  SurfacePtr patch;
  std::vector<Side> sides;  ///< the surroundings used; empty where the patch has no sides
  Report report;
  /// A place where it passes through another fill, or through a face of the mesh, that has no vertex of its boundary.
  std::optional<Vec3> passes_through;
};

/// Whether a fill is not what was asked for: by its report, or as it passes through the mesh.
inline bool is_flawed(const Fill& fill) { return is_flawed(fill.report) || fill.passes_through.has_value(); }
/// Whether all positions and normals are.
bool is_finite(const Fill& fill);
/// Refuses what came of numbers beyond all measure. rim: of the hole.
void refuse_infinite(const Fill& fill, const std::vector<Index>& rim);

}  // namespace tripatch
