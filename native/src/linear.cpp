#include "tripatch/linear.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <limits>

namespace tripatch {

Eigen::MatrixXd least_squares(const MatrixRef& a, const MatrixRef& b) { return a.completeOrthogonalDecomposition().solve(b); }

ShortestSolution shortest_solution(const MatrixRef& a, const MatrixRef& b, double threshold) {
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition;
  decomposition.setThreshold(threshold);
  decomposition.compute(a);
  return {decomposition.solve(b), decomposition.rank()};
}

Eigen::VectorXd least_quadratic(const MatrixRef& a, const VectorRef& b, const MatrixRef& held) {
  const Eigen::LLT<Eigen::MatrixXd> factor(a);
  if (factor.info() != Eigen::Success) return Eigen::VectorXd::Constant(b.size(), std::numeric_limits<double>::quiet_NaN());
  Eigen::VectorXd x = -factor.solve(b);
  if (held.rows() == 0) return x;
  const Eigen::MatrixXd across = factor.solve(held.transpose());
  const Eigen::LLT<Eigen::MatrixXd> small(held * across);
  for (int pass = 0; pass < 2; ++pass) x -= across * small.solve(held * x);  // twice, for the last digits
  return x;
}

Eigen::Vector2d in_frame(const Vec3& a, const Vec3& b, const Vec3& v) {
  Eigen::MatrixXd frame(3, 2);
  frame << a, b;
  return least_squares(frame, v);
}

}  // namespace tripatch
