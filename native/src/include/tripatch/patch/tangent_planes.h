// Positions and first derivatives, which fills ask for most, of side-vertex patches and what a fairing adds to them: the products of weights
// and fields of rays written out. One formula for one point (P: double) and for several (Pack), so that the bits are the same.
#pragma once

#include "tripatch/patch/simd.h"

namespace tripatch {

constexpr int highest_written_out = 1;  ///< order of derivatives

/// A number and, with N = 1, its derivatives by b0 and b1.
template <int N, class P>
struct Plane {
  P c[jet_size(N)];
};
/// Position and derivatives of points, a component after the other.
template <int N, class P>
using TangentPlane = P[jet_size(N)][3];

/// Of b0, b1 and b2 by b0 and b1.
constexpr double barycentric_slopes[3][2] = {{1, 0}, {0, 1}, {-1, -1}};

/// Where points are on the rays from vertex i.
template <int N, class P>
struct OnRay {
  P b;            ///< 1 - s
  P s;            ///< fraction of the ray, 0 at the vertex; its slopes are those of b_i, turned over
  Plane<N, P> t;  ///< parameter of the side

  TRIPATCH_ANY_PACK OnRay(const P (&at)[3], int i) : b(at[i]), s(at[(i + 1) % 3] + at[(i + 2) % 3]) {
    const P over = 1.0 / s;
    t.c[0] = at[(i + 2) % 3] * over;
    if constexpr (N > 0)
      for (int k = 0; k < 2; ++k) t.c[1 + k] = (barycentric_slopes[(i + 2) % 3][k] + t.c[0] * barycentric_slopes[i][k]) * over;
  }
};

/// Side weights (b_j b_k)^Power over the sum of the three: see side_weights and cubic_side_weights. b is no vertex, so nothing underflows.
template <int Power, int N, class P>
TRIPATCH_ANY_PACK void weights_of_sides(const P (&b)[3], Plane<N, P> (&w)[3]) {
  P sum = {}, slopes[2] = {};
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const P product = b[j] * b[k];
    P lower = product;
    if constexpr (Power == 3) lower *= product;
    w[i].c[0] = lower * product;
    sum += w[i].c[0];
    if constexpr (N > 0) {
      lower *= static_cast<double>(Power);
      for (int d = 0; d < 2; ++d) {
        w[i].c[1 + d] = lower * (barycentric_slopes[j][d] * b[k] + barycentric_slopes[k][d] * b[j]);
        slopes[d] += w[i].c[1 + d];
      }
    }
  }
  const P inverse = 1.0 / sum;
  for (int i = 0; i < 3; ++i) {
    w[i].c[0] *= inverse;
    if constexpr (N > 0)
      for (int d = 0; d < 2; ++d) w[i].c[1 + d] = (w[i].c[1 + d] - w[i].c[0] * slopes[d]) * inverse;
  }
}

template <int N, class P>
TRIPATCH_ANY_PACK void set_zero(TangentPlane<N, P>& plane) {
  for (int k = 0; k < jet_size(N); ++k)
    for (int x = 0; x < 3; ++x) plane[k][x] = P{};
}

/// Adds a weight times a field of t.
template <int N, class P>
TRIPATCH_ANY_PACK void add_field(const Plane<N, P>& weight, const Plane<N, P>& t, const P (&field)[N + 1][3],
                                 TangentPlane<N, P>& sum) {
  for (int x = 0; x < 3; ++x) sum[0][x] += weight.c[0] * field[0][x];
  if constexpr (N > 0)
    for (int d = 1; d < 3; ++d) {
      const P along = weight.c[0] * t.c[d];
      for (int x = 0; x < 3; ++x) sum[d][x] += weight.c[d] * field[0][x] + along * field[1][x];
    }
}

/// A polynomial of degree 3 and its derivative at t, by its coefficients.
template <int N, class P>
TRIPATCH_ANY_PACK void cubic_at(const std::array<Vec3, 4>& a, const P& t, P (&out)[N + 1][3]) {
  for (int x = 0; x < 3; ++x) {
    const P high = a[2][x] + t * a[3][x];
    out[0][x] = a[0][x] + t * (a[1][x] + t * high);
    if constexpr (N > 0) out[1][x] = a[1][x] + t * (high + high + t * a[3][x]);
  }
}

/// A surface whose formula Derived has for one point and for several: written out as `plane`, and of jets
///   `template <int N, class P> PointOf<N, P> jets(const PlaceOf<N, P>& b) const;` (N above highest_written_out)
template <class Derived>
class PackedSurface : public JetSurface<Derived> {
public:
  static constexpr int highest_packed = 3;  ///< order that fairing asks for

  template <int N>
  JetPoint<N> at(const Barycentric<N>& b) const {
    return at<N, double>(b);
  }

private:
  template <int N, class P>
  TRIPATCH_ANY_PACK PointOf<N, P> at(const PlaceOf<N, P>& b) const {
    const Derived& derived = static_cast<const Derived&>(*this);
    if constexpr (N > highest_written_out) {
      return derived.template jets<N, P>(b);
    } else {
      const P at[3] = {b[0].c[0], b[1].c[0], b[2].c[0]};
      TangentPlane<N, P> plane;
      derived.template plane<N>(at, plane);
      PointOf<N, P> p;
      for (int k = 0; k < jet_size(N); ++k)
        for (int x = 0; x < 3; ++x) p.x[x].c[k] = plane[k][x];
      return p;
    }
  }

#ifdef TRIPATCH_PACKS
  void evaluate_regular(const double* b, Index n, int order, double* out) const override {
    if (!has_packs() || n < lanes || order < 0 || order > highest_packed)
      return JetSurface<Derived>::evaluate_regular(b, n, order, out);
    with_order<0, highest_packed>(order, [&](auto N) { run<N.value>(b, n, out); });
  }

  template <int N>
  TRIPATCH_PACKED void run(const double* b, Index n, double* out) const {
    constexpr int size = jet_size(N);
    for (Index first = 0; first < n; first += lanes, b += 3 * lanes, out += 3 * size * lanes) {
      const Index count = std::min<Index>(lanes, n - first);
      const PackPoint<N> p = at<N, Pack>(PackBarycentric<N>(b, count));
      for (Index lane = 0; lane < count; ++lane)
        for (int k = 0; k < size; ++k)
          for (int x = 0; x < 3; ++x) out[(lane * size + k) * 3 + x] = p.x[x].c[k][lane];
    }
  }
#endif
};

}  // namespace tripatch
