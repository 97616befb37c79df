#include "tripatch/quads/weighted_means.h"

#include <Eigen/Sparse>
#include <algorithm>

#include "tripatch/math/sparse_ldlt.h"

namespace tripatch {

void to_weighted_means(const std::vector<NetEdge>& edges, const std::vector<bool>& fixed, RowsRef rows) {
  std::vector<Index> unknown(fixed.size(), -1), moving;
  for (std::size_t v = 0; v < fixed.size(); ++v) {
    if (fixed[v]) continue;
    unknown[v] = static_cast<Index>(moving.size());
    moving.push_back(static_cast<Index>(v));
  }
  const Index count = static_cast<Index>(moving.size());
  if (count == 0) return;
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(4 * edges.size());
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(count, rows.cols());
  const auto add = [&](Index a, Index b, double weight, double ahead) {
    const Index own = unknown[a], other = unknown[b];
    if (own < 0) return;
    entries.emplace_back(own, own, weight);
    right(own, 0) += weight * ahead;
    if (other < 0)
      right.row(own) += weight * rows.row(b);
    else
      entries.emplace_back(own, other, -weight);
  };
  for (const NetEdge& edge : edges) {
    add(edge.a, edge.b, edge.weight, edge.ahead);
    add(edge.b, edge.a, edge.weight, -edge.ahead);
  }
  Eigen::SparseMatrix<double> laplacian(count, count);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  SparseLdlt solver;
  solver.analyzePattern(laplacian);
  solver.factorize(laplacian);
  const Eigen::MatrixXd solution = solver.solve(right);
  rows(moving, Eigen::all) = solution;
}

std::vector<bool> first_rows(Index first, Index rows) {
  std::vector<bool> fixed(static_cast<std::size_t>(rows), false);
  std::fill_n(fixed.begin(), first, true);
  return fixed;
}

}  // namespace tripatch
