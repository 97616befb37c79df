// Triangles of polygons in the plane, and of faces with many corners.
#pragma once

#include <vector>

#include "tripatch/math/plane.h"
#include "tripatch/mesh/triangles.h"

namespace tripatch {

/// Whether all triangles are counterclockwise, and none without an area.
bool all_positive(const PlanePoints& uv, const Triangles& triangles);

/// Of a polygon, counterclockwise, whose further loops start at the rows of `islands`: triangles that are all positive. Empty where it
/// crosses or touches itself.
Triangles triangulate_polygon(const PlanePoints& uv, const std::vector<Index>& islands = {});

/// The same of any number of loops, joined by the shortest edges between them that cross none.
Triangles triangulate_bridged(const PlanePoints& uv, const std::vector<Index>& islands);

/// Of a face, n - 2 by rows of its corners (n, 3): a fan from the first corner, of quads along the shorter diagonal. Otherwise if
/// one of these triangles is flipped or has no area, as in concave faces and those with corners in a line. Then such as are not,
/// where there are any.
Triangles triangulate_face(const PointsRef& corners);

}  // namespace tripatch
