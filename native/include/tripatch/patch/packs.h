// Four points at a time, or with AVX-512 eight where no more than a tangent plane is asked for: jets, fields of sides and weights as jet.h
// and side_weights.h have them, one point in each lane of a register. Every operation is made in the same order as there, and none is
// fused with another, so that the bits are the same. Machines without AVX2 and compilers without its vectors evaluate point by point.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "tripatch/math/machines.h"
#include "tripatch/patch/surface.h"

namespace tripatch {

/// The vertex that is nearest to b, as side_weights sees it.
inline int nearest_vertex(const double* b) {
  int i = 0;
  for (int k = 1; k < 3; ++k)
    if (b[k] > b[i]) i = k;
  return i;
}

#ifdef TRIPATCH_PACKS

template <int N, class P = Pack>
struct PackJet {
  static constexpr int size = jet_size(N);
  P c[size];

  TRIPATCH_ANY_PACK PackJet& operator+=(const PackJet& o) {
    for (int k = 0; k < size; ++k) c[k] += o.c[k];
    return *this;
  }
  TRIPATCH_ANY_PACK PackJet& operator*=(double s) {
    for (int k = 0; k < size; ++k) c[k] *= s;
    return *this;
  }
  TRIPATCH_ANY_PACK friend PackJet operator+(const PackJet& a, const PackJet& b) {
    PackJet r = a;
    return r += b;
  }
  TRIPATCH_ANY_PACK friend PackJet operator*(double s, const PackJet& a) {
    PackJet r = a;
    return r *= s;
  }
  /// Of each lane its own number.
  TRIPATCH_ANY_PACK friend PackJet operator*(const P& s, const PackJet& a) {
    PackJet r;
    for (int k = 0; k < size; ++k) r.c[k] = s * a.c[k];
    return r;
  }
  TRIPATCH_ANY_PACK friend PackJet operator*(const PackJet& a, const PackJet& b)
    requires(N <= 1)
  {
    PackJet r;
    r.c[0] = a.c[0] * b.c[0];
    for (int k = 1; k < size; ++k) r.c[k] = a.c[0] * b.c[k] + a.c[k] * b.c[0];
    return r;
  }
  TRIPATCH_PACKED friend PackJet operator*(const PackJet& a, const PackJet& b)
    requires(N > 1)
  {
    PackJet r = {};
    add_products(r, a, b, std::make_index_sequence<Jet<N>::products.size()>());
    return r;
  }

private:
  template <std::size_t... K>
  TRIPATCH_ANY_PACK static void add_products(PackJet& r, const PackJet& a, const PackJet& b, std::index_sequence<K...>) {
    ((r.c[Jet<N>::products[K][0]] += a.c[Jet<N>::products[K][1]] * b.c[Jet<N>::products[K][2]]), ...);
  }
};

template <int N, class P = Pack>
struct PackPoint {
  PackJet<N, P> x[3];
};

template <int N, class P>
TRIPATCH_ANY_PACK PackJet<N, P> square(const PackJet<N, P>& a) {
  return a * a;
}

/// As of jet.h; taylor: N + 1 coefficients.
template <int N, class P>
TRIPATCH_ANY_PACK PackJet<N, P> compose(const P* taylor, std::ptrdiff_t stride, const PackJet<N, P>& t) {
  if constexpr (N == 0) {
    return {{taylor[0]}};
  } else {
    PackJet<N, P> h = t;
    h.c[0] = P{};
    PackJet<N, P> r = taylor[N * stride] * h;
    for (int k = N - 1; k > 0; --k) {
      r.c[0] += taylor[k * stride];
      r = r * h;
    }
    r.c[0] += taylor[0];
    return r;
  }
}

template <int N, class P>
TRIPATCH_ANY_PACK PackJet<N, P> reciprocal(const PackJet<N, P>& a) {
  P f[N + 1];
  f[0] = 1.0 / a.c[0];
  for (int k = 1; k <= N; ++k) f[k] = -f[k - 1] * f[0];
  return compose<N>(f, 1, a);
}

/// f(s, t), as of jet.h: components of its Taylor coefficients.
template <int N, class P>
TRIPATCH_ANY_PACK PackPoint<N, P> compose(const P (&taylor)[jet_size(N)][3], const PackJet<N, P>& s, const PackJet<N, P>& t) {
  PackJet<N, P> power[jet_size(N)];
  PackPoint<N, P> r = {};
  for (int x = 0; x < 3; ++x) r.x[x].c[0] = taylor[0][x];
  if constexpr (N > 0) {
    power[1] = s;
    power[2] = t;
    power[1].c[0] = power[2].c[0] = P{};
    for (int i = 0; i <= N; ++i)
      for (int j = 0; i + j <= N; ++j) {
        const int at = jet_index(i, j);
        if (i + j > 1) power[at] = i > 0 ? power[1] * power[jet_index(i - 1, j)] : power[2] * power[jet_index(0, j - 1)];
        if (at == 0) continue;
        for (int x = 0; x < 3; ++x) r.x[x] += taylor[at][x] * power[at];
      }
  }
  return r;
}

/// Barycentric coordinates of points with the same nearest vertex.
template <int N, class P = Pack>
struct PackBarycentric {
  PackJet<N, P> b[3] = {};
  int nearest;

