// A hole that was a block in rows of quads, and the rows that continue around it.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "tripatch/math/thresholds.h"
#include "tripatch/mesh/connectivity.h"

namespace tripatch {

/// Vertices stand at (i, j), i from 0 to n and j from 0 to m in the block, whose inside is missing: the rim runs from (0, 0) to (n, 0),
/// (n, m), (0, m) and back. Beyond its sides rows are known as far as quads lie next to quads, all as long as the rows before them: a
/// rectangle of rows.
class QuadRows {
public:
  static constexpr Index max_beyond = count::few;  ///< rows of vertices beyond a side

  QuadRows(Index n, Index m) : n_(n), m_(m), vertex_(n + 1 + 2 * max_beyond, m + 1 + 2 * max_beyond) { vertex_.setConstant(-1); }

  Index n() const { return n_; }
  Index m() const { return m_; }
  /// Known rows before the first column, after the last, before the first row, after the last.
  const std::array<Index, 4>& beyond() const { return beyond_; }
  Index first(int axis) const { return -beyond_[2 * axis]; }
  Index last(int axis) const { return (axis == 0 ? n_ : m_) + beyond_[2 * axis + 1]; }
  /// -1 inside the block.
  Index at(Index i, Index j) const { return vertex_(i + max_beyond, j + max_beyond); }

private:
  friend std::optional<QuadRows> quad_rows(const Connectivity& around, const std::vector<Index>& rim);
  /// In the direction of new faces, the outermost row that is known beyond a side.
  std::vector<std::array<Index, 2>> outermost(int side) const;
  /// By a row; not where anything but quads lies there.
  void grow(const Connectivity& around, int side);

  Index n_, m_;
  std::array<Index, 4> beyond_ = {0, 0, 0, 0};
  Eigen::Matrix<Index, Eigen::Dynamic, Eigen::Dynamic> vertex_;
};

/// The vertices beyond a row of them, which faces on this side of it traverse in its direction: across one quad an edge. Empty where no
/// quads lie side by side there.
std::vector<Index> row_beyond(const Connectivity& around, const std::vector<Index>& row);

/// Of a rim in the direction of new faces: three faces meet at four of its vertices alone, its corners, opposite sides have as many
/// edges, and rows of quads lie next to one of them at least. None where that is not so.
std::optional<QuadRows> quad_rows(const Connectivity& around, const std::vector<Index>& rim);

}  // namespace tripatch
