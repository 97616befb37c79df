// Surfaces over a polygon: rows of Surface::evaluate are (u, v, not read), derivatives are by (u, v).
#pragma once

#include <algorithm>
#include <vector>

#include "tripatch/patch/surface.h"
#include "tripatch/polygon/boundary.h"
#include "tripatch/polygon/domain.h"

namespace tripatch {

/// A surface with the polygon that it is over.
class PolygonSurface : public Surface {
public:
  explicit PolygonSurface(PolygonDomain domain) : domain_(std::move(domain)) {}
  const PolygonDomain& domain() const { return domain_; }

private:
  PolygonDomain domain_;
};

/// A surface made of parts, with the polygon that all of them are over.
class OverPolygon final : public PolygonSurface {
public:
  OverPolygon(PolygonDomain domain, SurfacePtr surface) : PolygonSurface(std::move(domain)), surface_(std::move(surface)) {}
  void evaluate(const double* b, Index n, int order, double* out) const override { surface_->evaluate(b, n, order, out); }

private:
  SurfacePtr surface_;
};

/// As VertexSafeSurface, over a polygon: where side weights are 0/0 and lose digits (next to corners), derivatives of order m are those a
/// little farther off on the same ray. Derived: `template <int N> JetPoint<N> at(const Jet<N>& u, const Jet<N>& v) const`, and
/// `Vec3 corner(int i) const`.
template <class Derived>
class CornerSafeSurface : public PolygonSurface {
public:
  using PolygonSurface::PolygonSurface;

  void evaluate(const double* b, Index n, int order, double* out) const final {
    with_order<0, max_order>(order, [&](auto constant) { this->run<constant.value>(b, n, out); });
  }

private:
  template <int N>
  void run(const double* b, Index n, double* out) const {
    const Derived& self = *static_cast<const Derived*>(this);
    constexpr Index row = 3 * jet_size(N);
    for (Index k = 0; k < n; ++k) {
      const Vec2 p(b[3 * k], b[3 * k + 1]);
      const int near = domain().corner_at(p, VertexSafeSurface::vertex_radius[N]);
      if (near < 0) {
        store(self.template at<N>(Jet<N>::linear(p[0], 1, 0), Jet<N>::linear(p[1], 0, 1)), out + k * row);
        continue;
      }
      for (int m = 0; m <= N; ++m) {
        const double share = VertexSafeSurface::vertex_radius[m];
        const Vec2 q = domain().corner_at(p, share) >= 0 ? domain().moved_off(near, p, share) : p;
        std::array<double, row> series;
        store(self.template at<N>(Jet<N>::linear(q[0], 1, 0), Jet<N>::linear(q[1], 0, 1)), series.data());
        const Index from = m == 0 ? 0 : 3 * jet_size(m - 1), to = 3 * jet_size(m);
        std::copy(series.begin() + from, series.begin() + to, out + k * row + from);
      }
      if (domain().corner_at(p, VertexSafeSurface::vertex_radius[0]) >= 0)
        std::copy_n(self.corner(near).data(), 3, out + k * row);
    }
  }
};

/// The patch with the ribbons of a boundary: Charrot and Gregory's blend of what two neighboring sides give at each corner ("A
/// pentagonal surface patch for computer aided geometric design", 1984), over Wachspress's coordinates. It is smooth up to the corners
/// where the two sides agree there; what they do not agree on is carried by the rational side weights, so that position and tangent plane
/// are met along all sides in any case.
SurfacePtr corner_blend(const PolygonBoundary& boundary);

/// Points (u, v, 0) all over the polygon: its center, and `rings` rings of `rings` to `n rings` points about it up to the border.
Points polygon_grid(const PolygonDomain& domain, int rings, std::vector<std::array<Index, 2>>* edges = nullptr);

}  // namespace tripatch