  TRIPATCH_ANY_PACK PackBarycentric(const double* all, const Index (&rows)[width_of<P>], int nearest_vertex)
      : nearest(nearest_vertex) {
    for (int i = 0; i < 3; ++i) {
      for (Index lane = 0; lane < width_of<P>; ++lane) b[i].c[0][lane] = all[3 * rows[lane] + i];
      if constexpr (N > 0) {
        b[i].c[1] = all_lanes_of<P>(i == 0 ? 1.0 : i == 1 ? 0.0 : -1.0);
        b[i].c[2] = all_lanes_of<P>(i == 0 ? 0.0 : i == 1 ? 1.0 : -1.0);
      }
    }
  }
  TRIPATCH_ANY_PACK const PackJet<N, P>& operator[](int i) const { return b[i]; }
};

/// side_weights, Power = 2, and cubic_side_weights, 3.
template <int Power, int N, class P>
TRIPATCH_ANY_PACK void side_weights(const PackBarycentric<N, P>& b, PackJet<N, P> (&w)[3]) {
  const int i = b.nearest, j = (i + 1) % 3, k = (i + 2) % 3;
  const PackJet<N, P> rho = b[j] + b[k], over = reciprocal(rho);
  const PackJet<N, P> t = b[k] * over, s = b[j] * over;
  PackJet<N, P> tt = square(t), ss = square(s), bb = square(b[i]), outer = square(rho);
  if constexpr (Power == 3) {
    tt = t * tt;
    ss = s * ss;
    bb = b[i] * bb;
    outer = rho * outer;
  }
  const PackJet<N, P> wi = outer * tt * ss, wj = bb * tt, wk = bb * ss;
  const PackJet<N, P> inverse = reciprocal(wi + wj + wk);
  w[i] = wi * inverse;
  w[j] = wj * inverse;
  w[k] = wk * inverse;
}

template <int N, class P>
TRIPATCH_ANY_PACK PackJet<N, P> ray_parameter(const PackBarycentric<N, P>& b, int i) {
  return b[(i + 2) % 3] * reciprocal(b[(i + 1) % 3] + b[(i + 2) % 3]);
}

#endif

/// A field of three components whose Taylor series are made for four parameters at a time.
class PackedField {
public:
  PackedField() = default;
  explicit PackedField(const PiecewisePolynomial& field) : degree_(field.degree()) {
    const std::vector<double>& breaks = field.breaks();
    const Index n = field.pieces();
    coefficients_.assign(field.coefficients().begin(), field.coefficients().end());
    coefficients_.push_back(0);  // whole registers are read
    for (Index p = 0; p < n; ++p) {
      middles_.push_back(0.5 * (breaks[p] + breaks[p + 1]));
      ends_.push_back(p + 1 < n ? breaks[p + 1] : std::numeric_limits<double>::infinity());
    }
    const std::size_t places = n == 1 ? 1 : 2 * n;
    for (std::size_t k = 0, p = 0; k < places; ++k) {
      while (ends_[p] <= static_cast<double>(k) / static_cast<double>(places)) ++p;
      lookup_.push_back(static_cast<std::int32_t>(p));
    }
  }

