// The rim of a surface, which goes through none of the surface's own triangles.
#pragma once

#include <array>
#include <vector>

#include "tripatch/mesh/triangles.h"

namespace tripatch {

/// A closed line of edges between points.
class ClosedLine {
public:
  /// vertices: rows of the points, some of which may occur twice.
  ClosedLine(Points points, std::vector<Index> vertices);

  /// Whether an edge goes through a triangle of the points that has neither of its ends, by more than `touching` (crossings.h).
  bool goes_through(const std::array<Index, 3>& triangle) const;

private:
  Points points_;
  std::vector<Index> vertices_;  // the first again at the end
  Points along_;                 // their points
  std::vector<double> lengths_;  // of the edges
};

}  // namespace tripatch
