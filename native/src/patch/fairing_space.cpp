#include "tripatch/patch/fairing_space.h"

#include <Eigen/Dense>
#include <map>
#include <memory>
#include <mutex>

namespace tripatch {
namespace {

class Correction final : public JetSurface<Correction> {
public:
  Correction(std::array<PiecewisePolynomial, 3> slopes, int degree, int bends, Points coefficients)
      : slopes_(std::move(slopes)), degree_(degree), bends_(bends), coefficients_(std::move(coefficients)) {}

  Vec3 corner(int) const { return Vec3::Zero(); }

  template <int N>
  JetPoint<N> at(const Barycentric<N>& b) const {
    JetPoint<N> p;
    const std::array<Jet<N>, 3> w = side_weights(b);
    for (int i = 0; i < 3; ++i) p += slope_kernel(b, w, i) * compose(slopes_[i], ray_parameter(b, i));
    const std::vector<Jet<N>> basis = scalar_basis(b, degree_, bends_);
    for (std::size_t k = 0; k < basis.size(); ++k)
      for (int x = 0; x < 3; ++x) p.x[x] += basis[k] * coefficients_(k, x);
    return p;
  }

private:
  std::array<PiecewisePolynomial, 3> slopes_;
  int degree_, bends_;
  Points coefficients_;
};

}  // namespace

SurfacePtr correction(std::array<PiecewisePolynomial, 3> slopes, int degree, int bends, Points coefficients) {
  return std::make_shared<Correction>(std::move(slopes), degree, bends, std::move(coefficients));
}

PiecewisePolynomial slope_function(int count, int m) {
  std::vector<double> net(count, 0.0);
  net[m] = 1;
  return slope_function(net);
}

PiecewisePolynomial slope_function(std::span<const double> coefficients) {
  const std::array<double, 3> arch = {0, 2, 0};
  return PiecewisePolynomial::bezier(arch, 1) * PiecewisePolynomial::bezier(coefficients, 1);
}

FairingSpace::FairingSpace(int degree, int bends, int slopes, int nodes) : quadrature(corner_quadrature(nodes)) {
  const Index n = quadrature.b.rows(), count = scalars(degree, bends);
  std::vector<PiecewisePolynomial> functions;
  for (int m = 0; m < slopes; ++m) functions.push_back(slope_function(slopes, m));
  for (int m = 1; m <= 3; ++m) rows[m].resize((m + 1) * n, count);
  for (Index k = 0; k < n; ++k) {
    const Barycentric<3> b = cartesian_barycentric<3>(quadrature.b.row(k).data());
    const std::vector<Jet<3>> basis = scalar_basis(b, degree, bends);
    Basis all(9, count);
    for (Index c = 0; c < count; ++c) all.col(c) = derivatives_of(basis[c]);
    const double w = std::sqrt(quadrature.weights[k]);
    for (int m = 1; m <= 3; ++m)
      for (int d = 0; d <= m; ++d) rows[m].row((m + 1) * k + d) = w * factor(m, d) * all.row(first_of(m) + d);
    interior.push_back(std::move(all));
    const std::array<Jet<3>, 3> weights = side_weights(b);
    std::array<Jet<3>, 3> t;
    std::array<std::vector<Jet<3>>, 3> kernels;
    for (int i = 0; i < 3; ++i) {
      t[i] = ray_parameter(b, i);
      const Jet<3> kernel = slope_kernel(b, weights, i);
      for (const PiecewisePolynomial& f : functions) {
        std::array<double, 4> series;
        f.taylor(t[i].value(), 3, series.data());
        kernels[i].push_back(kernel * compose<3>(series.data(), 1, t[i]));
      }
    }
    parameter.push_back(t);
    slope.push_back(std::move(kernels));
  }
  // orthonormal in the third-derivative energy: Bernstein polynomials times the squared bubble are nearly dependent
  const Eigen::MatrixXd r =
      Eigen::HouseholderQR<Eigen::MatrixXd>(rows[3]).matrixQR().topRows(count).triangularView<Eigen::Upper>();
  combination = r.triangularView<Eigen::Upper>().solve(Eigen::MatrixXd::Identity(count, count));
  for (Basis& all : interior) all *= combination;
  for (int m = 1; m <= 3; ++m) {
    rows[m] *= combination;
    normal[m] = rows[m].transpose() * rows[m];
  }

  const std::array<double, 3> thirds = {1.0 / 3, 1.0 / 3, 1.0 / 3};
  const Barycentric<0> b(thirds.data());
  const std::vector<Jet<0>> basis = scalar_basis(b, degree, bends);
  middle.resize(count);
  for (Index c = 0; c < count; ++c) middle[c] = basis[c].value();
  middle *= combination;
  middle_slope.resize(slopes);
  for (int m = 0; m < slopes; ++m) functions[m].taylor(0.5, 0, &middle_slope[m]);
  middle_slope *= slope_kernel(b, side_weights(b), 0).value();

  side_slope.resize(side_points, slopes);
  for (int k = 0; k < side_points; ++k) {
    side_t.push_back(0.5 * (1 - std::cos(M_PI * (k + 0.5) / side_points)));
    side_sum += std::sin(M_PI * side_t[k]);
    for (int m = 0; m < slopes; ++m) functions[m].taylor(side_t[k], 0, &side_slope(k, m));
  }
  for (int i = 0; i < 3; ++i) {
    side_second[i].resize(side_points, count);
    for (int k = 0; k < side_points; ++k) {
      Barycentric<2> b;  // db0: the way along delta_i
      b[i] = Jet<2>::linear(0, 1, 0);
      b[(i + 1) % 3] = Jet<2>::linear(1 - side_t[k], -0.5, 0);
      b[(i + 2) % 3] = Jet<2>::linear(side_t[k], -0.5, 0);
      const std::vector<Jet<2>> basis = scalar_basis(b, degree, bends);
      for (Index c = 0; c < count; ++c) side_second[i](k, c) = 2 * basis[c].c[jet_index(2, 0)];
    }
    side_second[i] *= combination;
  }
}

const FairingSpace& fairing_space(int degree, int bends, int slopes, int nodes) {
  static std::mutex mutex;
  static std::map<std::array<int, 4>, std::unique_ptr<FairingSpace>> all;
  const std::lock_guard<std::mutex> lock(mutex);
  std::unique_ptr<FairingSpace>& one = all[{degree, bends, slopes, nodes}];
  if (!one) one = std::make_unique<FairingSpace>(degree, bends, slopes, nodes);
  return *one;
}

}  // namespace tripatch