  /// Whether parameters have the same places among the pieces of both.
  bool has_places_of(const PackedField& o) const { return middles_ == o.middles_ && ends_ == o.ends_; }

#ifdef TRIPATCH_PACKS
  /// Parameters among the pieces.
  template <class P>
  struct Places {
    Index piece[width_of<P>];
    P u;  ///< from the middles of the pieces
  };
  template <class P>
  TRIPATCH_ANY_PACK Places<P> places(const P& t) const {
    const double size = static_cast<double>(lookup_.size());
    const P least = {}, most = all_lanes_of<P>(size - 1);
    P scaled = t * size, middle;
    scaled = scaled > least ? scaled : least;
    scaled = scaled < most ? scaled : most;
    Places<P> out;
    for (int lane = 0; lane < width_of<P>; ++lane) {
      Index p = lookup_[static_cast<std::int32_t>(scaled[lane])];
      while (t[lane] >= ends_[p]) ++p;
      out.piece[lane] = p;
      middle[lane] = middles_[p];
    }
    out.u = t - middle;
    return out;
  }
  /// As PiecewisePolynomial::taylor.
  template <int Order>
  TRIPATCH_PACKED void taylor(const Places<Pack>& at, Pack (&out)[Order + 1][3]) const {
    series<Order>(at, out);
  }
  template <int Order>
  TRIPATCH_WIDE void taylor(const Places<WidePack>& at, WidePack (&out)[Order + 1][3]) const {
    series<Order>(at, out);
  }

  /// At jets.
  template <int N, class P>
  TRIPATCH_ANY_PACK PackPoint<N, P> at(const PackJet<N, P>& t) const {
    P taylor_of_t[N + 1][3];
    taylor<N>(places(t.c[0]), taylor_of_t);
    PackPoint<N, P> p;
    for (int x = 0; x < 3; ++x) p.x[x] = compose<N, P>(&taylor_of_t[0][x], 3, t);
    return p;
  }

private:
  template <int Order, class P>
  TRIPATCH_ANY_PACK void series(const Places<P>& at, P (&out)[Order + 1][3]) const {
    constexpr int lanes = width_of<P>;
    const Index width = 3 * (degree_ + 1);
    const double* a[lanes];
    bool same = true;
    for (int lane = 0; lane < lanes; ++lane) {
      a[lane] = &coefficients_[width * at.piece[lane]];
      same = same && a[lane] == a[0];
    }
    if (same)
      horner<Order>(at.u, out, [&](Index k, P(&next)[3]) TRIPATCH_ANY_PACK_LAMBDA {
        for (int x = 0; x < 3; ++x) next[x] = all_lanes_of<P>(a[0][3 * k + x]);
      });
    else
      horner<Order>(at.u, out, [&](Index k, P(&next)[3]) TRIPATCH_ANY_PACK_LAMBDA { load(a, k, next); });
  }

  /// The coefficients of u^k of four places; one number beyond the last ones is there.
  TRIPATCH_ANY_PACK static void load(const double* const* a, Index k, Pack (&next)[3]) {
    const Pack even = loaded_pairs(a[0] + 3 * k, a[2] + 3 * k), odd = loaded_pairs(a[1] + 3 * k, a[3] + 3 * k);
    next[0] = __builtin_shufflevector(even, odd, 0, 4, 2, 6);
    next[1] = __builtin_shufflevector(even, odd, 1, 5, 3, 7);
    next[2] = __builtin_shufflevector(loaded_pairs(a[0] + 3 * k + 2, a[2] + 3 * k + 2),
                                      loaded_pairs(a[1] + 3 * k + 2, a[3] + 3 * k + 2), 0, 4, 2, 6);
  }
  TRIPATCH_ANY_PACK static void load(const double* const* a, Index k, WidePack (&next)[3]) {
    Pack low[3], high[3];
    load(a, k, low);
    load(a + 4, k, high);
    for (int x = 0; x < 3; ++x) next[x] = __builtin_shufflevector(low[x], high[x], 0, 1, 2, 3, 4, 5, 6, 7);
  }

