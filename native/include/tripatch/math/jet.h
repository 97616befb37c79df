// Jet<N>: a truncated Taylor series of order N in the two free barycentric coordinates (b0, b1), b2 = 1 - b0 - b1.
// Arithmetic on jets gives exact derivatives of every construction from one formula, without finite differences.
// Coefficient of db0^i db1^j stands at index(i, j); a derivative is the coefficient times i! j!.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

namespace tripatch {

constexpr int jet_index(int i, int j) { return (i + j) * (i + j + 1) / 2 + j; }
constexpr int jet_size(int order) { return (order + 1) * (order + 2) / 2; }

template <int N>
struct Jet {
  static constexpr int order = N;
  static constexpr int size = jet_size(N);
  /// Every term of a product: coefficient of the result, of the first, of the second factor.
  static constexpr auto products = [] {
    std::array<std::array<int, 3>, (N + 1) * (N + 2) * (N + 3) * (N + 4) / 24> terms{};
    std::size_t n = 0;
    for (int d = 0; d <= N; ++d)
      for (int j = 0; j <= d; ++j)
        for (int e = 0; d + e <= N; ++e)
          for (int k = 0; k <= e; ++k) terms[n++] = {jet_index(d - j + e - k, j + k), jet_index(d - j, j), jet_index(e - k, k)};
    return terms;
  }();
  std::array<double, size> c{};

  Jet() = default;
  Jet(double value) { c[0] = value; }  // NOLINT(google-explicit-constructor): a number is a jet
  double value() const { return c[0]; }

  /// value + a db0 + b db1: barycentric coordinates and everything linear in them.
  static Jet linear(double value, double a, double b) {
    Jet r(value);
    if constexpr (N > 0) {
      r.c[1] = a;
      r.c[2] = b;
    }
    return r;
  }

  Jet& operator+=(const Jet& o) {
    for (int k = 0; k < size; ++k) c[k] += o.c[k];
    return *this;
  }
  Jet& operator-=(const Jet& o) {
    for (int k = 0; k < size; ++k) c[k] -= o.c[k];
    return *this;
  }
  Jet& operator*=(double s) {
    for (int k = 0; k < size; ++k) c[k] *= s;
    return *this;
  }
  friend Jet operator+(Jet a, const Jet& b) { return a += b; }
  friend Jet operator-(Jet a, const Jet& b) { return a -= b; }
  friend Jet operator-(Jet a) { return a *= -1.0; }
  friend Jet operator*(Jet a, double s) { return a *= s; }
  friend Jet operator*(double s, Jet a) { return a *= s; }
  friend Jet operator+(Jet a, double s) {
    a.c[0] += s;
    return a;
  }
  friend Jet operator+(double s, Jet a) {
    a.c[0] += s;
    return a;
  }
  friend Jet operator-(Jet a, double s) {
    a.c[0] -= s;
    return a;
  }
  friend Jet operator-(double s, const Jet& a) {
    Jet r = -a;
    r.c[0] += s;
    return r;
  }
  /// Not inlined: a call is nothing next to the product, and copies of it at every use are most of the time it takes to compile.
  friend Jet operator*(const Jet& a, const Jet& b)
    requires(N > 1)
  {
    Jet r;
    // unrolled by hand: the plain loops cost five times as much
    [&]<std::size_t... P>(std::index_sequence<P...>) {
      ((r.c[products[P][0]] += a.c[products[P][1]] * b.c[products[P][2]]), ...);
    }(std::make_index_sequence<products.size()>());
    return r;
  }
  /// Positions and normals of a fill are of this order, and a call would cost more than the product.
  [[gnu::always_inline]] friend inline Jet operator*(const Jet& a, const Jet& b)
    requires(N <= 1)
  {
    Jet r(a.c[0] * b.c[0]);
    for (int k = 1; k < size; ++k) r.c[k] = a.c[0] * b.c[k] + a.c[k] * b.c[0];
    return r;
  }
  Jet& operator*=(const Jet& b) { return *this = *this * b; }
};

template <int N>
Jet<N> square(const Jet<N>& a) {
  return a * a;
}

/// f(t) for a jet t and the Taylor coefficients f, f', f''/2, ... (order N) of f at t.value().
template <int N>
Jet<N> compose(const double* taylor, std::ptrdiff_t stride, const Jet<N>& t) {
  if constexpr (N == 0) return Jet<N>(taylor[0]);
  Jet<N> h = t;
  h.c[0] = 0;
  Jet<N> r = taylor[N * stride] * h;
  for (int k = N - 1; k > 0; --k) r = (r + taylor[k * stride]) * h;
  return r + taylor[0];
}

template <int N>
Jet<N> reciprocal(const Jet<N>& a) {
  std::array<double, N + 1> f{};
  f[0] = 1.0 / a.c[0];
  for (int k = 1; k <= N; ++k) f[k] = -f[k - 1] * f[0];
  return compose<N>(f.data(), 1, a);
}
template <int N>
Jet<N> operator/(const Jet<N>& a, const Jet<N>& b) {
  return a * reciprocal(b);
}
template <int N>
Jet<N> operator/(double a, const Jet<N>& b) {
  return a * reciprocal(b);
}

/// Square root of a positive jet.
template <int N>
Jet<N> sqrt(const Jet<N>& a) {
  std::array<double, N + 1> f{};
  f[0] = std::sqrt(a.c[0]);
  for (int k = 1; k <= N; ++k) f[k] = f[k - 1] * (1.5 - k) / (k * a.c[0]);
  return compose<N>(f.data(), 1, a);
}

/// A point in space as three jets.
template <int N>
struct JetPoint {
  std::array<Jet<N>, 3> x;

