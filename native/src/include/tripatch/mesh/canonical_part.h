// What surrounds a hole, numbered by its geometry: whatever numbers the mesh has, wherever its rim is begun, and in a mirror too it is
// the same part. What is then done in the order of numbers, or chosen among equals by them, does not hang on how a mesh is written down.
#pragma once

#include <vector>

#include "tripatch/mesh/connectivity.h"

namespace tripatch {

struct CanonicalPart {
  Points vertices;                        ///< the loops' first, then as they are met from there; where it is mirrored x is -x
  Faces faces;                            ///< as they are met from the loops, each from the vertex that it is met from
  std::vector<std::vector<Index>> loops;  ///< in the direction of new faces, the outer one first
  std::vector<Index> vertex, face;        ///< of the mesh
  std::vector<Index> row;                 ///< of all given loops in a row, for each vertex of `loops` in a row
  bool mirrored = false;                  ///< faces are turned as well
};

/// loops: border loops in the direction of new faces, the outer one first. some: the faces around, with all vertices that count. Where
/// several beginnings of a rim are alike as far as these faces reach, it is that of the lowest number.
CanonicalPart canonical_part(const Mesh& mesh, const Connectivity& around, const std::vector<std::vector<Index>>& loops,
                             const std::vector<Index>& some);

}  // namespace tripatch
