// Normals of the faces and at the vertices of a mesh.
#pragma once

#include "tripatch/types.h"

namespace tripatch {

/// Twice the vector area of a face, of any number of corners.
Vec3 area_vector(const Mesh& mesh, Index face);

/// Unit normals at all vertices: the mean of the normals of the faces around, weighted by their angles there (Thurmer and Wuthrich,
/// Computing vertex normals from polygonal facets, 1998). Zero where there is no face or the normals cancel.
/// corner_normals (corners x 3, or none): taken instead of the face's own at corners where they are not zero. Throws InvalidArgument
/// for an index that is no vertex.
Points vertex_normals(const Mesh& mesh, const PointsRef& corner_normals = Points(0, 3));

}  // namespace tripatch
