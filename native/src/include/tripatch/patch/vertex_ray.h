// Rays from a vertex to the opposite side: the surfaces of which side-vertex patches and blends are made.
#pragma once

#include "tripatch/boundary/ribbon.h"
#include "tripatch/patch/surface.h"
#include "tripatch/patch/tangent_planes.h"

namespace tripatch {

enum class RayDegree {
  quadratic,  ///< position of the vertex, position and slope of the side
  cubic,      ///< also the tangent plane of the vertex, mixed linearly from its two side tangents (Nielson's D_i)
  quintic,    ///< also second derivatives at both ends, such that those of all three rays agree at the corners
};

/// The rays from vertex i to side i of a boundary: one constituent of a blend, with the side's position and slope.
class VertexRay final : public JetSurface<VertexRay> {
public:
  VertexRay(const Boundary& boundary, int i, RayDegree degree);

  /// Everywhere the vertex; elsewhere the ends of the side.
  Vec3 corner(int k) const override { return corner_[k]; }

  template <int N>
  JetPoint<N> at(const Barycentric<N>& b) const {
    switch (degree_) {
      case RayDegree::quadratic: return at<N, RayDegree::quadratic>(b);
      case RayDegree::cubic: return at<N, RayDegree::cubic>(b);
      default: return at<N, RayDegree::quintic>(b);
    }
  }

  /// Adds the ray at points, times a weight. Cubic and quintic rays only.
  template <int N, RayDegree Degree, class P>
  TRIPATCH_ANY_PACK void add_plane(const OnRay<N, P>& on, const Plane<N, P>& weight, TangentPlane<N, P>& sum) const {
    static_assert(Degree != RayDegree::quadratic);
    constexpr bool quintic = Degree == RayDegree::quintic;
    const P &s = on.s, &r = on.b, &t = on.t.c[0], ss = s * s, rr = r * r;
    // what multiplies slope and second derivative at the vertex, position, slope and second derivative at the side; and derivatives
    P h1, h2, h3, h4, h5, d1, d2, d3, d4, d5;
    if constexpr (quintic) {
      const P sss = ss * s, rrr = rr * r;
      h1 = s * rrr * (1.0 + 3.0 * s), h3 = sss * (1.0 + r * (3.0 + 6.0 * r)), h4 = sss * r * (-1.0 - 3.0 * r);
      h2 = 0.5 * ss * rrr, h5 = 0.5 * rr * sss;
      d1 = rr * (1.0 - 3.0 * s) * (1.0 + 5.0 * s), d3 = 30.0 * rr * ss, d4 = ss * (1.0 - 3.0 * r) * (1.0 + 5.0 * r);
      d2 = s * rr * (1.0 - 2.5 * s), d5 = r * ss * (2.5 * r - 1.0);
    } else {
      h1 = s * rr, h3 = ss * (1.0 + 2.0 * r), h4 = -ss * r;
      d1 = r * (1.0 - 3.0 * s), d3 = 6.0 * s * r, d4 = s * (1.0 - 3.0 * r);
    }
    P c[N + 1][3], d[N + 1][3], v[N + 1][3], q[N + 1][3];
    side_at<N>(t, c, d);
    if constexpr (quintic) cubic_at<N>(vertex_second_, t, v), cubic_at<N>(side_second_, t, q);
    P along_s[2], along_t[2];
    if constexpr (N > 0)
      for (int k = 0; k < 2; ++k) {
        along_s[k] = weight.c[0] * -barycentric_slopes[i_][k];
        along_t[k] = weight.c[0] * on.t.c[1 + k];
      }
    for (int x = 0; x < 3; ++x) {
      const double corner = corner_[i_][x], turned = to_previous_[x] - to_next_[x];
      const P slope = to_next_[x] + t * turned, off = c[0][x] - corner;
      P f = corner + h1 * slope + h3 * off + h4 * d[0][x];
      if constexpr (quintic) f += h2 * v[0][x] + h5 * q[0][x];
      sum[0][x] += weight.c[0] * f;
      if constexpr (N > 0) {
        P by_s = d1 * slope + d3 * off + d4 * d[0][x], by_t = h1 * turned + h3 * c[1][x] + h4 * d[1][x];
        if constexpr (quintic) by_s += d2 * v[0][x] + d5 * q[0][x], by_t += h2 * v[1][x] + h5 * q[1][x];
        for (int k = 0; k < 2; ++k) sum[1 + k][x] += weight.c[1 + k] * f + along_s[k] * by_s + along_t[k] * by_t;
      }
    }
  }

#ifdef TRIPATCH_PACKS
  /// The same of several points, from their places on the rays: fraction and parameter of the side.
  template <int N>
  TRIPATCH_PACKED PackPoint<N> at(const PackJet<N>& s, const PackJet<N>& t) const {
    return degree_ == RayDegree::quintic ? at<N, RayDegree::quintic>(s, t)
           : degree_ == RayDegree::cubic ? at<N, RayDegree::cubic>(s, t)
                                         : at<N, RayDegree::quadratic>(s, t);
  }
#endif

private:
  /// Curve and slope of the side.
  template <int N>
  void side_at(const double& t, double (&c)[N + 1][3], double (&slope)[N + 1][3]) const {
    c_.taylor(t, N, c[0]);
    slope_.taylor(t, N, slope[0]);
  }
#ifdef TRIPATCH_PACKS
  template <int N, class P>
    requires(width_of<P> > 1)
  TRIPATCH_ANY_PACK void side_at(const P& t, P (&c)[N + 1][3], P (&slope)[N + 1][3]) const {
    const PackedField::Places<P> places = packed_c_.places(t);
    packed_c_.taylor<N>(places, c);
    packed_slope_.taylor<N>(same_pieces_ ? places : packed_slope_.places(t), slope);
  }

