#include "tripatch/math/height_models.h"

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace tripatch {
namespace {

QuadricTerms terms_at(const Vec2& p) {
  QuadricTerms row;
  row << 1, p[0], p[1], p[0] * p[0], p[0] * p[1], p[1] * p[1];
  return row;
}

Vec3 quadric_at(const QuadricTerms& c, const Vec2& p) {
  return {c.dot(terms_at(p)), c[1] + 2 * c[3] * p[0] + c[4] * p[1], c[2] + c[4] * p[0] + 2 * c[5] * p[1]};
}

}  // namespace

HeightQuadric::HeightQuadric(const std::vector<Vec3>& samples, std::size_t rim) {
  using Square = Eigen::Matrix<double, quadric_terms, quadric_terms>;
  Square normal = Square::Zero();
  QuadricTerms right = QuadricTerms::Zero();
  for (const Vec3& p : samples) {
    const QuadricTerms terms = terms_at(p.head<2>());
    normal += terms * terms.transpose();
    right += p[2] * terms;
  }
  const Eigen::LDLT<Square> solver(normal);
  fit_ = solver.solve(right);
  for (std::size_t k = 0; k < rim; ++k) {
    const QuadricTerms terms = terms_at(samples[k].head<2>());
    const double missed = (samples[k][2] - fit_.dot(terms)) / (1 - terms.dot(solver.solve(terms)));
    error_ += missed * missed / static_cast<double>(rim);
  }
  error_ = std::sqrt(error_);
}

Vec3 HeightQuadric::at(const Vec2& place) const { return quadric_at(fit_, place); }

namespace {

constexpr int max_rows = static_cast<int>(max_height_samples);
using SampleColumn = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, max_rows, 1>;
using TermRows = Eigen::Matrix<double, Eigen::Dynamic, quadric_terms, 0, max_rows, quadric_terms>;
using SampleSquare = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, max_rows, max_rows>;

double cube_of_distance(const Vec3& a, const Vec3& b) {
  const double square = (a - b).head<2>().squaredNorm();
  return square * std::sqrt(square);
}

/// Gaussian elimination of the terms at samples: their rows in `order` are lower * upper, the first six rows being the pivots.
struct Carriers {
  std::array<std::size_t, max_height_samples> order;
  TermRows factors;  ///< below the diagonal the lower factor, else the upper one

  explicit Carriers(const std::vector<Vec3>& samples) : factors(static_cast<Index>(samples.size()), quadric_terms) {
    std::iota(order.begin(), order.end(), std::size_t{0});
    for (Index k = 0; k < factors.rows(); ++k)
      factors.row(k) = terms_at(samples[static_cast<std::size_t>(k)].head<2>()).transpose();
    for (int c = 0; c < quadric_terms; ++c) {
      Index pivot = 0;
      factors.col(c).tail(factors.rows() - c).cwiseAbs().maxCoeff(&pivot);
      factors.row(c).swap(factors.row(c + pivot));
      std::swap(order[static_cast<std::size_t>(c)], order[static_cast<std::size_t>(c + pivot)]);
      const Index below = factors.rows() - c - 1;
      factors.col(c).tail(below) /= factors(c, c);
      for (int d = c + 1; d < quadric_terms; ++d) factors.col(d).tail(below) -= factors(c, d) * factors.col(c).tail(below);
    }
  }
  auto lower() const { return factors.topRows<quadric_terms>().triangularView<Eigen::UnitLower>(); }
  auto upper() const { return factors.topRows<quadric_terms>().triangularView<Eigen::Upper>(); }
  /// The polynomials at the other samples by those at the pivots.
  TermRows shares() const {
    TermRows rows = factors.bottomRows(factors.rows() - quadric_terms);
    lower().solveInPlace<Eigen::OnTheRight>(rows);
    return rows;
  }
};

}  // namespace

/// The weights, which no polynomial sees, are those of all samples but the pivots: their matrix is positive definite (Wendland 2005,
/// "Scattered Data Approximation", 8.3). The error by Rippa 1999, "An algorithm for selecting a good value for the parameter c in
/// radial basis function interpolation".
HeightSpline::HeightSpline(const std::vector<Vec3>& samples, std::size_t rim) : samples_(samples) {
  const Carriers carriers(samples);
  const auto at = [&](Index k) -> const Vec3& { return samples[carriers.order[static_cast<std::size_t>(k)]]; };
  const auto n = static_cast<Index>(samples.size()), m = n - quadric_terms;
  const TermRows shares = carriers.shares();
  TermRows to_pivots(n, quadric_terms);  // kernels
  for (Index k = 0; k < n; ++k)
    for (int c = 0; c < quadric_terms; ++c) to_pivots(k, c) = cube_of_distance(at(k), at(c));
  const TermRows half = to_pivots.bottomRows(m) - 0.5 * shares * to_pivots.topRows<quadric_terms>();
  SampleSquare matrix(m, m);  // its lower half
  for (Index j = 0; j < m; ++j) {
    for (Index i = j; i < m; ++i) matrix(i, j) = cube_of_distance(at(quadric_terms + i), at(quadric_terms + j));
    matrix.col(j).tail(m - j) -= shares.bottomRows(m - j).lazyProduct(half.row(j).transpose());
    matrix.col(j).tail(m - j) -= half.bottomRows(m - j).lazyProduct(shares.row(j).transpose());
  }
  SampleColumn heights(n);
  for (Index k = 0; k < n; ++k) heights[k] = at(k)[2];
  const Eigen::LLT<Eigen::Ref<SampleSquare>> factor(matrix);
  error_ = std::numeric_limits<double>::infinity();
  if (factor.info() != Eigen::Success) return;

  SampleColumn weights(n);  // by place in the order
  weights.tail(m) = heights.tail(m) - shares * heights.head<quadric_terms>();
  factor.matrixL().solveInPlace(weights.tail(m));
  factor.matrixU().solveInPlace(weights.tail(m));
  weights.head<quadric_terms>() = -(shares.transpose() * weights.tail(m));
  polynomials_ = heights.head<quadric_terms>() - to_pivots.transpose() * weights;
  carriers.lower().solveInPlace(polynomials_);
  carriers.upper().solveInPlace(polynomials_);
  weights_.resize(n);
  double sum = 0;
  for (Index k = 0; k < n; ++k) {
    const std::size_t sample = carriers.order[static_cast<std::size_t>(k)];
    weights_[static_cast<Index>(sample)] = weights[k];
    if (sample >= rim) continue;
    SampleColumn unit = k < quadric_terms ? SampleColumn(shares.col(k)) : SampleColumn(SampleColumn::Unit(m, k - quadric_terms));
    factor.matrixL().solveInPlace(unit);
    const double missed = weights[k] / unit.squaredNorm();
    sum += missed * missed;
  }
  error_ = std::sqrt(sum / static_cast<double>(rim));
}

Vec3 HeightSpline::at(const Vec2& place) const {
  Vec3 out = quadric_at(polynomials_, place);
  for (Index k = 0; k < weights_.size(); ++k) {
    const Vec2 d = place - samples_[static_cast<std::size_t>(k)].head<2>();
    const double distance = d.norm();
    out[0] += weights_[k] * distance * distance * distance;
    out.tail<2>() += 3 * weights_[k] * distance * d;
  }
  return out;
}

}  // namespace tripatch
