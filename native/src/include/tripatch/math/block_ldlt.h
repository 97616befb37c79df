// L D L' of sparse symmetric matrices of 2 x 2 blocks: a quarter of the indices, and products of two numbers at a time.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace tripatch {

/// The matrix and its factors, in the order of elimination that its rows are in. The pattern is made once.
class BlockLdlt {
public:
  BlockLdlt() = default;
  /// before[k]: the columns before k in which row k has a block, increasing.
  explicit BlockLdlt(const std::vector<std::vector<int>>& before);

  int rows() const { return static_cast<int>(own_.size() / 4); }
  /// Number of the block in row k and column c < k, which it has.
  int place(int k, int c) const;

  /// All blocks are zero, to be added to by the two that follow: columns of 2 x 2.
  void clear();
  double* diagonal(int k) { return own_.data() + 4 * k; }
  double* block(int place) { return beside_.data() + 4 * place; }

  /// False where a pivot has no inverse.
  bool factorize();
  /// Of what was factorized.
  bool is_definite() const;
  Eigen::VectorXd solve(Eigen::VectorXd x) const;

private:
  std::vector<int> row_start_, columns_;  // of the blocks next to the diagonal, by row
  std::vector<double> own_, beside_;      // diagonal blocks, and those
  std::vector<int> start_, rows_;         // of the factor, by column
  std::vector<int> fill_start_, fill_;    // its columns by row, each before those that it changes
  std::vector<double> factor_, inverse_;  // its blocks, and those of D inverted
};

}  // namespace tripatch
