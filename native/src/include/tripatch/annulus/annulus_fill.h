// A ring of faces between two boundaries of a mesh, tangent to both.
#pragma once

#include "tripatch/mesh/connectivity.h"
#include "tripatch/options.h"
#include "tripatch/output/fill_result.h"

namespace tripatch {

/// rim, island: in the direction of new faces. The fill's rim has the vertices of both, one after the other.
Fill fill_with_annulus(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim,
                       const std::vector<Index>& island, const FillOptions& options);

}  // namespace tripatch
