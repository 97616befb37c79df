// Faces of a fill that go through each other: no edge need be folded for that.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "tripatch/mesh/triangles.h"
#include "tripatch/report/edges_by_vertex.h"

namespace tripatch {

/// Where the line from one point to another goes through a triangle with this unit normal, if by more than `least` it begins above or below,
/// ends on the other side and keeps off the triangle's edges.
std::optional<Vec3> passage(const Vec3& from, const Vec3& to, const std::array<Vec3, 3>& triangle, const Vec3& normal,
                            double least);

/// An edge that goes through a triangle which has none of its vertices.
struct Crossing {
  std::array<Index, 2> edge;
  std::array<Index, 3> triangle;
  Vec3 where;
};

/// Crossings of some faces, every face cut into a fan from its first corner; ends with the first `most` found, which hang on the order of
/// the faces, and an edge of two triangles may be found twice. vertices: of the mesh; v >= their number is row v - number of `added`.
std::vector<Crossing> find_crossings(const PointsRef& vertices, const PointsRef& added, const Faces& faces, std::size_t most);
/// The same with the edges of the faces' triangles (folded_triangles.h).
std::vector<Crossing> find_crossings(const PointsRef& vertices, const PointsRef& added, const Faces& faces, EdgesByVertex& edges,
                                     std::size_t most);

/// Whether there are any. points: all that the triangles use.
bool crosses_itself(const PointsRef& points, const Triangles& triangles);

}  // namespace tripatch