  JetPoint() = default;
  JetPoint(const Eigen::Vector3d& p) : x{Jet<N>(p[0]), Jet<N>(p[1]), Jet<N>(p[2])} {}  // NOLINT(google-explicit-constructor)

  JetPoint& operator+=(const JetPoint& o) {
    for (int k = 0; k < 3; ++k) x[k] += o.x[k];
    return *this;
  }
  JetPoint& operator-=(const JetPoint& o) {
    for (int k = 0; k < 3; ++k) x[k] -= o.x[k];
    return *this;
  }
  friend JetPoint operator+(JetPoint a, const JetPoint& b) { return a += b; }
  friend JetPoint operator-(JetPoint a, const JetPoint& b) { return a -= b; }
  friend JetPoint operator*(const Jet<N>& s, JetPoint a) {
    for (int k = 0; k < 3; ++k) a.x[k] = s * a.x[k];
    return a;
  }
  friend JetPoint operator*(double s, JetPoint a) {
    for (int k = 0; k < 3; ++k) a.x[k] *= s;
    return a;
  }
};

/// f(s, t) for jets s and t and the Taylor coefficients of f at their values, in the order of jet_index.
template <int N>
JetPoint<N> compose(const std::array<Eigen::Vector3d, Jet<N>::size>& taylor, const Jet<N>& s, const Jet<N>& t) {
  std::array<Jet<N>, Jet<N>::size> power;  // (s - s.value())^i (t - t.value())^j
  JetPoint<N> r(taylor[0]);
  if constexpr (N > 0) {
    power[1] = s;
    power[2] = t;
    power[1].c[0] = power[2].c[0] = 0;
  }
  for (int i = 0; i <= N; ++i)
    for (int j = 0; i + j <= N; ++j) {
      const int at = jet_index(i, j);
      if (i + j > 1) power[at] = i > 0 ? power[1] * power[jet_index(i - 1, j)] : power[2] * power[jet_index(0, j - 1)];
      if (at == 0) continue;
      for (int x = 0; x < 3; ++x) r.x[x] += taylor[at][x] * power[at];
    }
  return r;
}

/// Writes the jet_size(N) x 3 Taylor coefficients of a point, the layout of Surface::evaluate; returns the end.
template <int N>
double* store(const JetPoint<N>& p, double* out) {
  for (int i = 0; i < Jet<N>::size; ++i)
    for (int x = 0; x < 3; ++x) *out++ = p.x[x].c[i];
  return out;
}

/// Barycentric coordinates as jets.
template <int N>
struct Barycentric {
  std::array<Jet<N>, 3> b;
  Barycentric() = default;
  explicit Barycentric(const double* p)
      : b{Jet<N>::linear(p[0], 1, 0), Jet<N>::linear(p[1], 0, 1), Jet<N>::linear(p[2], -1, -1)} {}
  const Jet<N>& operator[](int i) const { return b[i]; }
  Jet<N>& operator[](int i) { return b[i]; }
};

}  // namespace tripatch
