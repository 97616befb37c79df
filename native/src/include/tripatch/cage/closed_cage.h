// A cage with layouts in its holes: one closed mesh, and where the fills and their surroundings are in it.
#pragma once

#include <array>
#include <map>
#include <utility>
#include <vector>

#include "tripatch/cage/sided_rim.h"
#include "tripatch/mesh/connectivity.h"
#include "tripatch/quads/quad_layout.h"

namespace tripatch {

/// A hole and the layout in it, whose first rows are the rim's.
struct CageHole {
  SidedRim hole;
  QuadLayout layout;
};

struct ClosedCage {
  Points vertices;  ///< the mesh's own, then the insides of the fills
  Faces faces;
  std::vector<Index> kept;        ///< given face of each of the first faces
  std::vector<Index> first_face;  ///< of each fill, and the end
  std::vector<Index>
      first_vertex;  ///< of each fill's inside, and the end; they start in the plane of three corners, of others between the rim's
  Mesh mesh() const { return {vertices, faces}; }
};

/// replaced: faces in the holes, which are left out.
ClosedCage close_holes(const Mesh& mesh, const std::vector<CageHole>& holes, const std::vector<Index>& replaced);

/// LruCache faces around a hole by ring, in their order: those that touch the rim, and those that touch them. whole: of the cage.
std::array<std::vector<Index>, 2> rings_around(const ClosedCage& cage, const Connectivity& whole, const SidedRim& hole);

struct FaceEdge {
  Index face = -1;
  int edge = 0;  ///< from the face's corner of that number to the next
};
using DirectedEdges = std::map<std::pair<Index, Index>, FaceEdge>;
/// The face at each edge of the rims, in both directions. whole: of the closed cage.
DirectedEdges rim_edges(const Connectivity& whole, const std::vector<CageHole>& holes);

}  // namespace tripatch
