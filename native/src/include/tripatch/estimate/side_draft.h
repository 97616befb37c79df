// A side of a hole in a plain mesh while its planes are estimated.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "tripatch/types.h"

namespace tripatch {

/// One side while it is made, in the units of the local mesh; vectors by rim vertex.
struct SideDraft {
  std::vector<int> vertex;  ///< of the local mesh
  std::vector<int> face;    ///< next to the edges
  std::vector<double> t;
  double length = 0;      ///< of the chords
  bool from_end = false;  ///< looked at from its end on, by its geometry: in a mirror it is the same
  double depth = 1;       ///< of the faces next to the rim, across it, over the edges that they have on it
  std::vector<Vec3> position;
  std::vector<Vec3> point;              ///< the same in scene units
  std::vector<Vec3> tangent;            ///< unit, of the curve through the positions alone
  std::vector<Vec3> faces;              ///< unit normals: of the faces next to the rim,
  std::vector<Vec3> guess;              ///< and the best known so far
  std::vector<Vec3> normal;             ///< of the tangent planes
  std::vector<Eigen::Matrix3d> second;  ///< second fundamental form, of tangent vectors

  int edges() const { return static_cast<int>(vertex.size()) - 1; }
  /// The j-th vertex that is looked at.
  int looked_at(int j) const { return from_end ? edges() - j : j; }
};

/// Whether the sides of a rim of so many vertices are worth threads of their own.
inline bool is_long(std::size_t vertices) { return vertices >= 30; }

}  // namespace tripatch
