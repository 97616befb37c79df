// Faces between two closed rows of vertices: rows of quads from one to the other, and rings along both.
#pragma once

#include <vector>

#include "tripatch/math/plane.h"
#include "tripatch/types.h"

namespace tripatch {

/// Places (u, v): rows of the first boundary, v = 0, then those of the second, v = 1, then those inside.
struct AnnulusLayout {
  PlanePoints uv;
  Faces faces;               ///< along the first boundary forwards
  std::vector<Index> poles;  ///< rows inside that are no corner of four faces
};

/// first: u of the vertices of the first boundary, in its order, which is that of increasing u, from any of them on; second: of the other, in
/// its own order, in which u decreases. rings: of faces, 1 or more. Where the two have the same number of vertices all faces are quads. Else
/// so many vertices as the numbers differ by are irregular: rows end by twos in quads, where a ring inside has room (a pole of three and one of
/// five edges), else one by one in triangles. all_quads: whether rows end by twos where they can.
AnnulusLayout annulus_layout(const std::vector<double>& first, const std::vector<double>& second, int rings, bool all_quads);

}  // namespace tripatch
