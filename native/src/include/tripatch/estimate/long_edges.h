// What long edges tell of a surface: whoever makes a mesh makes edges long where the surface is straight along them.
#pragma once

#include <array>
#include <vector>

#include "tripatch/math/thresholds.h"
#include "tripatch/types.h"

namespace tripatch {

/// A face is a needle if the square of its longest edge is over so many times twice its area. Two triangles in one plane are a face that was
/// cut only if both are needles: the flat bottom of a scanned figure is cut at random, and with its edges a hole next to was 1.3 times
/// farther off. How a needle is turned says little: its vertices on a smooth surface are nearly in line.
inline constexpr double needle_length = factor::strong;

/// A point between two vertices.
struct OnEdge {
  std::array<Index, 2> ends;
  double share;  ///< of the way from the first to the second
};

/// Points spread along the long edges of faces, by row of points (n x 3), if they can be told to lie on the surface as the
/// vertices do. These are edges of faces with four corners or more, edges cut from flat ones, and lines across faces with five or
/// more.
std::vector<OnEdge> points_on_long_edges(const Points& points, const Faces& faces);

}  // namespace tripatch
