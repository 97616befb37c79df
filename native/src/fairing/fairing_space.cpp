#include "tripatch/fairing/fairing_space.h"

#include <Eigen/Dense>
#include <map>
#include <memory>
#include <mutex>

#include "tripatch/math/thresholds.h"
#include "tripatch/patch/point_formula.h"
#include "tripatch/patch/tangent_planes.h"

namespace tripatch {
namespace {

constexpr double one_third = share::third;

/// From Bernstein coefficients to those of (b0 - 1/3)^i (b1 - 1/3)^j, highest i first and of each highest j first.
Points about_middle(const Points& net, int degree) {
  const std::array<Vec3, 3> linear = {Vec3(one_third, 1, 0), Vec3(one_third, 0, 1), Vec3(one_third, -1, -1)};  // of 1, u and v
  const std::vector<double> factor = multinomials(degree);
  using Table = std::array<std::array<double, highest_interior + 1>, highest_interior + 1>;  // by powers of u and v
  std::array<Table, 3> sum = {};
  const auto times = [degree](const Table& f, const Vec3& by) {
    Table product = {};
    for (int i = 0; i <= degree; ++i)
      for (int j = 0; i + j <= degree; ++j)
        product[i][j] = by[0] * f[i][j] + (i > 0 ? by[1] * f[i - 1][j] : 0) + (j > 0 ? by[2] * f[i][j - 1] : 0);
    return product;
  };
  Table first = {};
  first[0][0] = 1;
  Index row = 0;
  for (int i = degree; i >= 0; --i)
    for (int j = degree - i; j >= 0; --j, ++row) {
      Table f = first;
      for (int n = 0; n < degree; ++n) f = times(f, linear[n < i ? 0 : n < i + j ? 1 : 2]);
      for (int x = 0; x < 3; ++x)
        for (int p = 0; p <= degree; ++p)
          for (int q = 0; p + q <= degree; ++q) sum[x][p][q] += factor[row] * net(row, x) * f[p][q];
    }
  Points out(net.rows(), 3);
  row = 0;
  for (int p = degree; p >= 0; --p)
    for (int q = degree - p; q >= 0; --q, ++row) out.row(row) << sum[0][p][q], sum[1][p][q], sum[2][p][q];
  return out;
}

class Correction final : public PackedSurface<Correction>, public FormulaSurface {
public:
  Correction(const std::array<PiecewisePolynomial, 3>& slopes, int degree, int second_cross, const Points& coefficients)
      : degree_(degree),
        bends_(second_cross > 0),
        inside_(about_middle(coefficients.topRows(BezierTriangle::net_size(degree)), degree)) {
    terms_.inside = inside_;
    for (int i = 0; i < 3; ++i) {
      terms_.rays[i].added = slopes[i];  // slope_kernel is that of a cubic ray
      slopes_[i] = PackedField(slopes[i]);
      if (!bends_) continue;
      const Points of_side = coefficients.middleRows(inside_.rows() + i * second_cross, second_cross);
      terms_.second_cross[i] = PiecewisePolynomial::bezier({of_side.data(), static_cast<std::size_t>(of_side.size())}, 3);
      second_cross_[i] = PackedField(terms_.second_cross[i]);
    }
  }

  Vec3 corner(int) const override { return Vec3::Zero(); }
  const PointFormula* formula() const override { return &formula_; }

