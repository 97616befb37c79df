#include "tripatch/fairing/fairing_space.h"

#include <Eigen/Dense>
#include <map>
#include <memory>
#include <mutex>

#include "tripatch/patch/simd.h"

namespace tripatch {
namespace {

class Correction final : public PackedSurface<Correction> {
public:
  Correction(std::array<PiecewisePolynomial, 3> slopes, int degree, int second_cross, const Points& coefficients)
      : slopes_(std::move(slopes)), degree_(degree), inside_(coefficients.topRows(BezierTriangle::net_size(degree))) {
    for (int i = 0; i < 3; ++i) packed_slopes_[i] = PackedField(slopes_[i]);
    const std::vector<double> factor = multinomials(degree);
    for (Index k = 0; k < inside_.rows(); ++k) inside_.row(k) *= factor[k];
    if (second_cross == 0) return;
    for (int i = 0; i < 3; ++i) {
      const Points of_side = coefficients.middleRows(inside_.rows() + i * second_cross, second_cross);
      second_cross_[i] = PiecewisePolynomial::bezier({of_side.data(), static_cast<std::size_t>(of_side.size())}, 3);
      packed_second_cross_[i] = PackedField(second_cross_[i]);
    }
  }

  Vec3 corner(int) const { return Vec3::Zero(); }

  template <int N>
  JetPoint<N> at(const Barycentric<N>& b) const {
    JetPoint<N> p;
    for_monomials(b, degree_, [&](int k, const Jet<N>& f) {
      for (int x = 0; x < 3; ++x) p.x[x] += inside_(k, x) * f;
    });
    p = bubble(b) * p;
    const std::array<Jet<N>, 3> weights = side_weights(b), cubic_weights = cubic_side_weights(b);
    for (int i = 0; i < 3; ++i) {
      const Jet<N> t = ray_parameter(b, i);
      p += slope_kernel(b, weights, i) * compose(slopes_[i], t);
      if (!second_cross_[i].empty()) p += second_cross_kernel(b, cubic_weights, i) * compose(second_cross_[i], t);
    }
    return p;
  }

#ifdef TRIPATCH_PACKS
  template <int N>
  TRIPATCH_PACKED PackPoint<N> at(const PackBarycentric<N>& b) const {
    return whole(b);
  }
  template <int N>
  TRIPATCH_WIDE PackPoint<N, WidePack> at(const PackBarycentric<N, WidePack>& b) const {
    return whole(b);
  }
#endif

private:
#ifdef TRIPATCH_PACKS
  template <int N, class P>
  TRIPATCH_ANY_PACK PackPoint<N, P> whole(const PackBarycentric<N, P>& b) const {
    PackPoint<N, P> p = inside(b);
    const PackJet<N, P> over = square(27.0 * (b[0] * b[1] * b[2]));
    const PackRays<N, P> rays(b);
    PackJet<N, P> weights[3], cubic_weights[3];
    side_weights<2>(b, rays, weights);
    side_weights<3>(b, rays, cubic_weights);
    for (int x = 0; x < 3; ++x) p.x[x] = over * p.x[x];
    for (int i = 0; i < 3; ++i) {
      add(-1.0 * (weights[i] * (square(rays.s[i]) * b[i])), packed_slopes_[i].at(rays.t[i]), p);
      if (!second_cross_[i].empty()) add(0.5 * (square(b[i]) * cubic_weights[i]), packed_second_cross_[i].at(rays.t[i]), p);
    }
    return p;
  }

  template <int N, class P>
  TRIPATCH_ANY_PACK static void add(const PackJet<N, P>& kernel, const PackPoint<N, P>& field, PackPoint<N, P>& sum) {
    for (int x = 0; x < 3; ++x) sum.x[x] += kernel * field.x[x];
  }

  /// What the bubble multiplies.
  template <int N, class P>
  TRIPATCH_ANY_PACK PackPoint<N, P> inside(const PackBarycentric<N, P>& b) const {
    PackJet<N, P> power[3][highest_interior + 1];
    for (int i = 0; i < 3; ++i) {
      power[i][0] = {{all_lanes_of<P>(1)}};
      for (int k = 1; k <= degree_; ++k) power[i][k] = power[i][k - 1] * b[i];
    }
    PackPoint<N, P> p = {};
    const double* a = inside_.data();
    for (int i = degree_; i >= 0; --i)
      for (int j = degree_ - i; j >= 0; --j, a += 3) {
        const PackJet<N, P> f = power[0][i] * (power[1][j] * power[2][degree_ - i - j]);
        for (int x = 0; x < 3; ++x) p.x[x] += a[x] * f;
      }
    return p;
  }
#endif

