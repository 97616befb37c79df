// A first triangulation of a hole with any rim, without new vertices: where a fill over a plane domain begins, and the last resort.
#pragma once

#include <array>
#include <vector>

#include "tripatch/mesh/triangles.h"

namespace tripatch {

/// What is known of a rim besides its points. All of it may be left out.
struct RimSurroundings {
  std::vector<Index> islands;  ///< the row at which each further loop starts; the first starts at 0
  Points normals;              ///< r x 3 or empty: outer unit normal of the face beyond rim edge k; zero where there is none
  std::vector<std::array<Index, 2>>
      joined;  ///< pairs of rim vertices that the mesh joins by an edge; rim edges may be among them
};

struct RoughFill {
  Triangles triangles;  ///< rows of the points; they traverse the rim forwards; r - 2 + 2 per island
  /// Where the triangles with the least worst angle cross themselves: those.
  Triangles crossing;
  bool doubles_edges = false;  ///< an edge of the fill is one that the mesh has already: there was no way around it
};

/// Triangulates loops of points (r x 3), each in the direction in which the new faces traverse it. Every inner edge joins two rim
/// vertices, if possible none that are `joined`. Of up to 200 vertices the triangulation with the least worst angle between
/// neighboring triangles, and between them and the faces beyond the rim. Among equally good ones it is the smallest (Barequet and
/// Sharir 1995, "Filling gaps in the boundary of a polyhedron"; Liepa 2003, "Filling holes in meshes"). Of more the same by
/// parts. Where that crosses itself, the next that does not is sought without the chords that do, then without the triangles that
/// the rim goes through, at last that of the least area. Islands, and the other rim of a strip, are joined to the first loop by
/// the shortest bridges. The same input gives the same bits. Throws InvalidArgument for loops of fewer than 3 vertices and rows
/// that do not fit.
RoughFill min_weight_triangulation(const PointsRef& points, const RimSurroundings& rim = {});

}  // namespace tripatch