  template <int N, RayDegree Degree>
  TRIPATCH_PACKED PackPoint<N> at(const PackJet<N>& s, const PackJet<N>& t) const {
    const Pack at = t.c[0];
    Pack field[N + 1][3], polar[jet_size(N)][3] = {};
    fill(field, corner_[i_]);
    add<N, Degree>(0, s.c[0], field, polar, 1);
    if constexpr (Degree != RayDegree::quadratic) {
      const Vec3 turned = to_previous_ - to_next_;
      for (int x = 0; x < 3; ++x) {
        field[0][x] = to_next_[x] + at * turned[x];
        field[1][x] = all_lanes(turned[x]);
      }
      add<N, Degree>(1, s.c[0], field, polar, 2);
    }
    if constexpr (Degree == RayDegree::quintic) {
      taylor<N>(vertex_second_, at, field);
      add<N, Degree>(2, s.c[0], field, polar);
    }
    const PackedField::Places<Pack> places = packed_c_.places(at);
    packed_c_.taylor<N>(places, field);
    add<N, Degree>(3, s.c[0], field, polar);
    packed_slope_.taylor<N>(same_pieces_ ? places : packed_slope_.places(at), field);
    add<N, Degree>(4, s.c[0], field, polar);
    if constexpr (Degree == RayDegree::quintic) {
      taylor<N>(side_second_, at, field);
      add<N, Degree>(5, s.c[0], field, polar);
    }
    return compose<N>(polar, s, t);
  }

  /// The vector in all lanes, without derivatives.
  template <std::size_t Orders, class P>
  TRIPATCH_ANY_PACK static void fill(P (&field)[Orders][3], const Vec3& v) {
    for (int x = 0; x < 3; ++x) field[0][x] = all_lanes_of<P>(v[x]);
  }

  /// `field` times the polynomial that carries it along the ray, as below.
  template <int N, RayDegree Degree, class P>
  TRIPATCH_ANY_PACK static void add(int f, const P& s, const P (&field)[N + 1][3], P (&polar)[jet_size(N)][3],
                                    int orders = N + 1) {
    P along[N + 1] = {};
    const std::array<double, 6>& a = hermites[static_cast<int>(Degree)][f];
    for (std::size_t k = coefficients<Degree>; k-- > 0;) {
      for (int j = N; j > 0; --j) along[j] = along[j] * s + along[j - 1];
      along[0] = along[0] * s + a[k];
    }
    for (int k = 0; k <= N; ++k)
      for (int l = 0; k + l <= N && l < orders; ++l)
        for (int x = 0; x < 3; ++x) polar[jet_index(k, l)][x] += along[k] * field[l][x];
  }

  template <int N, class P>
  TRIPATCH_ANY_PACK static void taylor(const std::array<Vec3, 4>& a, const P& at, P (&out)[N + 1][3]) {
    for (int x = 0; x < 3; ++x) {
      for (int j = 0; j <= N; ++j) out[j][x] = P{};
      for (std::size_t k = a.size(); k-- > 0;) {
        for (int j = N; j > 0; --j) out[j][x] = out[j][x] * at + out[j - 1][x];
        out[0][x] = out[0][x] * at + a[k][x];
      }
    }
  }
#endif