  std::array<PiecewisePolynomial, 3> slopes_, second_cross_;  // second_cross_: empty where there are none
  std::array<PackedField, 3> packed_slopes_, packed_second_cross_;
  int degree_;
  Points inside_;  // by monomials of b
};

}  // namespace

SurfacePtr correction(std::array<PiecewisePolynomial, 3> slopes, int degree, int second_cross, const Points& coefficients) {
  return std::make_shared<Correction>(std::move(slopes), degree, second_cross, coefficients);
}

namespace {

NodeDerivatives scalar_derivatives(const Quadrature& quadrature, int degree, int second_cross) {
  NodeDerivatives all(quadrature.b.rows());
  for (Index k = 0; k < quadrature.b.rows(); ++k)
    all.add(scalar_basis(cartesian_barycentric<3>(quadrature.b.row(k).data()), degree, second_cross));
  return all;
}

/// Of the scalar functions, what is orthonormal in the third-derivative energy: Bernstein polynomials times the squared bubble are
/// nearly dependent. The same whatever the nodes.
Eigen::MatrixXd orthonormal(int degree, int second_cross) {
  const Quadrature quadrature = corner_quadrature(8);
  return orthonormal_functions(quadrature.weights, scalar_derivatives(quadrature, degree, second_cross));
}

}  // namespace

std::vector<PiecewisePolynomial> slope_functions(int count) {
  std::vector<PiecewisePolynomial> functions;
  for (int m = 0; m < count; ++m) {
    std::vector<double> net(count, 0.0);
    net[m] = 1;
    functions.push_back(slope_function(net));
  }
  return functions;
}

PiecewisePolynomial slope_function(std::span<const double> coefficients) {
  const std::array<double, 3> arch = {0, 2, 0};
  return PiecewisePolynomial::bezier(arch, 1) * PiecewisePolynomial::bezier(coefficients, 1);
}

FairingSpace::FairingSpace(int degree, int second_cross, int slopes, int nodes)
    : FairingSpace(corner_quadrature(nodes), degree, second_cross, slopes) {}

FairingSpace::FairingSpace(Quadrature nodes, int degree, int second_cross, int slopes)
    : NodeBasis(nodes.weights, scalar_derivatives(nodes, degree, second_cross), orthonormal(degree, second_cross)),
      quadrature(std::move(nodes)),
      along(slope_functions(slopes)) {
  const Index n = quadrature.b.rows(), count = scalars(degree, second_cross);
  const std::vector<PiecewisePolynomial> functions = slope_functions(slopes);
  for (Index k = 0; k < n; ++k) {
    const Barycentric<3> b = cartesian_barycentric<3>(quadrature.b.row(k).data());
    const std::array<Jet<3>, 3> of_sides = side_weights(b);
    std::array<Slope, 3> sides;
    for (int i = 0; i < 3; ++i) {
      const Jet<3> t = ray_parameter(b, i), kernel = slope_kernel(b, of_sides, i);
      sides[i].t = t.value();
      sides[i].rows.resize(4, 9 * slopes);
      for (int m = 0; m < slopes; ++m) {
        std::array<double, 4> series;
        functions[m].taylor(t.value(), 3, series.data());
        Jet<3> f = kernel * compose<3>(series.data(), 1, t);
        for (int p = 0; p < 4; ++p, f *= t - t.value())
          for (int d = 0; d < 9; ++d) sides[i].rows(p, d * slopes + m) = derivatives_of(f)[d];
      }
    }
    slope.push_back(std::move(sides));
  }
  const std::array<double, 3> thirds = {1.0 / 3, 1.0 / 3, 1.0 / 3};
  const Barycentric<0> b(thirds.data());
  const std::vector<Jet<0>> basis = scalar_basis(b, degree, second_cross);
  center.resize(count);
  for (Index c = 0; c < count; ++c) center[c] = basis[c].value();
  center *= combination;
  center_slope.resize(slopes);
  for (int m = 0; m < slopes; ++m) functions[m].taylor(0.5, 0, &center_slope[m]);
  center_slope *= slope_kernel(b, side_weights(b), 0).value();

  for (int i = 0; i < 3; ++i) {
    Eigen::MatrixXd second(SideBasis::points, count);
    for (int k = 0; k < SideBasis::points; ++k) {
      Barycentric<2> b;  // db0: the way along delta_i
      b[i] = Jet<2>::linear(0, 1, 0);
      b[(i + 1) % 3] = Jet<2>::linear(1 - along.t[k], -0.5, 0);
      b[(i + 2) % 3] = Jet<2>::linear(along.t[k], -0.5, 0);
      const std::vector<Jet<2>> basis = scalar_basis(b, degree, second_cross);
      for (Index c = 0; c < count; ++c) second(k, c) = 2 * basis[c].c[jet_index(2, 0)];
    }
    along.second.push_back(second * combination);
  }
}

const FairingSpace& fairing_space(int degree, int second_cross, int slopes, int nodes) {
  static std::mutex mutex;
  static std::map<std::array<int, 4>, std::unique_ptr<FairingSpace>> all;
  const std::lock_guard<std::mutex> lock(mutex);
  std::unique_ptr<FairingSpace>& one = all[{degree, second_cross, slopes, nodes}];
  if (!one) one = std::make_unique<FairingSpace>(degree, second_cross, slopes, nodes);
  return *one;
}

}  // namespace tripatch
