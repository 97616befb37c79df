// The kernel of a polyharmonic spline among samples, seen through combinations of them in which polynomials cancel.
#pragma once

#include <algorithm>
#include <limits>
#include <utility>

#include "tripatch/math/decompositions.h"
#include "tripatch/math/dense_kernels.h"
#include "tripatch/math/polyharmonic.h"

namespace tripatch {

/// Of one order at its best nugget.
struct Likelihood {
  double logarithm = -std::numeric_limits<double>::infinity();
  double decade = 0;    // of the nugget
  double nugget = 0;    // over the kernel's unit
  double variance = 0;  // of the kernel's unit
};

/// Monomials up to the order's degree at points, n x q.
inline Eigen::MatrixXd free_monomials(const PlanePoints& c, double order) {
  const int d = free_degree_of(order);
  Eigen::MatrixXd u = Eigen::MatrixXd::Ones(c.rows(), d + 1), v = u;
  for (int k = 1; k <= d; ++k) {
    u.col(k) = u.col(k - 1).cwiseProduct(c.col(0));
    v.col(k) = v.col(k - 1).cwiseProduct(c.col(1));
  }
  Eigen::MatrixXd out(c.rows(), free_polynomials(order));
  int column = 0;
  for (int i = 0; i <= d; ++i)
    for (int j = 0; i + j <= d; ++j, ++column) out.col(column) = u.col(i).cwiseProduct(v.col(j));
  return out;
}

/// a b for a (m, n) and b (n, k).
inline Eigen::MatrixXd product(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const Index m = a.rows(), n = a.cols(), k = b.cols(), padded = (k + four - 1) / four * four;
  Eigen::MatrixXd from = Eigen::MatrixXd::Zero(n, padded), out(m, padded);
  from.leftCols(k) = b;
  for (Index j = 0; j < padded; j += four) multiply_four(from.col(j).data(), n, a.data(), m, out.col(j).data(), m);
  out.conservativeResize(m, k);
  return out;
}

/// The kernel among samples, seen through contrasts: combinations of samples in which polynomials cancel. Polynomials themselves
/// are given the kernel's mean variance in it, so that it is definite, and stay apart from contrasts.
struct Contrasts {
  /// apart: distances among the samples' places c.
  Contrasts(const PlanePoints& c, const PlaneDistances& apart, double order)
      : q(free_polynomials(order)), inner(polyharmonic_kernel(order, apart)) {
    OrthonormalColumns polynomials = orthonormal_columns(free_monomials(c, order), false);
    basis = std::move(polynomials.basis);
    triangle = std::move(polynomials.triangle);
    along = product(inner, basis);
    Eigen::MatrixXd turned = along;
    const Eigen::MatrixXd within = basis.transpose() * turned;
    const double trace = inner.trace() - 2 * within.trace() + within.trace();
    unit = trace / static_cast<double>(c.rows() - q);
    turned -= 0.5 * basis * (within + unit * Eigen::MatrixXd::Identity(q, q));
    take_from_inner(turned);
  }
  /// Without their polynomial part.
  Eigen::MatrixXd of(const Eigen::MatrixXd& samples) const { return samples - basis * (basis.transpose() * samples); }
  /// The lower Cholesky factor of what is among contrasts with noise; false where it is not definite.
  bool factor(double nugget, Eigen::MatrixXd& lower) const {
    lower = Eigen::MatrixXd(inner);  // its own memory first: where there is none, lower must not be left without
    lower.diagonal().array() += nugget;
    return factor_cholesky(lower);
  }
  /// The weights of the kernel with samples.
  Eigen::MatrixXd weights(const Eigen::MatrixXd& lower, const Eigen::MatrixXd& samples) const {
    Eigen::MatrixXd x = of(samples);
    lower.triangularView<Eigen::Lower>().solveInPlace(x);
    lower.triangularView<Eigen::Lower>().transpose().solveInPlace(x);
    return of(x);
  }
  /// The polynomial next to the weights.
  Eigen::MatrixXd polynomial(const Eigen::MatrixXd& weights, const Eigen::MatrixXd& samples) const {
    return triangle.triangularView<Eigen::Upper>().solve(basis.transpose() * samples - along.transpose() * weights);
  }

  Index q;
  Eigen::MatrixXd inner;            // the kernel, of which contrasts see the lower half
  Eigen::MatrixXd basis, triangle;  // of the polynomials at the samples: orthonormal, and the monomials by it
  Eigen::MatrixXd along;            // the kernel times the basis
  double unit = 0;                  // mean eigenvalue of the kernel among contrasts

private:
  /// The basis times `turned` by columns of samples, and that the other way round; above the diagonal stays what was there, or less.
  void take_from_inner(const Eigen::MatrixXd& turned) {
    const Index n = inner.rows();
    Eigen::MatrixXd left(n, 2 * q), taken(n, four), across(2 * q, four);
    left << basis, turned;
    for (Index from = 0; from < n; from += four) {
      const Index own = std::min(four, n - from);
      across.setZero();
      across.topLeftCorner(q, own) = turned.middleRows(from, own).transpose();
      across.bottomLeftCorner(q, own) = basis.middleRows(from, own).transpose();
      multiply_four(across.data(), 2 * q, left.data(), n, taken.data(), n);
      for (Index k = 0; k < own; ++k) inner.col(from + k).tail(n - from) -= taken.col(k).tail(n - from);
    }
  }
};

}  // namespace tripatch
