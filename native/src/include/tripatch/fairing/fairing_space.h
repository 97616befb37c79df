// What a fairing adds to a patch: functions that keep G1, the same for all holes, and their derivatives at the nodes of a quadrature.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "tripatch/fairing/curvature.h"
#include "tripatch/fairing/energy.h"
#include "tripatch/fairing/energy_problem.h"
#include "tripatch/math/dense_kernels.h"
#include "tripatch/math/piecewise_polynomial.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/patch/bezier_triangle.h"
#include "tripatch/patch/side_weights.h"
#include "tripatch/patch/surface.h"

namespace tripatch {

/// The part of a side-vertex patch that multiplies the derivative across side i.
template <int N>
Jet<N> slope_kernel(const Barycentric<N>& b, const std::array<Jet<N>, 3>& w, int i) {
  const Jet<N> s = b[(i + 1) % 3] + b[(i + 2) % 3];
  return -(w[i] * (square(s) * b[i]));
}

/// What multiplies the second derivative across side i: w: cubic_side_weights.
template <int N>
Jet<N> second_cross_kernel(const Barycentric<N>& b, const std::array<Jet<N>, 3>& w, int i) {
  return 0.5 * (square(b[i]) * w[i]);
}

/// What multiplies the interior polynomial.
template <int N>
Jet<N> bubble(const Barycentric<N>& b) {
  return square(27 * (b[0] * b[1] * b[2]));
}

inline Index scalars(int degree, int second_cross) { return BezierTriangle::net_size(degree) + 3 * second_cross; }

constexpr int highest_interior = count::degree;  // degree

/// f(K, b^K) for each monomial of that degree, in the order of a BezierTriangle's net.
template <int N, class F>
void for_monomials(const Barycentric<N>& b, int degree, const F& f) {
  std::array<std::array<Jet<N>, highest_interior + 1>, 3> power;
  for (int i = 0; i < 3; ++i) {
    power[i][0] = 1.0;
    for (int k = 1; k <= degree; ++k) power[i][k] = power[i][k - 1] * b[i];
  }
  int at = 0;
  for (int i = degree; i >= 0; --i)
    for (int j = degree - i; j >= 0; --j) f(at++, power[0][i] * (power[1][j] * power[2][degree - i - j]));
}

/// What makes Bernstein polynomials of those.
inline std::vector<double> multinomials(int degree) {
  std::vector<double> m;
  for (int i = degree; i >= 0; --i)
    for (int j = degree - i; j >= 0; --j) m.push_back(choose(degree, i) * choose(degree - i, j));
  return m;
}

/// The interior functions (27 b0 b1 b2)^2 B_K(b), then those that bend the patch across side i: 1/2 b_i^2, times the cubic side
/// weight, times the Bernstein polynomials of t of degree second_cross - 1. These reach to the corners, where the interior is too flat.
template <int N>
std::vector<Jet<N>> scalar_basis(const Barycentric<N>& b, int degree, int second_cross) {
  std::vector<Jet<N>> basis;
  basis.reserve(scalars(degree, second_cross));
  const Jet<N> inside = bubble(b);
  const std::vector<double> factor = multinomials(degree);
  for_monomials(b, degree, [&](int k, const Jet<N>& f) { basis.push_back(factor[k] * (inside * f)); });
  if (second_cross == 0) return basis;
  const std::array<Jet<N>, 3> weight = cubic_side_weights(b);
  for (int i = 0; i < 3; ++i) {
    const Jet<N> kernel = second_cross_kernel(b, weight, i), t = ray_parameter(b, i), s = 1.0 - t;
    for (int m = 0; m < second_cross; ++m) {
      Jet<N> f = choose(second_cross - 1, m) * kernel;
      for (int k = 0; k < m; ++k) f *= t;
      for (int k = m + 1; k < second_cross; ++k) f *= s;
      basis.push_back(f);
    }
  }
  return basis;
}

/// What a fairing adds to a patch. slopes: on each side, what is added to the derivative across it; coefficients: of scalar_basis,
/// one a row.
SurfacePtr correction(const std::array<PiecewisePolynomial, 3>& slopes, int degree, int second_cross, const Points& coefficients);

/// The scalar functions of t that alpha and beta may gain: 4 t (1 - t) times the Bernstein polynomials of degree count - 1.
std::vector<PiecewisePolynomial> slope_functions(int count);
/// Their sum with the given coefficients.
PiecewisePolynomial slope_function(std::span<const double> coefficients);

/// What is the same for all holes: nodes, the interior basis and the kernels of the slopes at them.
struct FairingSpace : NodeBasis {
  Quadrature quadrature;
  /// Side i at a node: t_i there, and the derivatives of the kernel times function m times (t - t_i)^k: row k, the functions of one
  /// derivative after those of the last.
  struct Slope {
    double t;
    RowMajor rows;
  };
  std::vector<std::array<Slope, 3>> slope;  // at each node
  SideBasis along;
  Eigen::RowVectorXd center, center_slope;  // at b = (1/3, 1/3, 1/3): scalar functions, and kernel times functions of a side

  FairingSpace(int degree, int second_cross, int slopes, int nodes);

private:
  FairingSpace(Quadrature nodes, int degree, int second_cross, int slopes);
};

/// Made once for each set of numbers and kept.
const FairingSpace& fairing_space(int degree, int second_cross, int slopes, int nodes);

}  // namespace tripatch
