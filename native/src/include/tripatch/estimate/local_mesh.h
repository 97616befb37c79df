// The faces around a hole in coordinates of their own, and which of their edges are sharp: what tangent planes are estimated from.
#pragma once

#include <vector>

#include "tripatch/hole/hole.h"
#include "tripatch/mesh/submesh.h"

namespace tripatch {

/// Rings of faces around a rim that the estimate of its surroundings reads, and one that it only looks at.
constexpr int max_rings = 6;

/// All numbers are those of `part`; positions are about `origin`, over `scale`.
struct LocalMesh {
  Submesh part;
  std::vector<Vec3> position;
  std::vector<Vec3> area;          ///< of faces: normal times twice the area; zero where that is rounding
  std::vector<double> twice_area;  ///< its length
  std::vector<Vec3> normal_at;     ///< of vertices: along the sum of the areas of their faces; zero where that is
  std::vector<int> rim;            ///< vertices
  std::vector<int> beside;         ///< face that holds rim edge k reversed
  std::vector<int> across;         ///< face beyond the edge that starts at a corner; -1: none, or the edge is sharp
  std::vector<char> on_chord;      ///< vertices that were put on an edge and left there: they say nothing of the surface
  Vec3 origin = Vec3::Zero();
  double scale = 1;  ///< mean rim edge

  /// In the mesh.
  Index vertex(int v) const { return part.vertex.items()[v]; }
};

/// around: of the mesh at least as far as max_rings around the rim. Throws a Refusal where a vertex within them is not finite, or a
/// rim edge has no length or no face next to it.
LocalMesh local_mesh(const Mesh& mesh, const Connectivity& around, const Hole& hole);

}  // namespace tripatch
