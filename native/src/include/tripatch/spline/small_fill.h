// The fill of a hole of few edges where the mesh around hardly bends, as meshes made by programs have them by the thousand.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "tripatch/boundary/vertex_planes.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/output/fill_result.h"

namespace tripatch {

/// Edges of the longest rim that is filled so.
constexpr std::size_t max_edges_of_small = count::octet;

/// rim: a border loop in the direction of the new faces. Triangles by Delaunay in the plane of the faces of two rings around, on
/// the polyharmonic spline through the vertices of the two rings. New vertices are added where triangles would be larger than the
/// edges of the rim ask for (Liepa 2003, "Filling holes in meshes"). No patch. Nothing where one of these faces is turned from
/// the plane, or from one next to it, as far as at a crease (needles aside), where the rim is seen from above crossing itself, or
/// where the triangles would double an edge of the mesh.
std::optional<Fill> fill_small(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim);

/// By vertex of the rim the planes of the quadric through the vertices of two rings. Empty of longer rims, where one of the faces of
/// the two rings is turned as far as at a crease, and where they have too few vertices.
std::vector<SeenPlane> planes_of_small(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim);

/// The triangle of a rim of three edges, without a patch; nothing where it would be folded over a face beyond.
std::optional<Fill> fill_with_one_triangle(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim);

}  // namespace tripatch
