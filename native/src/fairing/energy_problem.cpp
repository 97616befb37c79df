#include "tripatch/fairing/energy_problem.h"

#include <cmath>
#include <memory>

#include "tripatch/fairing/curvature_variation.h"
#include "tripatch/math/linear.h"
#include "tripatch/math/parallel.h"
#include "tripatch/math/thresholds.h"

namespace tripatch {

void NodeDerivatives::add(const std::vector<Jet<3>>& functions) {
  if (filled_ == 0) all_.resize(9 * nodes_, static_cast<Index>(functions.size()));
  for (std::size_t c = 0; c < functions.size(); ++c)
    all_.block<9, 1>(9 * filled_, static_cast<Index>(c)) = derivatives_of(functions[c]);
  ++filled_;
}

Eigen::MatrixXd orthonormal_functions(const std::vector<double>& weights, const NodeDerivatives& functions) {
  Eigen::MatrixXd rows(4 * functions.nodes(), functions.functions());
  for (Index k = 0; k < functions.nodes(); ++k)
    for (int d = 0; d <= 3; ++d)
      rows.row(4 * k + d) = std::sqrt(weights[k]) * NodeBasis::factor(3, d) * functions.at(k).row(NodeBasis::first_of(3) + d);
  return orthonormalization(rows);
}

NodeBasis::NodeBasis(std::vector<double> weights_of_nodes, const NodeDerivatives& plain, Eigen::MatrixXd combined)
    : weights(std::move(weights_of_nodes)), combination(std::move(combined)) {
  const Index n = plain.nodes(), count = combination.cols();
  interior.resize(9 * n, count);
  for (int m = 1; m <= 3; ++m) rows[m].resize((m + 1) * n, count);
  for (Index k = 0; k < n; ++k) {
    interior.middleRows(9 * k, 9) = plain.at(k) * combination;
    for (int m = 1; m <= 3; ++m)
      for (int d = 0; d <= m; ++d)
        rows[m].row((m + 1) * k + d) = std::sqrt(weights[k]) * factor(m, d) * interior.row(9 * k + first_of(m) + d);
  }
  for (int m = 1; m <= 3; ++m) normal[m] = rows[m].transpose() * rows[m];
}

Eigen::VectorXd EnergyProblem::raised(const EnergyProblem& lower, const Eigen::VectorXd& x) const {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(count());
  for (int c = 0; c < 3; ++c) out.segment(c * interior_, lower.interior_) = x.segment(c * lower.interior_, lower.interior_);
  out.tail(fields_) = x.tail(fields_);
  return out;
}

std::vector<Derivatives> EnergyProblem::derivatives(const Eigen::VectorXd& x) const {
  std::vector<Derivatives> d = base_;
  if (x.isZero(0)) return d;
  const Index n = static_cast<Index>(d.size());
  const Eigen::VectorXd scalars = size_ * x.head(3 * interior_);
  add_product(nodes_.interior.data(), 9 * n, interior_, scalars.data(), d[0].data());
  add_product(basis_, x.tail(fields_), d[0].data());
  return d;
}

namespace {

/// What the Gram matrix of (A, r) says of |A x + r|^2, its lower triangle given.
Quadratic of_gram(const RowMajor& gram) {
  const Index n = gram.rows() - 1;
  return {symmetric_of_lower(gram, n), gram.row(n).head(n), gram(n, n)};
}

}  // namespace

Quadratic EnergyProblem::quadratic(int order) const {
  const int rows = order + 1, first = NodeBasis::first_of(order);
  const Index n = static_cast<Index>(base_.size());
  Quadratic q;
  q.normal.setZero(count(), count());
  q.gradient.setZero(count());
  RowMajor all(rows * n, interior_ + fields_ + 1);  // of one component, at the end its value
  all.leftCols(interior_) = nodes_.rows[order];
  for (int c = 0; c < 3; ++c) {
    for (Index k = 0; k < n; ++k) {
      const double w = std::sqrt(nodes_.weights[k]) / size_;
      for (int d = 0; d < rows; ++d) {
        const double f = w * NodeBasis::factor(order, d);
        all.row(rows * k + d).segment(interior_, fields_) = f * basis_.row(27 * k + 3 * (first + d) + c);
        all(rows * k + d, interior_ + fields_) = f * base_[k](first + d, c);
      }
    }
    RowMajor gram = RowMajor::Zero(all.cols(), all.cols());
    add_gram(all, gram);
    const Quadratic part = of_gram(gram);
    const Index at = c * interior_;
    q.normal.block(at, at, interior_, interior_) = part.normal.topLeftCorner(interior_, interior_);
    q.normal.block(at, scalars(), interior_, fields_) = part.normal.topRightCorner(interior_, fields_);
    q.normal.bottomRightCorner(fields_, fields_) += part.normal.bottomRightCorner(fields_, fields_);
    q.gradient.segment(at, interior_) = part.gradient.head(interior_);
    q.gradient.tail(fields_) += part.gradient.tail(fields_);
    q.constant += part.constant;
  }
  q.normal.bottomLeftCorner(fields_, scalars()) = q.normal.topRightCorner(scalars(), fields_).transpose();
  return q;
}

std::pair<double, double> EnergyProblem::variation(const std::vector<Derivatives>& d) const {
  double variation = 0, quadric = 0;
  const auto all = std::make_unique_for_overwrite<CurvatureVariation[]>(d.size());
  curvature_variations(d, flat_curvature(size_), all.get());
  for (std::size_t k = 0; k < d.size(); ++k) {
    const CurvatureVariation& v = all[k];
    const double w = nodes_.weights[k] * size_ * size_ * v.area;
    variation += w * v.variation.squaredNorm();
    quadric += w * v.quadric.squaredNorm();
  }
  return {variation, quadric};
}

std::array<Quadratic, 2> EnergyProblem::linearized(const std::vector<Derivatives>& d, const std::array<bool, 2>& wanted) const {
  // in blocks of nodes, always the same, so that sums do not depend on the number of cores
  constexpr Index block = count::hundred;
  const Index n = static_cast<Index>(base_.size()), blocks = (n + block - 1) / block;
  std::vector<std::array<RowMajor, 2>> parts(blocks);
  parallel_for(0, blocks, 1, [&](Index from, Index to) {
    for (Index at = from; at < to; ++at) parts[at] = grams(d, wanted, at * block, std::min(n, (at + 1) * block));
  });
  std::array<Quadratic, 2> model;
  for (int which = 0; which < 2; ++which) {
    if (!wanted[which]) continue;
    for (Index at = 1; at < blocks; ++at) parts[0][which] += parts[at][which];
    model[which] = of_gram(parts[0][which]);
  }
  return model;
}

/// Of some of the nodes the Gram matrices of their rows and values.
std::array<RowMajor, 2> EnergyProblem::grams(const std::vector<Derivatives>& all, const std::array<bool, 2>& wanted, Index from,
                                             Index to) const {
  constexpr Index block = count::dozen;    // nodes: their rows stay in the cache
  std::array<RowMajor, 2> jacobian, gram;  // with the values as last column
  const auto nodes = std::make_unique_for_overwrite<CurvatureVariationRows[]>(block);
  const Index columns = count() + 1;
  for (int which = 0; which < 2; ++which)
    if (wanted[which]) gram[which].setZero(columns, columns);
  for (Index start = from; start < to; start += block) {
    const Index n = std::min(block, to - start);
    for (int which = 0; which < 2; ++which)
      if (wanted[which]) jacobian[which].resize(4 * n, columns);
    curvature_variation_rows({&all[start], static_cast<std::size_t>(n)}, flat_curvature(size_), nodes.get());
    for (Index k = start; k < start + n; ++k) {
      const CurvatureVariationRows& v = nodes[k - start];
      const double w = std::sqrt(nodes_.weights[k]) * size_;
      const Index row = 4 * (k - start);
      for (int which = 0; which < 2; ++which) {
        if (!wanted[which]) continue;
        const Eigen::Matrix<double, 4, 27, Eigen::RowMajor> rows = w * v.derivative.middleRows<4>(4 * which);
        double* const out = jacobian[which].row(row).data();
        for (int c = 0; c < 3; ++c) {
          Eigen::Matrix<double, 4, 9, Eigen::RowMajor> part;
          for (int d = 0; d < 9; ++d) part.col(d) = size_ * rows.col(3 * d + c);
          multiply_four(part.data(), 9, nodes_.interior.row(9 * k).data(), interior_, out + c * interior_, columns);
        }
        multiply_four(rows.data(), 27, basis_.row(27 * k).data(), fields_, out + scalars(), columns);
        jacobian[which].col(count()).segment<4>(row) = w * v.value.segment<4>(4 * which);
      }
    }
    for (int which = 0; which < 2; ++which)
      if (wanted[which]) add_gram(jacobian[which], gram[which]);
  }
  return gram;
}

}  // namespace tripatch
