#include "tripatch/fairing/follow.h"

#include "tripatch/fairing/fairing_problem.h"
#include "tripatch/fairing/fairing_space.h"
#include "tripatch/math/linear.h"
#include "tripatch/math/tolerances.h"
#include "tripatch/patch/side_weights.h"

namespace tripatch {
SurfacePtr follow(const FairingBase& base, SurfacePoints points, const FairingOptions& options) {
  const Sides& sides = base.sides;
  const Boundary& boundary = base.boundary;
  const SurfacePtr& plain = base.patch;
  const int slopes = options.slopes;
  const Index inner = scalars(options.degree, options.second_cross), n = points.points.rows();
  const std::vector<PiecewisePolynomial> functions = slope_functions(slopes);
  // r and c' are of any length; a hole is as long as its size
  std::array<std::array<PiecewisePolynomial, 2>, 3> directions;
  std::array<std::array<double, 2>, 3> scale = {};
  for (int i = 0; i < 3; ++i) {
    if (!options.slopes_free[i] || sides[i].r.empty()) continue;
    directions[i] = {sides[i].r, sides[i].c.derivative()};
    for (int d = 0; d < 2; ++d) scale[i][d] = scale_to(boundary.size, directions[i][d]);
  }
  const auto added = [&](const Eigen::VectorXd& x, int i, int d) {
    return scale[i][d] * slope_function({&x[3 * inner + (2 * i + d) * slopes], static_cast<std::size_t>(slopes)});
  };
  const auto keeps_alpha = [&](const Eigen::VectorXd& x) {
    for (int i = 0; i < 3; ++i)
      if (scale[i][0] > 0 && !(alpha_reach(boundary.ribbons[i].alpha, added(x, i, 0)) >= 1)) return false;
    return x.allFinite();
  };

  SurfacePtr patch = plain;
  for (int round = 0; round < 2; ++round) {
    Points b = (points.barycentric.array() + tolerance::solved).matrix();  // at a vertex the terms are 0/0
    for (Index k = 0; k < n; ++k) b.row(k) /= b.row(k).sum();
    const Points missing = points.points - plain->positions(b);
    const Index unknowns = 3 * inner + 6 * slopes;
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(3 * n, unknowns);
    Eigen::VectorXd right(3 * n);
    for (Index k = 0; k < n; ++k) {
      const Barycentric<0> at(b.row(k).data());
      const std::vector<Jet<0>> basis = scalar_basis(at, options.degree, options.second_cross);
      const std::array<Jet<0>, 3> weights = side_weights(at);
      const Vec3 normal = points.normals.row(k);
      const Eigen::Matrix3d across =
          follow_along * Eigen::Matrix3d::Identity() + (1 - follow_along) * normal * normal.transpose();
      for (Index s = 0; s < inner; ++s) rows.block<3, 3>(3 * k, 3 * s) = boundary.size * basis[s].value() * across;
      for (int i = 0; i < 3; ++i) {
        const Jet<0> t = ray_parameter(at, i);
        const double kernel = slope_kernel(at, weights, i).value();
        for (int d = 0; d < 2; ++d) {
          if (scale[i][d] == 0) continue;
          const Vec3 direction = (kernel * scale[i][d]) * (across * directions[i][d](t.value()));
          for (int m = 0; m < slopes; ++m) {
            double f;
            functions[m].taylor(t.value(), 0, &f);
            rows.block<3, 1>(3 * k, 3 * inner + (2 * i + d) * slopes + m) = f * direction;
          }
        }
      }
      right.segment<3>(3 * k) = across * missing.row(k).transpose();
    }
    Eigen::VectorXd x = Eigen::VectorXd::Zero(unknowns);
    for (const Index m : {unknowns, 3 * inner}) {
      Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(m, m);
      normal.selfadjointView<Eigen::Lower>().rankUpdate(rows.leftCols(m).transpose());
      normal.diagonal().array() += tolerance::same * normal.trace() / static_cast<double>(m);
      x.setZero();
      x.head(m) = constrained_quadratic_minimum(normal, -rows.leftCols(m).transpose() * right, Eigen::MatrixXd(0, m));
      if (keeps_alpha(x)) break;
    }
    if (!x.allFinite()) return patch;
    std::array<PiecewisePolynomial, 3> changes;
    const std::array<double, 3> none = {0, 0, 0};
    for (int i = 0; i < 3; ++i)
      changes[i] = scale[i][0] == 0 && scale[i][1] == 0 ? PiecewisePolynomial::constant(none)
                                                        : added(x, i, 0) * directions[i][0] + added(x, i, 1) * directions[i][1];
    const Points coefficients = boundary.size * Eigen::Map<const Points>(x.data(), inner, 3);
    patch = sum(plain, tripatch::correction(changes, options.degree, options.second_cross, coefficients));
    if (round == 0) nearest(*patch, points.points, points.barycentric);
  }
  return patch;
}

}  // namespace tripatch
