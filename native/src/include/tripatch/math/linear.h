// Small dense systems of linear equations. Eigen's decompositions are templates that take the compiler up to ten seconds a file:
// here they are compiled once.
#pragma once

#include <array>
#include <vector>

#include "tripatch/types.h"

namespace tripatch {

using MatrixRef = Eigen::Ref<const Eigen::MatrixXd>;
using VectorRef = Eigen::Ref<const Eigen::VectorXd>;

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

/// The lower Cholesky factor of a symmetric matrix in its own lower triangle, which is read. Above stays what was there. False where the
/// matrix is not positive definite.
bool factor_cholesky(Eigen::MatrixXd& a);

/// q' a q, of which the diagonal and what lies next to it is not zero, for a symmetric a (n, n), n from 1 on, of which the lower triangle
/// is read and overwritten; b (n, k) becomes q' b. q is orthonormal.
struct Tridiagonal {
  Eigen::VectorXd diagonal, beside;
};
Tridiagonal tridiagonalize(Eigen::MatrixXd& a, Eigen::MatrixXd& b);

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

/// Small systems of up to 24 unknowns, the rest of each row being zero: three registers of eight, or six of four.
using RowsOf24 = Eigen::Matrix<double, Eigen::Dynamic, 24, Eigen::RowMajor>;
using SquareOf24 = Eigen::Matrix<double, 24, 24, Eigen::RowMajor>;
/// Adds a' a to c, of which only the lower triangle is kept up, for a (m, n) and c (n, n).
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
void add_gram(const RowMajor& a, RowMajor& c);
/// out = a b for a (4, k) and b (k, n), by rows; a row of `out` begins `stride` after the last one.
void multiply_four(const double* a, Index k, const double* b, Index n, double* out, Index stride);
/// out += a b for a (m, k), by rows, and three columns b (k, 3), by columns; out (m, 3) by rows.
void add_product(const double* a, Index m, Index k, const double* b, double* out);
/// out += a x for a (m, n), by rows.
void add_product(const RowsOf24& a, const double* x, double* out);
void add_product(const RowMajor& a, const VectorRef& x, double* out);
/// a x for a symmetric a (n, n), all of which is there.
Eigen::VectorXd symmetric_product(const Eigen::MatrixXd& a, const VectorRef& x);
/// The symmetric matrix whose lower triangle is that of the first n rows and columns of a.
Eigen::MatrixXd symmetric_of_lower(const RowMajor& a, Index n);

/// Orthogonal triangularization in place: the first n columns of a become those of r in a = q r, the others q' times themselves.
void triangularize(RowsOf24& a, Index n);
/// r^-1 for the upper triangular r in the first n rows and columns, 0 elsewhere.
SquareOf24 inverse_of_triangle(const SquareOf24& r, Index n);
/// r of a = r' r in place of the upper triangle of the first n rows and columns of a, symmetric, of which that is read; the columns after
/// them become r'^-1 times themselves, and what is below means nothing. False where a diagonal element is left with less than `least` of
/// itself: rounding, as far as it counts.
bool factor_symmetric(SquareOf24& a, Index n, double least);

/// (x, y) such that x a + y b is nearest to v; the shortest such where a and b are parallel or zero.
Eigen::Vector2d in_frame(const Vec3& a, const Vec3& b, const Vec3& v);

}  // namespace tripatch
