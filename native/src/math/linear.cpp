#include "tripatch/math/linear.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

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

constexpr Index panel = 16;  ///< rows of a Cholesky factor made at a time: they stay in the first cache

/// Rows [from, to) of an upper triangular factor, in place; false where the matrix is not positive definite.
TRIPATCH_FOR_EACH_MACHINE bool factor_panel(double* __restrict a, Index n, Index from, Index to) {
  for (Index k = from; k < to; ++k) {
    double* const row = a + k * n;
    if (!(row[k] > 0)) return false;
    row[k] = std::sqrt(row[k]);
    const double over = 1 / row[k];
    for (Index j = k + 1; j < n; ++j) row[j] *= over;
    for (Index i = k + 1; i < to; ++i)
      for (Index j = i; j < n; ++j) a[i * n + j] -= row[i] * row[j];
  }
  return true;
}

/// What `count` rows of the factor take away from those below, from row `begin` on.
TRIPATCH_FOR_EACH_MACHINE void subtract_gram(const double* __restrict u, Index count, Index n, Index begin,
                                             double* __restrict c) {
  constexpr Index rows = 4, columns = 8;  // of c: what the registers hold
  for (Index i = begin; i < n; i += rows)
    for (Index j = i; j < n; j += columns) {
      const bool whole = i + rows <= n && j + columns <= n;
      if (whole) {
        double sum[rows][columns] = {};
        for (Index k = 0; k < count; ++k) {
          const double* row = u + k * n;
          for (Index p = 0; p < rows; ++p)
            for (Index q = 0; q < columns; ++q) sum[p][q] += row[i + p] * row[j + q];
        }
        for (Index p = 0; p < rows; ++p)
          for (Index q = 0; q < columns; ++q) c[(i + p) * n + j + q] -= sum[p][q];
      } else {
        for (Index k = 0; k < count; ++k)
          for (Index p = i; p < std::min(n, i + rows); ++p)
            for (Index q = j; q < std::min(n, j + columns); ++q) c[p * n + q] -= u[k * n + p] * u[k * n + q];
      }
    }
}

/// The lower Cholesky factor of a symmetric matrix in its own lower triangle, by columns: Eigen's takes twice the time, for it is
/// compiled for every machine. Above stays what was there. False where the matrix is not positive definite.
bool factor_cholesky(Eigen::MatrixXd& a) {
  const Index n = a.rows();  // columns of the lower factor are rows of the upper one
  for (Index from = 0; from < n; from += panel) {
    const Index to = std::min(n, from + panel);
    if (!factor_panel(a.data(), n, from, to)) return false;
    subtract_gram(a.data() + from * n, to - from, n, to, a.data());
  }
  return true;
}

}  // namespace

namespace {

/// b: k rows of four, the last of each nothing.
TRIPATCH_FOR_EACH_MACHINE void add_product_of_fours(const double* __restrict a, Index m, Index k, const double* __restrict b,
                                                    double* __restrict out) {
  constexpr Index rows = 4;
  for (Index i = 0; i < m; i += rows) {
    const Index count = std::min(rows, m - i);
    double sum[rows][4] = {};
    if (count == rows) {
      for (Index j = 0; j < k; ++j)
        for (Index p = 0; p < rows; ++p)
          for (Index x = 0; x < 4; ++x) sum[p][x] += a[(i + p) * k + j] * b[4 * j + x];
    } else {
      for (Index j = 0; j < k; ++j)
        for (Index p = 0; p < count; ++p)
          for (Index x = 0; x < 4; ++x) sum[p][x] += a[(i + p) * k + j] * b[4 * j + x];
    }
    for (Index p = 0; p < count; ++p)
      for (Index x = 0; x < 3; ++x) out[3 * (i + p) + x] += sum[p][x];
  }
}

}  // namespace

void add_product(const double* a, Index m, Index k, const double* b, double* out) {
  std::vector<double> fours(4 * k);
  for (Index j = 0; j < k; ++j)
    for (Index x = 0; x < 3; ++x) fours[4 * j + x] = b[x * k + j];
  add_product_of_fours(a, m, k, fours.data(), out);
}

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
  Eigen::MatrixXd lower = a;
  if (!factor_cholesky(lower)) return Eigen::VectorXd::Constant(b.size(), std::numeric_limits<double>::quiet_NaN());
  const auto solve = [&](auto& right) {
    lower.triangularView<Eigen::Lower>().solveInPlace(right);
    lower.triangularView<Eigen::Lower>().transpose().solveInPlace(right);
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
