// Where fills pass through other faces of the mesh.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "tripatch/boundary/limit_surface.h"
#include "tripatch/types.h"

namespace tripatch {

/// What of a fill is looked at.
struct FillFaces {
  PointsRef added;             ///< vertices beyond those of the mesh
  FacesRef faces;              ///< v >= the mesh's number of vertices is row v - that number of `added`
  std::span<const Index> rim;  ///< its boundary, islands included
};

/// For each of some fills a place where it passes through another one, or through a face of the mesh, that has no vertex of its
/// boundary; none: nowhere. What passes by less than `touching` (crossings.h) does not count. One pass over the mesh, against a
/// tree of all fills' triangles.
///
/// subdivision: if the mesh is a cage: its limit surface is looked at, in so many squares a face as its level gives.
std::vector<std::optional<Vec3>> passages(const Mesh& mesh, std::span<const FillFaces> fills,
                                          const std::optional<Subdivision>& subdivision);

/// The same of fills that are faces of the mesh, or of the cage.
///
/// fill_of_face: by face the number of its fill, from 0 on; -1: the face is of none.
std::vector<std::optional<Vec3>> passages(const Mesh& mesh, std::span<const Index> fill_of_face,
                                          const std::optional<Subdivision>& subdivision);

}  // namespace tripatch