  template <int N, class P>
  TRIPATCH_ANY_PACK void plane(const P (&b)[3], TangentPlane<N, P>& sum) const {
    inside<N>(b[0], b[1], sum);
    const P g = 27 * (b[0] * b[1] * b[2]), over = g * g;
    if constexpr (N > 0)
      for (int d = 0; d < 2; ++d) {
        const auto& slope = barycentric_slopes;
        const P of_g = slope[0][d] * (b[1] * b[2]) + slope[1][d] * (b[2] * b[0]) + slope[2][d] * (b[0] * b[1]);
        const P of_over = 54 * (g * of_g);
        for (int x = 0; x < 3; ++x) sum[1 + d][x] = over * sum[1 + d][x] + of_over * sum[0][x];
      }
    for (int x = 0; x < 3; ++x) sum[0][x] *= over;
    Plane<N, P> weights[3], cubic_weights[3];
    weights_of_sides<2>(b, weights);
    weights_of_sides<3>(b, cubic_weights);
    for (int i = 0; i < 3; ++i) {
      const OnRay<N, P> on(b, i);
      P field[N + 1][3];
      slopes_[i].taylor<N>(slopes_[i].places(on.t.c[0]), field);
      Plane<N, P> kernel;  // slope_kernel
      const P s_b = on.s * on.b;
      kernel.c[0] = -(weights[i].c[0] * on.s * s_b);
      if constexpr (N > 0)
        for (int d = 0; d < 2; ++d)
          kernel.c[1 + d] =
              -(weights[i].c[1 + d] * on.s * s_b) - barycentric_slopes[i][d] * (weights[i].c[0] * (on.s * on.s - 2.0 * s_b));
      add_field<N>(kernel, on.t, field, sum);
      if (!bends_) continue;
      second_cross_[i].taylor<N>(second_cross_[i].places(on.t.c[0]), field);
      const P half = 0.5 * on.b;  // second_cross_kernel
      kernel.c[0] = half * on.b * cubic_weights[i].c[0];
      if constexpr (N > 0)
        for (int d = 0; d < 2; ++d)
          kernel.c[1 + d] = half * on.b * cubic_weights[i].c[1 + d] + barycentric_slopes[i][d] * (on.b * cubic_weights[i].c[0]);
      add_field<N>(kernel, on.t, field, sum);
    }
  }

  template <int N, class P>
  TRIPATCH_ANY_PACK PointOf<N, P> jets(const PlaceOf<N, P>& b) const {
    P inner[jet_size(N)][3];
    inside<N>(b[0].c[0], b[1].c[0], inner);
    PointOf<N, P> p;
    for (int k = 0; k < jet_size(N); ++k)
      for (int x = 0; x < 3; ++x) p.x[x].c[k] = inner[k][x];
    const JetOf<N, P> over = square(27 * (b[0] * b[1] * b[2]));
    const Rays<N, P> rays(b);
    JetOf<N, P> weights[3], cubic_weights[3];
    set_side_weights<2>(b, rays, weights);
    set_side_weights<3>(b, rays, cubic_weights);
    for (int x = 0; x < 3; ++x) p.x[x] = over * p.x[x];
    for (int i = 0; i < 3; ++i) {
      add_product<N, P>(-1.0 * (weights[i] * (square(rays.s[i]) * b[i])), slopes_[i].at<N, P>(rays.t[i]), p);
      if (bends_) add_product<N, P>(0.5 * (square(b[i]) * cubic_weights[i]), second_cross_[i].at<N, P>(rays.t[i]), p);
    }
    return p;
  }

private:
  /// What the bubble multiplies: its Taylor coefficients.
  template <int N, class P>
  TRIPATCH_ANY_PACK void inside(const P& b0, const P& b1, P (&out)[jet_size(N)][3]) const {
    const P u = b0 - one_third, v = b1 - one_third;
    set_zero<N>(out);
    const double* a = inside_.data();
    for (int i = 0; i <= degree_; ++i) {
      P row[N + 1][3] = {};  // the polynomial of v that multiplies a power of u
      for (int j = 0; j <= i; ++j, a += 3)
        for (int x = 0; x < 3; ++x) {
          for (int l = N; l > 0; --l) row[l][x] = row[l][x] * v + row[l - 1][x];
          row[0][x] = row[0][x] * v + a[x];
        }
      for (int x = 0; x < 3; ++x)
        for (int k = N; k >= 0; --k)
          for (int l = 0; k + l <= N; ++l) {
            P& sum = out[jet_index(k, l)][x];
            sum = sum * u + (k > 0 ? out[jet_index(k - 1, l)][x] : row[l][x]);
          }
    }
  }

  std::array<PackedField, 3> slopes_, second_cross_;
  int degree_;
  bool bends_;     // across the sides, by second_cross_
  Points inside_;  // as about_middle
  PointTerms terms_;
  PointFormula formula_{[this] { return terms_; }};
};

}  // namespace

SurfacePtr correction(const std::array<PiecewisePolynomial, 3>& slopes, int degree, int second_cross,
                      const Points& coefficients) {
  return std::make_shared<Correction>(slopes, degree, second_cross, coefficients);
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
