// The surroundings of a hole in a plain mesh, estimated: three sides that pass exactly through the rim vertices, with tangent
// planes from the faces around.
#pragma once

#include <array>

#include "tripatch/boundary/side.h"
#include "tripatch/hole/hole.h"

namespace tripatch {

struct MeshSides {
  Sides sides;
  /// Parameter of every rim vertex on its side, by chord length: parameters[i] has one more entry than side i has edges.
  std::array<std::vector<double>, 3> parameters;
  /// Degrees: rms over the rim of the spread between estimates of the tangent plane from two stencil sizes: how well the mesh
  /// determines its own tangent planes.
  double surroundings_error = 0;
};

MeshSides mesh_sides(const Mesh& mesh, const Hole& hole, const std::vector<Index>& replaced = {});

}  // namespace tripatch
