// The surroundings of a hole in a plain mesh, estimated: three sides that pass exactly through the rim vertices, with tangent
// planes from the faces around.
#pragma once

#include <array>

#include "tripatch/boundary/side.h"
#include "tripatch/boundary/vertex_planes.h"
#include "tripatch/estimate/local_mesh.h"

namespace tripatch {

struct MeshSides {
  Sides sides;
  /// Parameter of every rim vertex on its side, by chord length: parameters[i] has one more entry than side i has edges.
  std::array<std::vector<double>, 3> parameters;
  /// Degrees: rms over the rim of the standard deviation of the estimated tangent plane: how well the mesh determines its own
  /// tangent planes, from its noise and from what the local polynomials leave out. Of the sides that are continued.
  double surroundings_error = 0;
  std::array<double, 3> side_error = {};               ///< the same of each side by itself
  std::array<std::vector<double>, 3> slope_variances;  ///< radians squared, of the planes at the vertices of each side
};

/// Sides through the rim vertices, c and r twice continuously differentiable, with q; see docs/mathematics/surroundings.md. planes: those
/// that the sides have whatever the mesh tells.
/// around: of the mesh at least as far as max_rings around the rim, without faces to be replaced. Takes time by the hole. Throws a
/// Refusal where a vertex within the rings is not finite, a rim edge has no length or no face next to it, or the faces next to a rim
/// vertex have no area.
MeshSides mesh_sides(const Mesh& mesh, const Connectivity& around, const Hole& hole, const VertexPlanes& planes = {});
/// The same for one hole. `replaced`: faces that count as not there.
MeshSides mesh_sides(const Mesh& mesh, const Hole& hole, const std::vector<Index>& replaced = {});

}  // namespace tripatch
