// A cheap proof that faces do not go through each other.
#pragma once

#include "tripatch/report/edges_by_vertex.h"

namespace tripatch {

/// Whether some faces, each cut into a fan from its first corner, surely lie over a plane one to one, so that none goes through
/// another. Then their border is one loop that is a simple polygon along its own vector area, and every triangle is seen from its
/// front. A point of the plane is then covered as often as the polygon winds round it: once or not at all. False says nothing.
/// vertices: of the mesh; v >= their number is row v - number of `added`. edges: of the triangles.
bool surely_one_to_one(const PointsRef& vertices, const PointsRef& added, const Faces& faces, EdgesByVertex& edges);
/// The same of triangles that are known to have this one border, each inner edge between two of them that agree in orientation.
bool surely_one_to_one(const PointsRef& vertices, const PointsRef& added, const Faces& faces, std::span<const Index> border);

}  // namespace tripatch
