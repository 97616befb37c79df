// The points of a triangle at barycentric coordinates that are multiples of 1 / rows, and where each stands among them.
#pragma once

#include "tripatch/types.h"

namespace tripatch {

/// Points (rows - p - q, p, q) / rows, p, q >= 0, p + q <= rows: row q after row, p from 0 on in each.
struct TriangularGrid {
  Index rows;

  Index size() const { return (rows + 1) * (rows + 2) / 2; }
  Index at(Index p, Index q) const { return q * (rows + 1) - q * (q - 1) / 2 + p; }
  /// Barycentric coordinates, size() x 3.
  Points barycentric() const {
    Points b(size(), 3);
    for (Index q = 0; q <= rows; ++q)
      for (Index p = 0; p + q <= rows; ++p) b.row(at(p, q)) << rows - p - q, p, q;
    return b / rows;
  }
  /// f(a, b) for each edge between neighboring points.
  template <class F>
  void for_edges(const F& f) const {
    for (Index q = 0; q < rows; ++q)
      for (Index p = 0; p + q < rows; ++p) {
        f(at(p, q), at(p + 1, q));
        f(at(p, q), at(p, q + 1));
        f(at(p + 1, q), at(p, q + 1));
      }
  }
};

}  // namespace tripatch
