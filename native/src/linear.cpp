#include "tripatch/linear.h"

#include <Eigen/QR>

namespace tripatch {

Eigen::MatrixXd least_squares(const MatrixRef& a, const MatrixRef& b) { return a.completeOrthogonalDecomposition().solve(b); }

ShortestSolution shortest_solution(const MatrixRef& a, const MatrixRef& b, double threshold) {
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition;
  decomposition.setThreshold(threshold);
  decomposition.compute(a);
  return {decomposition.solve(b), decomposition.rank()};
}

Eigen::Vector2d in_frame(const Vec3& a, const Vec3& b, const Vec3& v) {
  Eigen::MatrixXd frame(3, 2);
  frame << a, b;
  return least_squares(frame, v);
}

}  // namespace tripatch
