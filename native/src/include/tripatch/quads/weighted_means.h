// Points of a net that are the weighted means of those that they are joined to (Tutte 1963).
#pragma once

#include <vector>

#include "tripatch/types.h"

namespace tripatch {

struct NetEdge {
  Index a = 0, b = 0;
  double weight = 1;
  /// What the first coordinate of a exceeds that of b by where nothing pulls.
  double ahead = 0;
};

using RowsRef = Eigen::Ref<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;
/// Moves the rows that are not fixed to the weighted means of those that the edges join them to.
void to_weighted_means(const std::vector<NetEdge>& edges, const std::vector<bool>& fixed, RowsRef rows);

/// Of so many rows the first ones.
std::vector<bool> first_rows(Index first, Index rows);

}  // namespace tripatch
