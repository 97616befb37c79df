// Widths of rows of quads.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "tripatch/types.h"

namespace tripatch {

/// Of each edge the width of the row of quads that it lies across: the mean of the logarithms of the row's ends on the rim.
class RowWidths {
public:
  RowWidths(const Faces& faces, Index rim);

  /// Reads the positions. round: of rows that go round and have no ends; none: the mean length of their edges.
  void measure(const Points& positions, std::optional<double> round = {});

  const std::vector<std::array<Index, 2>>& edges() const { return edges_; }
  double width(Index edge) const { return width_[row_[edge]]; }
  /// Of the edge that begins at a corner of the faces.
  double beginning_at(Index corner) const { return width(edge_[corner]); }

private:
  Index rim_;
  std::vector<std::array<Index, 2>> edges_;
  std::vector<Index> edge_, row_;
  std::vector<double> width_;
};

}  // namespace tripatch
