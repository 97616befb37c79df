// Rays from a vertex to the opposite side: the surfaces of which side-vertex patches and blends are made.
#pragma once

#include "tripatch/boundary/ribbon.h"
#include "tripatch/patch/point_formula.h"
#include "tripatch/patch/ray_weights.h"
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
    return at(b[(i_ + 1) % 3] + b[(i_ + 2) % 3], ray_parameter(b, i_));
  }
  /// What a formula of points takes of it.
  PointTerms::Ray terms() const {
    PointTerms::Ray ray = {curve_, side_slope_, {}, corner_[i_], to_next_, to_previous_};
    if (degree_ != RayDegree::quintic) return ray;
    ray.is_quintic = true, ray.vertex_second = vertex_second_, ray.side_second = side_second_;
    return ray;
  }
  /// From the places on the rays: fraction, 0 at the vertex, and parameter of the side.
  template <int N>
  JetPoint<N> at(const Jet<N>& s, const Jet<N>& t) const {
    return by_degree<N, double>(s, t);
  }
#ifdef TRIPATCH_PACKS
  template <int N>
  TRIPATCH_PACKED PackPoint<N> at(const PackJet<N>& s, const PackJet<N>& t) const {
    return by_degree<N, Pack>(s, t);
  }
#endif

  /// Adds the ray at points, times a weight. Cubic and quintic rays only.
  template <int N, RayDegree Degree, class P>
  TRIPATCH_ANY_PACK void add_plane(const OnRay<N, P>& on, const Plane<N, P>& weight, TangentPlane<N, P>& sum) const {
    static_assert(Degree != RayDegree::quadratic);
    constexpr bool quintic = Degree == RayDegree::quintic;
    const P& t = on.t.c[0];
    RayWeights<P> w;
    weigh_ray<quintic>(on.b, on.s, w);
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
      P f = corner + w.h1 * slope + w.h3 * off + w.h4 * d[0][x];
      if constexpr (quintic) f += w.h2 * v[0][x] + w.h5 * q[0][x];
      sum[0][x] += weight.c[0] * f;
      if constexpr (N > 0) {
        P by_s = w.d1 * slope + w.d3 * off + w.d4 * d[0][x], by_t = w.h1 * turned + w.h3 * c[1][x] + w.h4 * d[1][x];
        if constexpr (quintic) by_s += w.d2 * v[0][x] + w.d5 * q[0][x], by_t += w.h2 * v[1][x] + w.h5 * q[1][x];
        for (int k = 0; k < 2; ++k) sum[1 + k][x] += weight.c[1 + k] * f + along_s[k] * by_s + along_t[k] * by_t;
      }
    }
  }

private:
  /// Curve and slope of the side.
  template <int N, class P>
  TRIPATCH_ANY_PACK void side_at(const P& t, P (&c)[N + 1][3], P (&slope)[N + 1][3]) const {
    const PackedField::Places<P> places = c_.places(t);
    c_.taylor<N>(places, c);
    slope_.taylor<N>(same_pieces_ ? places : slope_.places(t), slope);
  }

  template <int N, class P>
  TRIPATCH_ANY_PACK PointOf<N, P> by_degree(const JetOf<N, P>& s, const JetOf<N, P>& t) const {
    switch (degree_) {
      case RayDegree::quadratic: return formula<N, P, RayDegree::quadratic>(s, t);
      case RayDegree::cubic: return formula<N, P, RayDegree::cubic>(s, t);
      default: return formula<N, P, RayDegree::quintic>(s, t);
    }
  }

  /// A polynomial in s and a field of t for each thing that is interpolated, so everything is done in (s, t) first.
  template <int N, class P, RayDegree Degree>
  TRIPATCH_ANY_PACK PointOf<N, P> formula(const JetOf<N, P>& s, const JetOf<N, P>& t) const {
    const P& at = t.c[0];
    P field[N + 1][3], slope[N + 1][3], polar[jet_size(N)][3] = {};
    for (int x = 0; x < 3; ++x) spread(corner_[i_][x], field[0][x]);
    add<N, Degree>(0, s.c[0], field, polar, 1);
    if constexpr (Degree != RayDegree::quadratic) {
      for (int x = 0; x < 3; ++x) {
        const double turned = to_previous_[x] - to_next_[x];
        field[0][x] = to_next_[x] + at * turned;
        if constexpr (N > 0) spread(turned, field[1][x]);
      }
      add<N, Degree>(1, s.c[0], field, polar, 2);
    }
    if constexpr (Degree == RayDegree::quintic) {
      taylor<N>(vertex_second_, at, field);
      add<N, Degree>(2, s.c[0], field, polar);
    }
    side_at<N>(at, field, slope);
    add<N, Degree>(3, s.c[0], field, polar);
    add<N, Degree>(4, s.c[0], slope, polar);
    if constexpr (Degree == RayDegree::quintic) {
      taylor<N>(side_second_, at, field);
      add<N, Degree>(5, s.c[0], field, polar);
    }
    return composed<N, P>(polar, s, t);
  }

  /// `field` times the polynomial that carries it along the ray; orders: of its coefficients, how many are not zero.
  template <int N, RayDegree Degree, class P>
  TRIPATCH_ANY_PACK static void add(int f, const P& s, const P (&field)[N + 1][3], P (&polar)[jet_size(N)][3],
                                    int orders = N + 1) {
    P along[N + 1] = {};
    const std::array<double, 6>& a = hermites[static_cast<int>(Degree)][f];
    constexpr std::size_t coefficients = Degree == RayDegree::quadratic ? 3 : Degree == RayDegree::cubic ? 4 : 6;
    for (std::size_t k = coefficients; k-- > 0;) {
      for (int j = N; j > 0; --j) along[j] = along[j] * s + along[j - 1];
      along[0] = along[0] * s + a[k];
    }
    for (int k = 0; k <= N; ++k)
      for (int l = 0; k + l <= N && l < orders; ++l)
        for (int x = 0; x < 3; ++x) polar[jet_index(k, l)][x] += along[k] * field[l][x];
  }

  /// Taylor coefficients of a polynomial about a place.
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

  int i_;
  RayDegree degree_;
  PiecewisePolynomial curve_, side_slope_;  ///< of the side, and d/ds
  PackedField c_, slope_;                   ///< the same
  bool same_pieces_;
  std::array<Vec3, 3> corner_;
  Vec3 to_next_, to_previous_;         ///< slopes of the rays along the two sides at the vertex, the inward part included
  Cubic vertex_second_, side_second_;  ///< quintic: second derivatives at the ends of the ray at t
};

}  // namespace tripatch
