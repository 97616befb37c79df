// The loops of a rim as one polygon in space.
#pragma once

#include <vector>

#include "tripatch/mesh/edge_key.h"
#include "tripatch/report/folded_triangles.h"
#include "tripatch/triangulation/min_weight_triangulation.h"

namespace tripatch {

/// A closed polygon of rim vertices, some of which may occur twice (bridges). normals[k]: beyond the edge from k to the next.
struct RimPolygon {
  std::vector<Index> vertices;
  std::vector<Vec3> normals;
  Index size() const { return static_cast<Index>(vertices.size()); }
};

/// All loops as one polygon, which walks every bridge twice. joined: pairs of rows, sorted; bridges: gets them, sorted. Throws
/// InvalidArgument for loops of fewer than 3 vertices and rows that do not fit.
RimPolygon one_polygon(const PointsRef& points, const RimSurroundings& rim, const std::vector<EdgeKey>& joined,
                       std::vector<EdgeKey>& bridges);

/// The faces beyond the edges of a polygon.
std::vector<AdjacentFace> beyond_of(const RimPolygon& polygon);

}  // namespace tripatch
