// A hole of a subdivision cage, filled with a cage: layout, fit, what changes in the cage around, and the report.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "tripatch/boundary/limit_surface.h"
#include "tripatch/output/cage.h"
#include "tripatch/output/quad_cover.h"
#include "tripatch/report/report.h"

namespace tripatch {

struct CageFill {
  Points vertices;     ///< the new vertices only: first that of a split edge
  Points barycentric;  ///< of `vertices`
  Points rim_barycentric;
  Faces faces;  ///< 0 .. n-1 are the mesh's own vertices, n .. are `vertices`
  std::vector<std::array<Index, 2>> split_edges;
  std::vector<double> split_t;
  std::vector<Index> moved;
  Points moved_to = Points(0, 3);
  std::vector<std::array<Index, 2>> creases;
  SurfacePtr patch;
  Sides sides;
  Report report;  ///< the seam is the one between the limit surfaces
};

/// build: the patch on given sides.
CageFill fill_with_cage(const Mesh& mesh, const Hole& hole, const Subdivision& settings, const std::vector<Index>& replaced,
                        const LayoutOptions& layout_options, const CageOptions& options,
                        const std::function<SurfacePtr(const Sides&)>& build);

}  // namespace tripatch
