#include "tripatch/math/linear.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <limits>

namespace tripatch {

Eigen::MatrixXd least_squares(const MatrixRef& a, const MatrixRef& b) { return a.completeOrthogonalDecomposition().solve(b); }

MinimumNormSolution minimum_norm_least_squares(const MatrixRef& a, const MatrixRef& b, double threshold) {
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition;
  decomposition.setThreshold(threshold);
  decomposition.compute(a);
  return {decomposition.solve(b), decomposition.rank()};
}

Eigen::VectorXd constrained_quadratic_minimum(Eigen::MatrixXd a, const VectorRef& b, const MatrixRef& held) {
  if (!factor_cholesky(a)) return Eigen::VectorXd::Constant(b.size(), std::numeric_limits<double>::quiet_NaN());
  const auto solve = [&](auto& right) {
    a.triangularView<Eigen::Lower>().solveInPlace(right);
    a.triangularView<Eigen::Lower>().transpose().solveInPlace(right);
  };
  Eigen::VectorXd x = -b;
  solve(x);
  if (held.rows() == 0) return x;
  Eigen::MatrixXd across = held.transpose();
  solve(across);
  const Eigen::LLT<Eigen::MatrixXd> small(held * across);
  for (int pass = 0; pass < 2; ++pass) x -= across * small.solve(held * x);  // twice, for the last digits
  return x;
}

Eigen::MatrixXd solve_symmetric(const MatrixRef& a, const MatrixRef& b) { return a.ldlt().solve(b); }

Eigen::MatrixXd solve_upper_triangular(const MatrixRef& r, const MatrixRef& b) {
  return r.triangularView<Eigen::Upper>().solve(b);
}

Eigen::MatrixXd orthonormalization(const MatrixRef& a) {
  const Eigen::MatrixXd r = Eigen::HouseholderQR<Eigen::MatrixXd>(a).matrixQR().topRows(a.cols());
  return solve_upper_triangular(r, Eigen::MatrixXd::Identity(a.cols(), a.cols()));
}

Eigen::MatrixXd submatrix(const MatrixRef& a, const std::vector<Index>& rows, const std::vector<Index>& columns) {
  Eigen::MatrixXd out(rows.size(), columns.size());
  for (std::size_t c = 0; c < columns.size(); ++c)
    for (std::size_t r = 0; r < rows.size(); ++r) out(r, c) = a(rows[r], columns[c]);
  return out;
}

Eigen::Vector2d in_frame(const Vec3& a, const Vec3& b, const Vec3& v) {
  Eigen::MatrixXd frame(3, 2);
  frame << a, b;
  return least_squares(frame, v);
}

}  // namespace tripatch
