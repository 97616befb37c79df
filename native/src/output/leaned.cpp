#include "tripatch/output/leaned.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "tripatch/estimate/corner_planes.h"
#include "tripatch/math/angle.h"
#include "tripatch/spline/hermite_correction.h"
#include "tripatch/spline/plane_patch.h"

namespace tripatch {

namespace {

/// Normals at the rim's vertices, zero where nothing is to change: where no plane is known, or the fill continues another surface.
Points wanted_normals(const VertexPlanes& planes, const Fill& fill) {
  Points wanted = Points::Zero(static_cast<Index>(fill.rim.size()), 3);
  for (Index k = 0; k < std::min(wanted.rows(), fill.rim_normals.rows()); ++k)
    if (const auto known = planes.find(fill.rim[k]); known != planes.end())
      if (is_one_plane(degrees_between(fill.rim_normals.row(k), known->second), INFINITY)) wanted.row(k) = known->second;
  return wanted;
}

}  // namespace

void lean(const VertexPlanes& planes, Fill& fill) {
  const auto patch = std::dynamic_pointer_cast<const PlanePatch>(fill.patch);
  if (planes.empty() || !fill.feature_edges.empty() || (fill.patch && !patch)) return;
  const Points wanted = wanted_normals(planes, fill);
  if (wanted.isZero(0)) return;
  if (!patch) {
    for (Index k = 0; k < wanted.rows(); ++k)
      if (!wanted.row(k).isZero(0)) fill.rim_normals.row(k) = wanted.row(k);
    return;
  }
  const auto more = std::make_shared<HermiteCorrection>(*patch, fill.rim_uv, PlanePoints(0, 2), std::vector<Through>(), wanted);
  const SurfacePtr leaned = sum(patch->surface(), more);
  fill.patch = std::make_shared<PlanePatch>(leaned, patch->rim());
  fill.rim_normals = leaned->normals(as_rows(fill.rim_uv));
  if (fill.uv.rows() == 0) return;
  fill.vertices += more->positions(as_rows(fill.uv));
  fill.normals = leaned->normals(as_rows(fill.uv));
}

}  // namespace tripatch
