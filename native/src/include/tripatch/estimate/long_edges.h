// What long edges tell of a surface: whoever makes a mesh makes edges long where the surface is straight along them.
#pragma once

#include <array>
#include <vector>

#include "tripatch/types.h"

namespace tripatch {

/// A point between two vertices.
struct OnEdge {
  std::array<Index, 2> ends;
  double share;  ///< of the way from the first to the second
};

/// Points spread along the long edges of faces, by row of points (n x 3), of which one can tell that they lie on the surface as the
/// vertices do: edges of faces of four corners and more, or cut from flat ones, and lines across those of five and more.
std::vector<OnEdge> points_on_long_edges(const Points& points, const Faces& faces);

}  // namespace tripatch
