// Patches over the triangle as patches over a polygon of three corners.
#pragma once

#include <vector>

#include "tripatch/patch/through.h"
#include "tripatch/polygon/patch.h"

namespace tripatch {

/// A patch over the triangle as one over a polygon of three corners: its corner k over the polygon's.
SurfacePtr over_domain(const PolygonDomain& domain, SurfacePtr patch);

/// Completes a patch between three sides whose surface is over the triangle: the domain, the points that it is to meet inside, and how it
/// meets its sides. Side k begins at corner k.
void complete_patch(const SideList& sides, const std::vector<Through>& through, PolygonPatch& made);

}  // namespace tripatch
