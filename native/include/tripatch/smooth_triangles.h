// A whole triangle mesh with vertex normals becomes one G1 surface: a side-vertex patch over every triangle, with the same curve
// and the same normal field along a shared edge from both sides (sides_from_normals; B. Smits 2000).
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "tripatch/boundary/normal_sides.h"
#include "tripatch/patch/surface.h"
#include "tripatch/types.h"

namespace tripatch {

struct SmoothMesh {
  /// The mesh's own vertices, in place; then resolution - 1 points of every edge; then the points inside every face.
  Points vertices;
  Points normals;  ///< exact unit normals of the surface at `vertices`; zero at vertices that no face uses
  /// resolution^2 triangles for every face, in the faces' order, with their orientation.
  std::vector<std::array<Index, 3>> faces;
  /// Every edge once, lower index first. Point k = 1 .. resolution - 1 of edge e, counted from edges[e][0], is vertex
  /// n + e (resolution - 1) + k - 1.
  std::vector<std::array<Index, 2>> edges;
  std::vector<SurfacePtr> patches = {};  ///< of every face, corners in its order; where they are kept
};

/// Edges on a side that a triangle is cut into, at most: 65,536 triangles in its place. A choice, against slips of the hand.
constexpr int max_smooth_resolution = 256;

/// normals: n x 3, outer or inner, of any length; none: estimated, the faces' normals weighted by their angles. resolution: edges
/// that each edge is cut into; keep: the patches too. Throws a Refusal for faces that are not triangles or have no area, points that are not finite, and
/// normals that determine no curve; InvalidArgument for shapes and ranges.
SmoothMesh smooth_triangles(const Mesh& mesh, const std::optional<Points>& normals = {}, int resolution = 8,
                            NormalCurve curve = NormalCurve::hermite, bool keep = false);

/// The same from a curve with a derivative across for every edge, which give the planes along it: sides[e] runs from vertex edges[e][0] to
/// edges[e][1], with its normal (r x c') on the side on which all others have it. Throws a Refusal where an edge has none, where a
/// curve does not begin or end at its vertex, and where the planes of the curves at a vertex are not one.
SmoothMesh network(const Mesh& mesh, const std::vector<std::array<Index, 2>>& edges, const std::vector<Side>& sides,
                   int resolution = 8);

}  // namespace tripatch
