#include "tripatch/math/linear.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <limits>

// Eigen's products take what the compiler may assume of every machine. These are compiled for newer ones too, and chosen at run time.
#if defined(__x86_64__) && defined(__GLIBC__) && !defined(__clang__) && __GNUC__ >= 12
#define TRIPATCH_FOR_EACH_MACHINE __attribute__((target_clones("arch=x86-64-v3", "default")))
#else
#define TRIPATCH_FOR_EACH_MACHINE
#endif

namespace tripatch {
namespace {

TRIPATCH_FOR_EACH_MACHINE void add_gram(const double* __restrict a, Index m, Index n, double* __restrict c) {
  constexpr Index rows = 4, columns = 8;  // of c: what the registers hold
  for (Index i = 0; i < n; i += rows)
    for (Index j = 0; j < i + rows && j < n; j += columns) {
      if (i + rows <= n && j + columns <= n) {
        double sum[rows][columns] = {};
        for (Index k = 0; k < m; ++k) {
          const double* row = a + k * n;
          for (Index p = 0; p < rows; ++p)
            for (Index q = 0; q < columns; ++q) sum[p][q] += row[i + p] * row[j + q];
        }
        for (Index p = 0; p < rows; ++p)
          for (Index q = 0; q < columns; ++q) c[(i + p) * n + j + q] += sum[p][q];
      } else {
        for (Index k = 0; k < m; ++k)
          for (Index p = i; p < std::min(n, i + rows); ++p)
            for (Index q = j; q < std::min(n, j + columns); ++q) c[p * n + q] += a[k * n + p] * a[k * n + q];
      }
    }
}

}  // namespace

TRIPATCH_FOR_EACH_MACHINE void multiply_four(const double* __restrict a, Index k, const double* __restrict b, Index n,
                                             double* __restrict out, Index stride) {
  constexpr Index rows = 4, columns = 8;
  Index j = 0;
  for (; j + columns <= n; j += columns) {
    double sum[rows][columns] = {};
    for (Index l = 0; l < k; ++l)
      for (Index p = 0; p < rows; ++p)
        for (Index q = 0; q < columns; ++q) sum[p][q] += a[p * k + l] * b[l * n + j + q];
    for (Index p = 0; p < rows; ++p)
      for (Index q = 0; q < columns; ++q) out[p * stride + j + q] = sum[p][q];
  }
  for (; j < n; ++j)
    for (Index p = 0; p < rows; ++p) {
      double sum = 0;
      for (Index l = 0; l < k; ++l) sum += a[p * k + l] * b[l * n + j];
      out[p * stride + j] = sum;
    }
}

void add_gram(const RowMajor& a, RowMajor& c) { add_gram(a.data(), a.rows(), a.cols(), c.data()); }

Eigen::MatrixXd least_squares(const MatrixRef& a, const MatrixRef& b) { return a.completeOrthogonalDecomposition().solve(b); }

MinimumNormSolution minimum_norm_least_squares(const MatrixRef& a, const MatrixRef& b, double threshold) {
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition;
  decomposition.setThreshold(threshold);
  decomposition.compute(a);
  return {decomposition.solve(b), decomposition.rank()};
}

Eigen::VectorXd constrained_quadratic_minimum(const MatrixRef& a, const VectorRef& b, const MatrixRef& held) {
  const Eigen::LLT<Eigen::MatrixXd> factor(a);
  if (factor.info() != Eigen::Success) return Eigen::VectorXd::Constant(b.size(), std::numeric_limits<double>::quiet_NaN());
  Eigen::VectorXd x = -factor.solve(b);
  if (held.rows() == 0) return x;
  const Eigen::MatrixXd across = factor.solve(held.transpose());
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
