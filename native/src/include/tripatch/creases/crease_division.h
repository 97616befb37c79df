// The creases in a hole as lines of new points, and the loops around the parts between them.
#pragma once

#include <vector>

#include "tripatch/creases/features.h"
#include "tripatch/spline/plane_fill.h"

namespace tripatch {

using VertexLoop = std::vector<Index>;

/// New points are numbered after the mesh's vertices.
struct Division {
  const Mesh& mesh;
  std::vector<VertexLoop> loops, curves = {};  ///< curves: with their ends
  std::vector<Vec3> points = {};               ///< the new ones
  std::vector<double> deviations = {};         ///< of these
  double even = 0;                             ///< length of new edges, if a resolution is given

  Index first() const { return mesh.vertices.rows(); }
  Index added() const { return static_cast<Index>(points.size()); }
  Vec3 point(Index v) const { return v < first() ? Vec3(mesh.vertices.row(v)) : points[static_cast<std::size_t>(v - first())]; }
  double deviation(Index v) const { return v < first() ? 0 : deviations[static_cast<std::size_t>(v - first())]; }
};

/// rim: as new faces traverse it.
Division divided(const Mesh& mesh, const VertexLoop& rim, const Features& features, const PlaneFillOptions& options);

}  // namespace tripatch
