// Holes of a subdivision cage, filled with cages: layout, fit, what changes in the cage around, and the report.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "tripatch/boundary/limit_surface.h"
#include "tripatch/cage/cage.h"
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

/// A hole, and how the patch in it is made, see CageHole::build.
struct CageRequest {
  Hole hole;
  std::function<SurfacePtr(const Sides&, const SurfacePoints&)> build;
};

/// Holes whose surroundings may overlap, fitted together. replaced: the faces in them, of all. Every result counts its new vertices
/// on its own.
std::vector<CageFill> fill_with_cages(const Mesh& mesh, const std::vector<CageRequest>& requests, const Subdivision& settings,
                                      const std::vector<Index>& replaced, const LayoutOptions& layout_options,
                                      const CageOptions& options);

}  // namespace tripatch
