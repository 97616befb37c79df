// Shared pieces of the constructions over the triangle: side weights, feet, ray parameters.
#pragma once

#include "tripatch/math/jet.h"
#include "tripatch/math/piecewise_polynomial.h"

namespace tripatch {

/// Side weights of the Nielson blend (Szilvasi-Nagy and Szabo 2006, eq. 2): W_i = b_j^2 b_k^2 / (b_0^2 b_1^2 + b_1^2 b_2^2 +
/// b_2^2 b_0^2) = 1 + O(b_i^2) at side i. Written about the nearest vertex so that nothing underflows next to it; b must not
/// be a vertex.
template <int N>
std::array<Jet<N>, 3> side_weights(const Barycentric<N>& b) {
  int i = 0;
  for (int k = 1; k < 3; ++k)
    if (b[k].value() > b[i].value()) i = k;
  const int j = (i + 1) % 3, k = (i + 2) % 3;
  // With rho = b_j + b_k, b_j = rho (1 - t), b_k = rho t: all terms are divided by rho^2.
  const Jet<N> rho = b[j] + b[k];
  const Jet<N> t = b[k] / rho, s = b[j] / rho;
  const Jet<N> tt = square(t), ss = square(s), bb = square(b[i]);
  const Jet<N> wi = square(rho) * tt * ss, wj = bb * tt, wk = bb * ss;
  const Jet<N> inverse = reciprocal(wi + wj + wk);
  std::array<Jet<N>, 3> w;
  w[i] = wi * inverse;
  w[j] = wj * inverse;
  w[k] = wk * inverse;
  return w;
}

/// Parameter on side i of the ray from vertex i through b: t = b_k / (b_j + b_k). b must not be vertex i.
template <int N>
Jet<N> ray_parameter(const Barycentric<N>& b, int i) {
  return b[(i + 2) % 3] / (b[(i + 1) % 3] + b[(i + 2) % 3]);
}

/// foot_i(b): where the line through b in the direction delta_i (b_i grows by 1, the others fall by 1/2) meets side i.
template <int N>
Barycentric<N> foot(const Barycentric<N>& b, int i) {
  Barycentric<N> f;
  const int j = (i + 1) % 3, k = (i + 2) % 3;
  f[i] = Jet<N>(0.0);
  f[j] = b[j] + 0.5 * b[i];
  f[k] = b[k] + 0.5 * b[i];
  return f;
}

/// A field of a side at a jet parameter: composed with its Taylor series, derivatives included.
template <int N>
JetPoint<N> compose(const PiecewisePolynomial& f, const Jet<N>& t) {
  std::array<double, 3 * (N + 1)> series;
  f.taylor(t.value(), N, series.data());
  JetPoint<N> p;
  for (int x = 0; x < 3; ++x) p.x[x] = compose<N>(series.data() + x, 3, t);
  return p;
}

/// The vertex that b is (within radius, measured by the sum of the two other coordinates), or -1.
inline int vertex_of(const double* b, double radius = 1e-30) {
  for (int i = 0; i < 3; ++i)
    if (b[(i + 1) % 3] + b[(i + 2) % 3] <= radius && b[i] > 0.5) return i;
  return -1;
}

}  // namespace tripatch
