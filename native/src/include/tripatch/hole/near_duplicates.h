// Borders that lie on other borders: nothing is missing there, but the faces on both sides are not joined.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "tripatch/types.h"

namespace tripatch {

/// The diagonal of the box around all finite vertices.
double size_of(const Mesh& mesh);

/// A vertex that a face gets within an edge.
struct EdgeSplit {
  Index face, corner;  ///< after this corner of the face as it was
  Index vertex;
  double t;  ///< the part of the way to the next corner
};

/// A mesh whose faces share their vertices along borders that lie on each other.
struct JoinedBorders {
  Faces faces;                    ///< of the vertices that stand for all at their places
  std::vector<Index> own;         ///< the corners of the faces before that
  std::vector<Index> stands;      ///< for each vertex the one that stands for it; empty: nothing was joined
  std::vector<EdgeSplit> splits;  ///< by face, corner and place on the edge
};
/// Joins pairs of border edges whose ends are within `distance`, and which run opposite ways, as the two faces of an edge do. Of several
/// edges the nearest two are a pair; if that is no clear choice, none is. junctions: joins also edges that lie along each other with
/// other ends (T-junctions): the faces get vertices within their edges. loops: all borders of the mesh.
JoinedBorders join_borders(const Mesh& mesh, std::span<const std::vector<Index>> loops, double distance, bool junctions);

/// How much of a border lies on borders, within near_place of the mesh's size and a hundredth of the edge's length.
struct Contact {
  std::size_t on_others = 0;       ///< edges that lie on other borders
  std::size_t on_itself = 0;       ///< edges that lie on other edges of the same border, as those of a slit
  std::array<Index, 2> edge = {};  ///< the first edge of them
};
/// Of each of some borders. loops: all borders of the mesh.
std::vector<Contact> contacts(const Mesh& mesh, std::span<const std::vector<Index>> loops);

}  // namespace tripatch
