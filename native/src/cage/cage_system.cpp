#include "tripatch/cage/cage_system.h"

#include <algorithm>

#include "tripatch/math/interruption.h"
#include "tripatch/math/tolerances.h"

namespace tripatch {
Points Sums::at(const Points& free) const { return rest + weights * Points(free(slots, Eigen::all)); }

CageSystem::CageSystem(const Points& vertices, std::vector<Index> free)
    : vertices_(vertices), free_(std::move(free)), slot_(vertices.rows(), -1), rows_(free_.size()) {
  for (std::size_t k = 0; k < free_.size(); ++k) slot_[free_[k]] = static_cast<int>(k);
}

Sums CageSystem::sums(const std::vector<Index>& vertices, const Weights& weights) const {
  return sums(vertices, weights, vertices_);
}

Sums CageSystem::sums(const std::vector<Index>& vertices, const Weights& weights, const Points& places) const {
  Sums result;
  std::vector<Index> columns;
  result.rest = Points::Zero(weights.rows(), 3);
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    const Index column = static_cast<Index>(k);
    if (slot_[vertices[k]] < 0) {
      result.rest += weights.col(column) * places.row(vertices[k]);
    } else {
      result.slots.push_back(slot_[vertices[k]]);
      columns.push_back(column);
    }
  }
  result.weights = weights(Eigen::all, columns);
  return result;
}

void CageSystem::prepare(const std::vector<const Sums*>& together) {
  for (std::size_t k = 0; k < rows_.size(); ++k) rows_[k] = {static_cast<int>(k)};
  for (const Sums* sums : together) {
    check_interruption();
    for (int a : sums->slots) rows_[a].insert(rows_[a].end(), sums->slots.begin(), sums->slots.end());
  }
  const Index n = 3 * static_cast<Index>(free_.size());
  Eigen::VectorXi sizes(n);
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    std::sort(rows_[k].begin(), rows_[k].end());
    rows_[k].erase(std::unique(rows_[k].begin(), rows_[k].end()), rows_[k].end());
    sizes.segment<3>(3 * static_cast<Index>(k)).setConstant(3 * static_cast<int>(rows_[k].size()));
  }
  pattern_.resize(n, n);
  if (n == 0) return solver_.analyzePattern(pattern_);  // of a matrix without columns Eigen would compress a second one
  pattern_.reserve(sizes);
  for (Index column = 0; column < n; ++column) {
    check_interruption();
    for (int k : rows_[column / 3])
      for (int x = 0; x < 3; ++x) pattern_.insert(3 * k + x, column) = 0;
  }
  pattern_.makeCompressed();
  solver_.analyzePattern(pattern_);
}

CageSystem::Term CageSystem::zero() const { return {pattern_, Eigen::VectorXd::Zero(pattern_.cols())}; }

void CageSystem::add(Term& to, double weight, const Term& from) {
  to.h.coeffs() += weight * from.h.coeffs();
  to.g += weight * from.g;
  to.c += weight * from.c;
}

/// The first of the nine values, three columns apart by 3 * rows_[column].size().
double* CageSystem::block(Term& term, int row, int column) const {
  const std::vector<int>& rows = rows_[column];
  const auto place = std::lower_bound(rows.begin(), rows.end(), row) - rows.begin();
  return term.h.valuePtr() + term.h.outerIndexPtr()[3 * column] + 3 * place;
}

void CageSystem::add(Term& term, const Sums& sums, Index row, const Eigen::Matrix3d& metric, const Vec3& residual) const {
  const Vec3 force = metric * residual;
  term.c += residual.dot(force);
  for (std::size_t b = 0; b < sums.slots.size(); ++b) {
    const int column = sums.slots[b];
    const double w = sums.weights(row, static_cast<Index>(b));
    if (w == 0) continue;
    term.g.segment<3>(3 * column) += w * force;
    const Eigen::Matrix3d part = w * metric;
    const std::size_t stride = 3 * rows_[column].size();
    for (std::size_t a = 0; a < sums.slots.size(); ++a) {
      const double v = sums.weights(row, static_cast<Index>(a));
      if (v == 0) continue;
      double* values = block(term, sums.slots[a], column);
      for (int x = 0; x < 3; ++x) Eigen::Map<Vec3>(values + x * stride) += v * part.col(x);
    }
  }
}

void CageSystem::add(Term& term, const std::vector<int>& slots, const Weights& jacobian, const Eigen::VectorXd& value) const {
  const Eigen::MatrixXd normal = jacobian.transpose() * jacobian;
  const Eigen::VectorXd gradient = jacobian.transpose() * value;
  term.c += value.squaredNorm();
  for (std::size_t b = 0; b < slots.size(); ++b) {
    term.g.segment<3>(3 * slots[b]) += gradient.segment<3>(3 * static_cast<Index>(b));
    const std::size_t stride = 3 * rows_[slots[b]].size();
    for (std::size_t a = 0; a < slots.size(); ++a) {
      double* values = block(term, slots[a], slots[b]);
      for (int x = 0; x < 3; ++x)
        Eigen::Map<Vec3>(values + x * stride) += normal.col(3 * static_cast<Index>(b) + x).segment<3>(3 * static_cast<Index>(a));
    }
  }
}

Eigen::VectorXd CageSystem::step(const Term& term, const Eigen::VectorXd& y, double damping) {
  check_interruption();
  Eigen::SparseMatrix<double> h = term.h;
  const double least = tolerance::fit * h.diagonal().sum() / static_cast<double>(h.cols());
  for (Index v = 0; v < h.cols(); v += 3) {  // alike along all axes: how the mesh is turned changes nothing
    const double mean = (h.coeff(v, v) + h.coeff(v + 1, v + 1) + h.coeff(v + 2, v + 2)) / 3;
    for (Index k = v; k < v + 3; ++k) h.coeffRef(k, k) += damping * mean + least;
  }
  solver_.factorize(h);
  return -solver_.solve(term.h * y + term.g);
}

}  // namespace tripatch