  /// load_next(k, next): the coefficients of u^k.
  template <int Order, class P, class Load>
  TRIPATCH_ANY_PACK void horner(const P& u, P (&out)[Order + 1][3], const Load& load_next) const {
    P sum[Order + 1][3] = {}, next[3];
    load_next(degree_, sum[0]);
    for (Index k = degree_ - 1; k >= 0; --k) {
      load_next(k, next);
      for (int j = Order; j > 0; --j)
        for (int x = 0; x < 3; ++x) sum[j][x] = sum[j][x] * u + sum[j - 1][x];
      for (int x = 0; x < 3; ++x) sum[0][x] = sum[0][x] * u + next[x];
    }
    for (int j = 0; j <= Order; ++j)
      for (int x = 0; x < 3; ++x) out[j][x] = sum[j][x];
  }
#endif

private:
  int degree_ = 0;
  std::vector<double> middles_, ends_;  // of the pieces; the last ends nowhere
  std::vector<double> coefficients_;
  std::vector<std::int32_t> lookup_;  // first candidate piece for floor(t * lookup size)
};

/// A JetSurface whose formula Derived has for four points too:
///   `template <int N> PackPoint<N> at(const PackBarycentric<N>& b) const;` (under TRIPATCH_PACKS, N up to highest_packed)
/// and for eight (WidePack, N up to highest_wide).
template <class Derived>
class PackedSurface : public JetSurface<Derived> {
public:
  static constexpr int highest_packed = 3;  ///< order that fairing asks for
  static constexpr int highest_wide = 1;    ///< and those of a fill's positions and normals

#ifdef TRIPATCH_PACKS
private:
  void evaluate_regular(const double* b, Index n, int order, double* out) const override {
    static const bool packs = __builtin_cpu_supports("avx2"), wide = __builtin_cpu_supports("x86-64-v4");
    if (!packs || n < lanes || order < 0 || order > highest_packed)
      return JetSurface<Derived>::evaluate_regular(b, n, order, out);
    if (wide && order <= highest_wide) return with_order<0, highest_wide>(order, [&](auto N) { run_wide<N.value>(b, n, out); });
    with_order<0, highest_packed>(order, [&](auto N) { run_packed<N.value>(b, n, out); });
  }

  template <int N>
  TRIPATCH_PACKED void run_packed(const double* b, Index n, double* out) const {
    run<N, Pack>(b, n, out);
  }
  template <int N>
  TRIPATCH_WIDE void run_wide(const double* b, Index n, double* out) const {
    run<N, WidePack>(b, n, out);
  }

  template <int N, class P>
  TRIPATCH_ANY_PACK void run(const double* b, Index n, double* out) const {
    constexpr int size = jet_size(N), lanes = width_of<P>;
    std::array<std::vector<Index>, 3> groups;  // of points, by nearest vertex
    for (Index k = 0; k < n; ++k) groups[nearest_vertex(b + 3 * k)].push_back(k);
    for (int i = 0; i < 3; ++i) {
      const std::vector<Index>& group = groups[i];
      const Index count = static_cast<Index>(group.size());
      for (Index first = 0; first < count; first += lanes) {
        Index rows[lanes];  // the last again where there are no more
        for (Index lane = 0; lane < lanes; ++lane) rows[lane] = group[std::min(first + lane, count - 1)];
        const PackPoint<N, P> p = static_cast<const Derived*>(this)->template at<N>(PackBarycentric<N, P>(b, rows, i));
        for (Index lane = 0; lane < lanes; ++lane)
          for (int k = 0; k < size; ++k)
            for (int x = 0; x < 3; ++x) out[(rows[lane] * size + k) * 3 + x] = p.x[x].c[k][lane];
      }
    }
  }
#endif
};

}  // namespace tripatch
