// What a fairing adds to a patch over a polygon, and its derivatives at the nodes of a quadrature.
#pragma once

#include <memory>
#include <vector>

#include "tripatch/fairing/energy_problem.h"
#include "tripatch/fairing/fairing_space.h"
#include "tripatch/polygon/surface.h"

namespace tripatch {

/// Nodes over the polygon, as corner_quadrature: two triangles to a corner, each a square collapsed there. All weights carry the corner
/// weight, the product over the corners of 1 - lambda_k (1 at the center of a regular polygon).
struct PolygonQuadrature {
  Points uv;
  std::vector<double> weights;
};
PolygonQuadrature polygon_quadrature(const PolygonDomain& domain, int nodes_per_direction);

/// Derivatives of a surface at points (u, v, -).
std::vector<Derivatives> plane_derivatives(const Surface& surface, const Points& uv);

inline Index polynomials_to(int degree) { return static_cast<Index>(degree + 1) * (degree + 2) / 2; }

/// Those that vanish at the sides with their slopes: the squared bubble times 1, x, y, ... by rising degree.
template <int N>
std::vector<Jet<N>> interior_functions(const PolygonDomain& domain, const Jet<N>& bubble, const Jet<N>& u, const Jet<N>& v,
                                       int degree) {
  const Jet<N> x = (1 / domain.radius()) * (u - domain.center()[0]), y = (1 / domain.radius()) * (v - domain.center()[1]);
  std::vector<Jet<N>> all;
  all.reserve(polynomials_to(degree));
  all.push_back(square(bubble));
  for (int d = 1; d <= degree; ++d) {
    const std::size_t last = all.size() - d;
    for (int k = 0; k < d; ++k) all.push_back(all[last + k] * x);
    all.push_back(all[last + d - 1] * y);
  }
  return all;
}

/// The second cross derivatives side by side, then the interior functions by rising degree: a space of lower degree comes first in one of
/// higher.
template <int N>
std::vector<Jet<N>> polygon_basis(const PolygonDomain& domain, const Place<N>& place, const Jet<N>& u, const Jet<N>& v,
                                  int degree, int second_cross) {
  std::vector<Jet<N>> basis;
  const int n = domain.sides();
  for (int i = 0; i < n; ++i) {
    const Jet<N> kernel = 0.5 * (square(place.phi[i]) * place.cubic[i]), &t = place.t[i], s = 1.0 - t;
    for (int m = 0; m < second_cross; ++m) {
      Jet<N> f = choose(second_cross - 1, m) * kernel;
      for (int k = 0; k < m; ++k) f *= t;
      for (int k = m + 1; k < second_cross; ++k) f *= s;
      basis.push_back(f);
    }
  }
  const std::vector<Jet<N>> inside = interior_functions(domain, place.bubble, u, v, degree);
  basis.insert(basis.end(), inside.begin(), inside.end());
  return basis;
}

struct PolygonSpace : NodeBasis {
  PolygonSpace(const PolygonDomain& domain, int degree, int second_cross, int slopes, int nodes);

  /// What adds to the slope along a side at a node: `kernel` times a direction at `t` times a slope function.
  struct Slope {
    Jet<3> kernel, t;
    std::vector<Jet<3>> functions;  ///< the slope functions at t
  };

  Points uv;
  std::vector<PiecewisePolynomial> slope_functions;
  SideBasis along;
  std::vector<Slope> slopes;  ///< node by node, side by side

private:
  PolygonSpace(const PolygonDomain& domain, PolygonQuadrature quadrature, int degree, int second_cross, int slopes);
};

/// The space of these numbers. The last few are kept: a fill that somebody shapes is made over the same domain again and again.
std::shared_ptr<const PolygonSpace> polygon_space(const PolygonDomain& domain, int degree, int second_cross, int slopes,
                                                  int nodes);

/// slopes: on each side what is added to the derivative along the inward normal; coefficients: of polygon_basis, one a row.
SurfacePtr polygon_correction(const PolygonDomain& domain, std::vector<PiecewisePolynomial> slopes, int degree, int second_cross,
                              const Points& coefficients);

}  // namespace tripatch
