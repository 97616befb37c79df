// Small dense systems of linear equations. Eigen's decompositions are templates that take the compiler up to ten seconds a file:
// here they are compiled once.
#pragma once

#include <vector>

#include "tripatch/math/dense_kernels.h"

namespace tripatch {

using MatrixRef = Eigen::Ref<const Eigen::MatrixXd>;

/// Minimum-norm least squares: of the x (n, k) with the least |a x - b| the shortest, for a (m, n) and b (m, k).
Eigen::MatrixXd least_squares(const MatrixRef& a, const MatrixRef& b);

/// The same and the rank of a: pivots below `threshold` times the largest count as zero.
struct MinimumNormSolution {
  Eigen::MatrixXd x;
  Index rank;
};
MinimumNormSolution minimum_norm_least_squares(const MatrixRef& a, const MatrixRef& b, double threshold);

/// Equality-constrained quadratic programme: the x (n) that makes x . (a x + 2 b) least among those with held x = 0, for a symmetric,
/// positive definite a (n, n), of which the lower triangle is read, b (n) and held (k, n), k from 0 on. Not finite where a is not
/// definite.
Eigen::VectorXd constrained_quadratic_minimum(Eigen::MatrixXd a, const VectorRef& b, const MatrixRef& held);

/// The x with a x = b, for a symmetric a (n, n), of which the lower triangle is read, and b (n, k).
Eigen::MatrixXd solve_symmetric(const MatrixRef& a, const MatrixRef& b);

/// The x with r x = b, for an upper triangular r (n, n) and b (n, k).
Eigen::MatrixXd solve_upper_triangular(const MatrixRef& r, const MatrixRef& b);

/// The inverse of r (n, n), upper triangular, where a = q r with orthonormal columns of q, for a (m, n) of full rank: those of
/// a times it are orthonormal.
Eigen::MatrixXd orthonormalization(const MatrixRef& a);

/// Rows and columns of a matrix by their numbers.
Eigen::MatrixXd submatrix(const MatrixRef& a, const std::vector<Index>& rows, const std::vector<Index>& columns);

/// The rows of b below those of a, of as many columns.
template <class M>
M stacked(const M& a, const M& b) {
  M both(a.rows() + b.rows(), a.cols());
  both << a, b;
  return both;
}

/// (x, y) such that x a + y b is nearest to v; the shortest such where a and b are parallel or zero.
Eigen::Vector2d in_frame(const Vec3& a, const Vec3& b, const Vec3& v);

}  // namespace tripatch