  /// Of the polynomials along a ray.
  template <RayDegree Degree>
  static constexpr std::size_t coefficients = Degree == RayDegree::quadratic ? 3
                                              : Degree == RayDegree::cubic   ? 4
                                                                             : 6;

  /// A polynomial in s and a field of t for each thing that is interpolated, so everything is done in (s, t) first.
  template <int N, RayDegree Degree>
  JetPoint<N> at(const Barycentric<N>& b) const {
    const Jet<N> s = b[(i_ + 1) % 3] + b[(i_ + 2) % 3];  // fraction of the ray, 0 at the vertex
    const Jet<N> t = ray_parameter(b, i_);
    using Field = std::array<Vec3, N + 1>;  // Taylor coefficients in t
    std::array<Vec3, Jet<N>::size> polar;
    polar.fill(Vec3::Zero());
    // `field` times the polynomial that carries it along the ray; `orders`: of its coefficients, how many are not zero
    const auto add = [&](int f, const Field& field, int orders = N + 1) {
      std::array<double, N + 1> along;
      taylor<N>(hermites[static_cast<int>(Degree)][f], s.value(), 0.0, along, coefficients<Degree>);
      for (int k = 0; k <= N; ++k)
        for (int l = 0; k + l <= N && l < orders; ++l) polar[jet_index(k, l)] += along[k] * field[l];
    };
    Field field;
    field[0] = corner_[i_];
    add(0, field, 1);
    if constexpr (Degree != RayDegree::quadratic) {
      field[0] = to_next_ + t.value() * (to_previous_ - to_next_);
      if constexpr (N > 0) field[1] = to_previous_ - to_next_;
      add(1, field, 2);
    }
    if constexpr (Degree == RayDegree::quintic) {
      taylor<N>(vertex_second_, t.value(), Vec3(Vec3::Zero()), field);
      add(2, field);
    }
    c_.taylor(t.value(), N, field[0].data());
    add(3, field);
    slope_.taylor(t.value(), N, field[0].data());
    add(4, field);
    if constexpr (Degree == RayDegree::quintic) {
      taylor<N>(side_second_, t.value(), Vec3(Vec3::Zero()), field);
      add(5, field);
    }
    return compose(polar, s, t);
  }

  /// Coefficients of 1, t, t^2, t^3.
  using Cubic = std::array<Vec3, 4>;
  /// By powers of s: what multiplies position, slope and second derivative at the vertex, then the same at the side.
  using Hermite = std::array<std::array<double, 6>, 6>;
  static constexpr std::array<Hermite, 3> hermites = {{
      {{{1, -2, 1}, {}, {}, {0, 2, -1}, {0, -1, 1}, {}}},
      {{{1, 0, -3, 2}, {0, 1, -2, 1}, {}, {0, 0, 3, -2}, {0, 0, -1, 1}, {}}},
      {{{1, 0, 0, -10, 15, -6},
        {0, 1, 0, -6, 8, -3},
        {0, 0, 0.5, -1.5, 1.5, -0.5},
        {0, 0, 0, 10, -15, 6},
        {0, 0, 0, -4, 7, -3},
        {0, 0, 0, 0.5, -1, 0.5}}},
  }};

  /// Taylor coefficients, to order N, of a polynomial about a place; count: of its coefficients, the others are 0.
  template <int N, class T, std::size_t Count>
  static void taylor(const std::array<T, Count>& a, double at, const T& zero, std::array<T, N + 1>& out,
                     std::size_t count = Count) {
    out.fill(zero);
    for (std::size_t k = count; k-- > 0;) {
      for (int j = N; j > 0; --j) out[j] = out[j] * at + out[j - 1];
      out[0] = out[0] * at + a[k];
    }
  }

  int i_;
  RayDegree degree_;
  PiecewisePolynomial c_, slope_;  ///< of the side: its curve and d/ds
  PackedField packed_c_, packed_slope_;
  bool same_pieces_;
  std::array<Vec3, 3> corner_;
  Vec3 to_next_, to_previous_;         ///< slopes of the rays along the two sides at the vertex, the inward part included
  Cubic vertex_second_, side_second_;  ///< quintic: second derivatives at the ends of the ray at t
};

}  // namespace tripatch
