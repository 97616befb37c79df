// The equations of Tutte's embedding of a disc, its border on a circle.
#pragma once

#include <Eigen/SparseCholesky>
#include <cmath>
#include <vector>

#include "tripatch/math/plane.h"
#include "tripatch/parametrization/layout_mesh.h"

namespace tripatch {

/// Its weights may change.
class TutteSystem {
public:
  /// angle: of the border's vertices; rank: of all vertices in the order of elimination.
  TutteSystem(const LayoutMesh& disc, const std::vector<double>& angle, const std::vector<int>& rank)
      : disc_(disc), border_(PlanePoints::Zero(disc.count, 2)), row_(disc.count, -1) {
    std::vector<char> held(disc.count, 0);
    const double radius = 1 / std::sqrt(EIGEN_PI);
    for (std::size_t k = 0; k < disc.border.size(); ++k) {
      border_.row(disc.border[k]) << radius * std::cos(angle[k]), radius * std::sin(angle[k]);
      held[disc.border[k]] = 1;
    }
    std::vector<int> inside(disc.count);  // in the order of elimination
    for (int v = 0; v < disc.count; ++v) inside[rank[v]] = v;
    for (int v : inside)
      if (!held[v]) row_[v] = count_++;
    if (count_ == 0) return;
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(static_cast<std::size_t>(count_) + 3 * disc.triangles.size());
    for (int row = 0; row < count_; ++row) entries.emplace_back(row, row, 0);
    for (const LayoutMesh::Triangle& t : disc.triangles)  // of two next to an edge each takes it in its own direction
      for (int k = 0; k < 3; ++k)
        if (const int p = t[k], q = t[(k + 1) % 3]; is_below(p, q)) entries.emplace_back(row_[p], row_[q], 0);
    laplacian_.resize(count_, count_);
    laplacian_.setFromTriplets(entries.begin(), entries.end());
    for_each_pair([&](int p, int q, std::size_t, int) {
      own_.push_back(laplacian_.outerIndexPtr()[row_[p]]);
      between_.push_back(is_below(p, q) ? static_cast<int>(&laplacian_.coeffRef(row_[p], row_[q]) - laplacian_.valuePtr()) : -1);
    });
    solver_.analyzePattern(laplacian_);
  }

  /// weight: of edge k of triangle t.
  template <class Weight>
  PlanePoints solved(const Weight& weight) {
    PlanePoints uv = border_;
    if (count_ == 0) return uv;
    std::fill_n(laplacian_.valuePtr(), laplacian_.nonZeros(), 0.0);
    PlanePoints right = PlanePoints::Zero(count_, 2);
    std::size_t pair = 0;
    for_each_pair([&](int p, int q, std::size_t t, int k) {
      const double w = weight(t, k);
      laplacian_.valuePtr()[own_[pair]] += w;
      if (row_[q] < 0) right.row(row_[p]) += w * uv.row(q);
      if (between_[pair] >= 0) laplacian_.valuePtr()[between_[pair]] -= w;
      ++pair;
    });
    solver_.factorize(laplacian_);
    const Eigen::MatrixXd solution = solver_.solve(right);
    for (int v = 0; v < disc_.count; ++v)
      if (row_[v] >= 0) uv.row(v) = solution.row(row_[v]);
    return uv;
  }

private:
  /// Whether the entry of two vertices stands below the diagonal.
  bool is_below(int row, int column) const { return row_[column] >= 0 && row_[row] > row_[column]; }

  /// Both ways along the triangles' edges, but for those from the border.
  template <class Use>
  void for_each_pair(const Use& use) const {
    for (std::size_t t = 0; t < disc_.triangles.size(); ++t)
      for (int k = 0; k < 3; ++k) {
        const int a = disc_.triangles[t][k], b = disc_.triangles[t][(k + 1) % 3];
        if (row_[a] >= 0) use(a, b, t, k);
        if (row_[b] >= 0) use(b, a, t, k);
      }
  }

  const LayoutMesh& disc_;
  PlanePoints border_;
  std::vector<int> row_;  // of each vertex; -1: on the border
  int count_ = 0;
  Eigen::SparseMatrix<double> laplacian_;
  std::vector<int> own_, between_;  // of each pair: where its weight stands; -1: above the diagonal, or known
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::NaturalOrdering<int>> solver_;
};

}  // namespace tripatch
