// Products and factors of dense matrices, compiled for newer machines too and chosen at run time.
#pragma once

#include "tripatch/types.h"

namespace tripatch {

using VectorRef = Eigen::Ref<const Eigen::VectorXd>;

/// The lower Cholesky factor of a symmetric matrix in its own lower triangle, which is read. Above stays what was there. False where the
/// matrix is not positive definite.
bool factor_cholesky(Eigen::MatrixXd& a);

/// q' a q, of which the diagonal and what lies next to it is not zero, for a symmetric a (n, n), n from 1 on, of which the lower triangle
/// is read and overwritten; b (n, k) becomes q' b. q is orthonormal.
struct Tridiagonal {
  Eigen::VectorXd diagonal, beside;
};
Tridiagonal tridiagonalize(Eigen::MatrixXd& a, Eigen::MatrixXd& b);

/// Small systems of up to 24 unknowns, the rest of each row being zero: three registers of eight, or six of four.
using RowsOf24 = Eigen::Matrix<double, Eigen::Dynamic, 24, Eigen::RowMajor>;
using SquareOf24 = Eigen::Matrix<double, 24, 24, Eigen::RowMajor>;
/// Adds a' a to c, of which only the lower triangle is kept up, for a (m, n) and c (n, n).
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
void add_gram(const RowMajor& a, RowMajor& c);
inline constexpr Index four = 4;
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

/// b becomes the x with l x = b, for the lower triangle l of a (n, n) and b (n, k).
void solve_lower_triangular(const Eigen::MatrixXd& a, RowMajor& b);

/// Orthogonal triangularization in place: the first n columns of a become those of r in a = q r, the others q' times themselves.
void triangularize(RowsOf24& a, Index n);
/// r of a = r' r in place of the upper triangle of the first n rows and columns of a, symmetric, of which that is read; the columns after
/// them become r'^-1 times themselves, and what is below means nothing. False where a diagonal element is left with less than `least` of
/// itself: rounding, as far as it counts.
bool factor_symmetric(SquareOf24& a, Index n, double least);

}  // namespace tripatch
