// Where fills pass through other faces of the mesh.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "tripatch/types.h"

namespace tripatch {

/// What of a fill is looked at.
struct FillFaces {
  PointsRef added;             ///< vertices beyond those of the mesh
  FacesRef faces;              ///< v >= the mesh's number of vertices is row v - that number of `added`
  std::span<const Index> rim;  ///< its boundary, islands included
};

/// For each of some fills a place where it passes through a face of the mesh that has no vertex of its boundary; none: nowhere. What
/// passes by less than `touching` (crossings.h) does not count. One pass over the mesh, against a tree of all fills' triangles.
std::vector<std::optional<Vec3>> passages(const Mesh& mesh, std::span<const FillFaces> fills);

}  // namespace tripatch
