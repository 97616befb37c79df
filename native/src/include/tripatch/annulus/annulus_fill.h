// A ring of faces between two boundaries of a mesh, tangent to both.
#pragma once

#include "tripatch/annulus/annulus_patch.h"
#include "tripatch/mesh/connectivity.h"
#include "tripatch/options.h"
#include "tripatch/output/fill_result.h"

namespace tripatch {

/// rim, island: in the direction of new faces. The fill's rim has the vertices of both, one after the other.
Fill fill_with_annulus(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim,
                       const std::vector<Index>& island, const FillOptions& options);

struct AnnulusTriangles {
  PlanePoints uv;  ///< on the first side, on the second, inside
  Faces faces;
};
/// first, second: parameters of the points on the sides, each in its own direction, without 1. rings: of faces; none: as wide as the edges along.
AnnulusTriangles triangulate_annulus(const OverAnnulus& ring, const std::vector<double>& first, const std::vector<double>& second,
                                     std::optional<int> rings);

void report_patch(const AnnulusPatch& made, Report& report);

}  // namespace tripatch
