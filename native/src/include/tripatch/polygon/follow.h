// A patch over a polygon near to points of another surface, in place of a fair one.
#pragma once

#include "tripatch/fairing/follow.h"
#include "tripatch/polygon/surface.h"

namespace tripatch {

/// Moves places (u, v, -) to where the surface is nearest to points: Gauss-Newton from where they are, kept in the polygon. Returns the
/// distances.
Eigen::VectorXd nearest_in_polygon(const Surface& surface, const PolygonDomain& domain, const Points& points, Points& uv);

/// Of the patches that differ from `plain` in the terms of fairing that keep its sides and tangent planes the one that is nearest to the
/// points, by least squares: distances along the surface count a tenth. points.barycentric: places (u, v, -). size: of the hole.
SurfacePtr follow_over_polygon(const SurfacePtr& plain, const PolygonDomain& domain, SurfacePoints points, double size);

}  // namespace tripatch
