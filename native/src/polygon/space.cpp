#include "tripatch/polygon/space.h"

#include <cmath>

#include "tripatch/math/lru_cache.h"
#include "tripatch/math/quadrature.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/patch/side_weights.h"

namespace tripatch {
namespace {

/// Nodes of the quadrature in which functions are made orthonormal: the same for problems of few and of many nodes.
constexpr int orthonormal_nodes = count::half_dozen;

class Correction final : public CornerSafeSurface<Correction> {
public:
  Correction(const PolygonDomain& domain, std::vector<PiecewisePolynomial> slopes, int degree, int second_cross,
             const Points& coefficients)
      : CornerSafeSurface(domain), slopes_(std::move(slopes)), degree_(degree) {
    const int n = domain.sides();
    second_cross_.resize(n);
    for (int i = 0; i < n && second_cross > 0; ++i) {
      const Points own = coefficients.middleRows(static_cast<Index>(i) * second_cross, second_cross);
      second_cross_[i] = PiecewisePolynomial::bezier({own.data(), static_cast<std::size_t>(own.size())}, 3);
    }
    inside_ = coefficients.bottomRows(polynomials_to(degree));
  }

  Vec3 corner(int) const { return Vec3::Zero(); }

  template <int N>
  JetPoint<N> at(const Jet<N>& u, const Jet<N>& v) const {
    const PolygonDomain& d = domain();
    const Place<N> place = d.place(u, v);
    JetPoint<N> p;
    const std::vector<Jet<N>> basis = polygon_basis<N>(d, place, u, v, degree_, 0);
    for (std::size_t k = 0; k < basis.size(); ++k)
      for (int x = 0; x < 3; ++x) p.x[x] += inside_(static_cast<Index>(k), x) * basis[k];
    for (int i = 0; i < d.sides(); ++i) {
      if (!slopes_[i].empty()) p += (place.phi[i] * place.side[i]) * compose(slopes_[i], place.t[i]);
      if (!second_cross_[i].empty()) p += (0.5 * (square(place.phi[i]) * place.cubic[i])) * compose(second_cross_[i], place.t[i]);
    }
    return p;
  }

private:
  std::vector<PiecewisePolynomial> slopes_, second_cross_;  // empty: none
  int degree_;
  Points inside_;
};

NodeDerivatives polygon_derivatives(const PolygonDomain& domain, const Points& uv, int degree, int second_cross) {
  NodeDerivatives all(uv.rows());
  for (Index k = 0; k < uv.rows(); ++k) {
    const Jet<3> u = Jet<3>::linear(uv(k, 0), 1, 0), v = Jet<3>::linear(uv(k, 1), 0, 1);
    all.add(polygon_basis<3>(domain, domain.place(u, v), u, v, degree, second_cross));
  }
  return all;
}

Eigen::MatrixXd orthonormal(const PolygonDomain& domain, int degree, int second_cross) {
  const PolygonQuadrature quadrature = polygon_quadrature(domain, orthonormal_nodes);
  return orthonormal_functions(quadrature.weights, polygon_derivatives(domain, quadrature.uv, degree, second_cross));
}

/// Along the lens and across it, denser than over a triangle: there are but two corners.
PolygonQuadrature lens_quadrature(const PolygonDomain& domain, int nodes) {
  const auto [x, w] = gauss(2 * nodes);
  const Index n = static_cast<Index>(x.size());
  PolygonQuadrature result;
  result.uv = Points::Zero(n * n, 3);
  for (Index a = 0; a < n; ++a)
    for (Index c = 0; c < n; ++c) {
      const double s = x[a], high = 4 * domain.height() * s * (1 - s);
      result.uv.row(n * a + c).head<2>() = Vec2(domain.radius() * (2 * s - 1), high * (2 * x[c] - 1));
      result.weights.push_back(w[a] * w[c] * 2 * domain.radius() * 2 * high * 4 * s * (1 - s));
    }
  return result;
}

}  // namespace

PolygonQuadrature polygon_quadrature(const PolygonDomain& domain, int nodes) {
  if (domain.is_lens()) return lens_quadrature(domain, nodes);
  const auto [x, w] = gauss(nodes);
  const int n = domain.sides();
  PolygonQuadrature result;
  result.uv = Points::Zero(static_cast<Index>(2) * n * nodes * nodes, 3);
  Index row = 0;
  for (int i = 0; i < n; ++i)
    for (int half = 0; half < 2; ++half) {
      const Vec2 corner = domain.corner(i), to = domain.on_side(half ? i - 1 : i, 0.5) - corner, inner = domain.center() - corner;
      const double twice = std::abs(to[0] * inner[1] - to[1] * inner[0]);
      for (int a = 0; a < nodes; ++a)
        for (int c = 0; c < nodes; ++c) {
          const Vec2 p = corner + x[a] * ((1 - x[c]) * to + x[c] * inner);
          const Place<0> place = domain.place(Jet<0>(p[0]), Jet<0>(p[1]));
          double sum = 0, corner_weight = 1;
          for (int k = 0; k < n; ++k) sum += std::sqrt(place.corner[k].value());
          for (int k = 0; k < n; ++k) corner_weight *= (1 - std::sqrt(place.corner[k].value()) / sum) * n / (n - 1.0);
          result.uv.row(row++).head<2>() = p;
          result.weights.push_back(w[a] * w[c] * x[a] * twice * corner_weight);
        }
    }
  return result;
}

std::vector<Derivatives> plane_derivatives(const Surface& surface, const Points& uv) {
  Eigen::Matrix<double, Eigen::Dynamic, 30, Eigen::RowMajor> jets(uv.rows(), 30);
  surface.evaluate(uv.data(), uv.rows(), 3, jets.data());
  std::vector<Derivatives> out(uv.rows());
  const std::array<double, 9> factor = {1, 1, 2, 1, 2, 6, 2, 2, 6};
  for (Index k = 0; k < uv.rows(); ++k) {
    out[k] = Eigen::Map<const Derivatives>(jets.row(k).data() + 3);
    for (int d = 0; d < 9; ++d) out[k].row(d) *= factor[d];
  }
  return out;
}

PolygonSpace::PolygonSpace(const PolygonDomain& domain, int degree, int second_cross, int slopes, int nodes)
    : PolygonSpace(domain, polygon_quadrature(domain, nodes), degree, second_cross, slopes) {}

PolygonSpace::PolygonSpace(const PolygonDomain& domain, PolygonQuadrature quadrature, int degree, int second_cross, int slopes)
    : NodeBasis(std::move(quadrature.weights), polygon_derivatives(domain, quadrature.uv, degree, second_cross),
                orthonormal(domain, degree, second_cross)),
      uv(std::move(quadrature.uv)),
      slope_functions(tripatch::slope_functions(slopes)),
      along(slope_functions) {
  for (Index k = 0; k < uv.rows(); ++k) {
    const Place<3> place = domain.place(Jet<3>::linear(uv(k, 0), 1, 0), Jet<3>::linear(uv(k, 1), 0, 1));
    for (int i = 0; i < domain.sides(); ++i) {
      Slope slope{place.phi[i] * place.side[i], place.t[i], {}};
      for (const PiecewisePolynomial& function : slope_functions) {
        std::array<double, 4> series;
        function.taylor(slope.t.value(), 3, series.data());
        slope.functions.push_back(compose<3>(series.data(), 1, slope.t));
      }
      this->slopes.push_back(std::move(slope));
    }
  }
  const Index count = combination.cols();
  for (int i = 0; i < domain.sides(); ++i) {
    Eigen::MatrixXd second(SideBasis::points, count);
    for (int k = 0; k < SideBasis::points; ++k) {
      const Vec2 p = domain.on_side(i, along.t[k]), nu = domain.inward(i);
      const Jet<2> u = Jet<2>::linear(p[0], nu[0], 0), v = Jet<2>::linear(p[1], nu[1], 0);
      const std::vector<Jet<2>> basis = polygon_basis<2>(domain, domain.place(u, v), u, v, degree, second_cross);
      for (Index c = 0; c < count; ++c) second(k, c) = 2 * basis[c].c[jet_index(2, 0)];
    }
    along.second.push_back(second * combination);
  }
}

std::shared_ptr<const PolygonSpace> polygon_space(const PolygonDomain& domain, int degree, int second_cross, int slopes,
                                                  int nodes) {
  static LruCache<PolygonSpace> last;
  Key key;
  for (int number : {degree, second_cross, slopes, nodes}) key.add(number);
  key.add(domain.height());
  for (int i = 0; i < domain.sides(); ++i) key.add(domain.corner(i));
  if (auto kept = last.find(key)) return kept;
  return last.keep(std::move(key), std::make_shared<const PolygonSpace>(domain, degree, second_cross, slopes, nodes));
}

SurfacePtr polygon_correction(const PolygonDomain& domain, std::vector<PiecewisePolynomial> slopes, int degree, int second_cross,
                              const Points& coefficients) {
  return std::make_shared<Correction>(domain, std::move(slopes), degree, second_cross, coefficients);
}

}  // namespace tripatch
