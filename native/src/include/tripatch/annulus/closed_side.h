// A closed boundary of a mesh as one side: a periodic curve through its vertices with the derivatives across it.
#pragma once

#include <vector>

#include "tripatch/boundary/side.h"
#include "tripatch/boundary/vertex_planes.h"
#include "tripatch/math/canonical_start.h"
#include "tripatch/mesh/connectivity.h"

namespace tripatch {

struct ClosedSide {
  Side side;
  std::vector<double> t;          ///< of the vertices, and 1
  double surroundings_error = 0;  ///< degrees
};

/// rim: in the direction of new faces. backwards: whether what is read together is that of the same rim seen in a mirror.
ClosedSide closed_side(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim, bool backwards,
                       const VertexPlanes& planes = {});

/// Replaces planes at single vertices that are far off what their neighbors tell.
void mend_planes(ClosedSide& closed);

/// Where a closed rim begins and which way it is read, whatever vertex it is given from: what closing splines and nodes of quadratures
/// differ by is enlarged by flat valleys of the energy.
CanonicalStart beginning_of_closed(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim);

}  // namespace tripatch
