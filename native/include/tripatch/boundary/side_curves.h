// The curves of a side in a plain mesh: through the rim vertices, tangent to the planes and bending as the surface does.
#pragma once

#include <array>
#include <vector>

#include "tripatch/boundary/side.h"

namespace tripatch {

/// One side while it is made, in the units of the local mesh; vectors by rim vertex.
struct SideDraft {
  std::vector<int> vertex;  ///< of the local mesh
  std::vector<int> face;    ///< beside the edges
  std::vector<double> t;
  double length = 0;  ///< of the chords
  double depth = 1;   ///< of the faces beside the rim, across it, over the edges that they have on it
  std::vector<Vec3> position;
  std::vector<Vec3> point;              ///< the same in scene units
  std::vector<Vec3> tangent;            ///< unit, of the curve through the positions alone
  std::vector<Vec3> faces;              ///< unit normals: of the faces beside the rim,
  std::vector<Vec3> guess;              ///< and the best known so far
  std::vector<Vec3> normal;             ///< of the tangent planes
  std::vector<Eigen::Matrix3d> second;  ///< second fundamental form, of tangent vectors

  int edges() const { return static_cast<int>(vertex.size()) - 1; }
};

/// The cubic spline through the positions.
PiecewisePolynomial curve_through(const SideDraft& side);

/// Position, derivative across and second derivative across, in scene units: one unit of the drafts is `scale` of them. noise: variance
/// of a position, in the drafts' units.
Sides side_curves(const std::array<SideDraft, 3>& drafts, double scale, double noise);

}  // namespace tripatch
