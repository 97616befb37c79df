// Four points at a time: jets, fields of sides and weights, one point in each lane of a register, as jet.h and side_weights.h have them of one.
// Formulas are templates over their number P, a double or a Pack. Every operation is made in the same order for both and none is fused with
// another, so that the bits are the same. Machines and compilers without packs evaluate point by point.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "tripatch/math/simd.h"
#include "tripatch/math/tolerances.h"
#include "tripatch/patch/surface.h"

namespace tripatch {

#ifdef TRIPATCH_PACKS

template <int N>
struct PackJet {
  static constexpr int size = jet_size(N);
  Pack c[size];

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
  TRIPATCH_ANY_PACK friend PackJet operator*(const Pack& s, const PackJet& a) {
    PackJet r;
    for (int k = 0; k < size; ++k) r.c[k] = s * a.c[k];
    return r;
  }
  TRIPATCH_PACKED friend PackJet operator*(const PackJet& a, const PackJet& b) {
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

template <int N>
struct PackPoint {
  PackJet<N> x[3];
};

template <int N>
TRIPATCH_ANY_PACK PackJet<N> square(const PackJet<N>& a) {
  return a * a;
}

/// As of jet.h; taylor: N + 1 coefficients.
template <int N>
TRIPATCH_ANY_PACK PackJet<N> compose(const Pack* taylor, std::ptrdiff_t stride, const PackJet<N>& t) {
  PackJet<N> h = t;
  h.c[0] = Pack{};
  PackJet<N> r = taylor[N * stride] * h;
  for (int k = N - 1; k > 0; --k) {
    r.c[0] += taylor[k * stride];
    r = r * h;
  }
  r.c[0] += taylor[0];
  return r;
}

template <int N>
TRIPATCH_ANY_PACK PackJet<N> reciprocal(const PackJet<N>& a) {
  Pack f[N + 1];
  f[0] = 1.0 / a.c[0];
  for (int k = 1; k <= N; ++k) f[k] = -f[k - 1] * f[0];
  return compose<N>(f, 1, a);
}

/// Barycentric coordinates of points.
template <int N>
struct PackBarycentric {
  PackJet<N> b[3];

  /// Of so many; the last again where there are no more.
  TRIPATCH_ANY_PACK PackBarycentric(const double* all, Index count) {
    for (int i = 0; i < 3; ++i) {
      for (Index lane = 0; lane < lanes; ++lane) b[i].c[0][lane] = all[3 * std::min<Index>(lane, count - 1) + i];
      for (int k = 1; k < PackJet<N>::size; ++k) spread(k > 2 ? 0 : i == 2 ? -1 : i + 1 == k ? 1 : 0, b[i].c[k]);
    }
  }
  TRIPATCH_ANY_PACK const PackJet<N>& operator[](int i) const { return b[i]; }
};

template <int N, class P>
struct JetTypes {
  using OfNumber = PackJet<N>;
  using OfPoint = PackPoint<N>;
  using OfPlace = PackBarycentric<N>;
};
#else
template <int N, class P>
struct JetTypes;
#endif

template <int N>
struct JetTypes<N, double> {
  using OfNumber = Jet<N>;
  using OfPoint = JetPoint<N>;
  using OfPlace = Barycentric<N>;
};
/// Of one point or of several, by their number P.
template <int N, class P>
using JetOf = typename JetTypes<N, P>::OfNumber;
template <int N, class P>
using PointOf = typename JetTypes<N, P>::OfPoint;
template <int N, class P>
using PlaceOf = typename JetTypes<N, P>::OfPlace;

template <int N, class P>
TRIPATCH_ANY_PACK void add_product(const JetOf<N, P>& factor, const PointOf<N, P>& o, PointOf<N, P>& sum) {
  for (int x = 0; x < 3; ++x) sum.x[x] += factor * o.x[x];
}

/// f(s, t), as of jet.h: components of its Taylor coefficients.
template <int N, class P>
TRIPATCH_ANY_PACK PointOf<N, P> composed(const P (&taylor)[jet_size(N)][3], const JetOf<N, P>& s, const JetOf<N, P>& t) {
  JetOf<N, P> power[N > 0 ? jet_size(N) : 3];
  PointOf<N, P> r = {};
  for (int x = 0; x < 3; ++x) r.x[x].c[0] = taylor[0][x];
  if constexpr (N > 0) {
    power[1] = s;
    power[2] = t;
    power[1].c[0] = power[2].c[0] = P{};
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

/// The three rays through points: see ray_parameter.
template <int N, class P>
struct Rays {
  JetOf<N, P> s[3];     ///< fraction of the ray, 0 at the vertex
  JetOf<N, P> over[3];  ///< 1 / s
  JetOf<N, P> t[3];     ///< parameter of its side

  TRIPATCH_ANY_PACK explicit Rays(const PlaceOf<N, P>& b) {
    for (int i = 0; i < 3; ++i) {
      s[i] = b[(i + 1) % 3] + b[(i + 2) % 3];
      over[i] = reciprocal(s[i]);
      t[i] = b[(i + 2) % 3] * over[i];
    }
  }
};

/// Which vertex is nearest to each of several points, as side_weights sees it.
template <int N, class P>
class NearestVertex {
public:
  TRIPATCH_ANY_PACK explicit NearestVertex(const PlaceOf<N, P>& b)
      : not_0_(b[1].c[0] > b[0].c[0]), is_2_(b[2].c[0] > (not_0_ ? b[1].c[0] : b[0].c[0])) {}

  /// a[(i + vertex) % 3], or with Step = 2 a[(i - vertex) % 3].
  template <int Step = 1, class Jets>
  TRIPATCH_ANY_PACK JetOf<N, P> turned(const Jets& a, int i) const {
    JetOf<N, P> r;
    for (int k = 0; k < jet_size(N); ++k) {
      const P &at_0 = a[i].c[k], &at_1 = a[(i + Step) % 3].c[k], &at_2 = a[(i + 2 * Step) % 3].c[k];
      r.c[k] = is_2_ ? at_2 : not_0_ ? at_1 : at_0;
    }
    return r;
  }

private:
  decltype(P{} > P{}) not_0_, is_2_;
};

/// side_weights, Power = 2, and cubic_side_weights, 3.
template <int Power, int N, class P>
TRIPATCH_ANY_PACK void set_side_weights(const PlaceOf<N, P>& b, const Rays<N, P>& rays, JetOf<N, P> (&w)[3]) {
  using J = JetOf<N, P>;
  const NearestVertex<N, P> nearest(b);
  const J bi = nearest.turned(b, 0), bj = nearest.turned(b, 1), rho = nearest.turned(rays.s, 0);
  const J t = nearest.turned(rays.t, 0), s = bj * nearest.turned(rays.over, 0);
  J tt = square(t), ss = square(s), bb = square(bi), outer = square(rho);
  if constexpr (Power == 3) {
    tt = t * tt;
    ss = s * ss;
    bb = bi * bb;
    outer = rho * outer;
  }
  const J wi = outer * tt * ss, wj = bb * tt, wk = bb * ss, inverse = reciprocal(wi + wj + wk);
  const J of_nearest[3] = {wi * inverse, wj * inverse, wk * inverse};
  for (int i = 0; i < 3; ++i) w[i] = nearest.template turned<2>(of_nearest, i);
}

/// A field of three components whose Taylor series are made for one parameter or for four at a time.
class PackedField {
public:
  PackedField() = default;
  explicit PackedField(const PiecewisePolynomial& field) : degree_(field.degree()) {
    const std::vector<double>& breaks = field.breaks();
    const std::span<const double> given = field.coefficients();
    const Index n = field.pieces(), powers = n * (degree_ + 1), places = n == 1 ? 1 : 2 * n;
    coefficients_.assign(4 * powers, 0);
    for (Index k = 0; k < powers; ++k) std::copy_n(&given[3 * k], 3, &coefficients_[4 * k]);
    middles_.resize(n);
    ends_.resize(n);
    for (Index p = 0; p < n; ++p) {
      middles_[p] = 0.5 * (breaks[p] + breaks[p + 1]);
      ends_[p] = p + 1 < n ? breaks[p + 1] : std::numeric_limits<double>::infinity();
    }
    lookup_.resize(places);
    for (Index k = 0, p = 0; k < places; ++k) {
      // a little before: where a parameter is among the breaks and not its rounding tells its piece
      while (ends_[p] <= (1 - tolerance::fit) * static_cast<double>(k) / static_cast<double>(places)) ++p;
      lookup_[k] = static_cast<std::int32_t>(p);
    }
  }

  /// Whether parameters have the same places among the pieces of both.
  bool has_places_of(const PackedField& o) const { return middles_ == o.middles_ && ends_ == o.ends_; }

  /// Parameters among the pieces.
  template <class P>
  struct Places {
    P u;  ///< from the middle of the piece, where that is one
    struct {
      Index piece;
      double u;  ///< the same; side by side a register would wait for four stores
    } lane[width_of<P>];
    bool in_one_piece;
  };
  template <class P>
  TRIPATCH_ANY_PACK Places<P> places(const P& t) const {
    Places<P> out;
    Index first = 0;
    out.in_one_piece = true;
    if (middles_.size() > 1) {
      first = piece(number(t, 0));
      const double start = first > 0 ? ends_[first - 1] : -std::numeric_limits<double>::infinity(), end = ends_[first];
      for (int lane = 1; lane < width_of<P>; ++lane)
        out.in_one_piece &= static_cast<int>(number(t, lane) >= start) & static_cast<int>(number(t, lane) < end);
      for (int lane = 0; lane < width_of<P> && !out.in_one_piece; ++lane) {
        const Index p = piece(number(t, lane));
        out.lane[lane] = {p, number(t, lane) - middles_[p]};
      }
    }
    out.lane[0].piece = first;
    out.u = t - middles_[first];
    return out;
  }
  /// As PiecewisePolynomial::taylor. Inlined where a call would cost as much.
  template <int Order, class P>
  TRIPATCH_ANY_PACK void taylor(const Places<P>& at, P (&out)[Order + 1][3]) const {
    if constexpr (Order <= 1)
      series<Order>(at, out);
    else
      called_series<Order>(at, out);
  }

  /// At jets.
  template <int N, class P>
  TRIPATCH_ANY_PACK PointOf<N, P> at(const JetOf<N, P>& t) const {
    P taylor_of_t[N + 1][3];
    taylor<N>(places<P>(t.c[0]), taylor_of_t);
    PointOf<N, P> p;
    for (int x = 0; x < 3; ++x) p.x[x] = compose<N>(&taylor_of_t[0][x], 3, t);
    return p;
  }

#ifdef TRIPATCH_PACKS
  /// From points with their components to components of points.
  TRIPATCH_ANY_PACK static void turn(const Pack* p, Pack (&out)[3]) {
    const Pack xz = __builtin_shufflevector(p[0], p[1], 0, 4, 2, 6), y = __builtin_shufflevector(p[0], p[1], 1, 5, 3, 7);
    const Pack more_xz = __builtin_shufflevector(p[2], p[3], 0, 4, 2, 6),
               more_y = __builtin_shufflevector(p[2], p[3], 1, 5, 3, 7);
    out[0] = __builtin_shufflevector(xz, more_xz, 0, 1, 4, 5);
    out[1] = __builtin_shufflevector(y, more_y, 0, 1, 4, 5);
    out[2] = __builtin_shufflevector(xz, more_xz, 2, 3, 6, 7);
  }
#endif

private:
  template <int Order>
  void called_series(const Places<double>& at, double (&out)[Order + 1][3]) const {
    series<Order>(at, out);
  }
#ifdef TRIPATCH_PACKS
  template <int Order>
  TRIPATCH_PACKED void called_series(const Places<Pack>& at, Pack (&out)[Order + 1][3]) const {
    series<Order>(at, out);
  }
#endif

  TRIPATCH_ANY_PACK Index piece(double t) const {
    const double size = static_cast<double>(lookup_.size());
    double scaled = t * size;
    scaled = scaled > 0 ? scaled : 0;  // where it is no number too
    scaled = scaled < size - 1 ? scaled : size - 1;
    Index p = lookup_[static_cast<std::int32_t>(scaled)];
    p += t >= ends_[p];  // whether one break is passed is not known beforehand, another rarely is
    while (t >= ends_[p]) ++p;
    return p;
  }

  template <int Order, class P>
  TRIPATCH_ANY_PACK void series(const Places<P>& at, P (&out)[Order + 1][3]) const {
    const double* const first = &coefficients_[4 * (degree_ + 1) * at.lane[0].piece];
    if (at.in_one_piece) {
      const P u[3] = {at.u, at.u, at.u};
      return horner<Order>(u, [&](Index k, int x) TRIPATCH_ANY_PACK_LAMBDA { return first[4 * k + x]; }, out);
    }
#ifdef TRIPATCH_PACKS
    if constexpr (width_of<P> > 1) {
      const double* a[lanes];
      Pack u[lanes], points[Order + 1][lanes];  // the components of a point in a register
      for (int lane = 0; lane < lanes; ++lane) {
        a[lane] = &coefficients_[4 * (degree_ + 1) * at.lane[lane].piece];
        spread(at.lane[lane].u, u[lane]);
      }
      horner<Order>(
          u,
          [&](Index k, int lane) TRIPATCH_ANY_PACK_LAMBDA { return Pack(*reinterpret_cast<const LoosePack*>(a[lane] + 4 * k)); },
          points);
      for (int j = 0; j <= Order; ++j) turn(points[j], out[j]);
    }
#endif
  }

  /// coefficient(k, x): that of u^k in x, of all lanes or of each.
  template <int Order, class P, int Count, class Coefficient>
  TRIPATCH_ANY_PACK void horner(const P (&u)[Count], const Coefficient& coefficient, P (&out)[Order + 1][Count]) const {
    P sum[Order + 1][Count] = {};
    for (int x = 0; x < Count; ++x) sum[0][x] += coefficient(degree_, x);
    Index k = degree_ - 1;
    if constexpr (Order == 1)
      if (k >= 0) {  // the first step without what multiplies 0
        for (int x = 0; x < Count; ++x) {
          sum[1][x] = sum[0][x];
          sum[0][x] = sum[0][x] * u[x] + coefficient(k, x);
        }
        --k;
      }
    for (; k >= 0; --k)
      for (int x = 0; x < Count; ++x) {
        for (int j = Order; j > 0; --j) sum[j][x] = sum[j][x] * u[x] + sum[j - 1][x];
        sum[0][x] = sum[0][x] * u[x] + coefficient(k, x);
      }
    for (int j = 0; j <= Order; ++j)
      for (int x = 0; x < Count; ++x) out[j][x] = sum[j][x];
  }

private:
  int degree_ = 0;
  std::vector<double> middles_, ends_;  // of the pieces; the last ends nowhere
  std::vector<double> coefficients_;    // of each power four numbers, the last 0: whole registers are read
  std::vector<std::int32_t> lookup_;    // first candidate piece for floor(t * lookup size)
};

}  // namespace tripatch
