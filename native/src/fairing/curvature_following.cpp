#include "tripatch/fairing/curvature_following.h"

#include <cmath>
#include <numbers>

#include "tripatch/fairing/curvature_variation.h"
#include "tripatch/math/thresholds.h"

namespace tripatch {
namespace {

/// Points count like sin(pi t), so that the corners, where the sides' own data meet, do not decide, but not less than this there.
constexpr double weight_at_corners = share::little;

}  // namespace

SideBasis::SideBasis(std::span<const PiecewisePolynomial> slopes) : slope(points, static_cast<Index>(slopes.size())) {
  for (int k = 0; k < points; ++k) {
    t.push_back(0.5 * (1 - std::cos(std::numbers::pi * (k + 0.5) / points)));
    for (std::size_t m = 0; m < slopes.size(); ++m) slopes[m].taylor(t[k], 0, &slope(k, static_cast<Index>(m)));
  }
}

FollowedSide followed_side(const Side& side, int i, const PiecewisePolynomial& alpha, const PiecewisePolynomial& beta,
                           const std::vector<double>& t, const std::vector<Across>& across) {
  FollowedSide followed;
  followed.i = i;
  followed.curvature_error = side.curvature_error;
  for (int k = 0; k < SideBasis::points; ++k) {
    const SideForm form = side_form(side, t[k]);
    followed.form[k] = form;
    alpha.taylor(t[k], 0, &followed.alpha[k]);
    beta.taylor(t[k], 0, &followed.beta[k]);
    followed.base[k] = form.n.dot(across[k].second);
    followed.weight[k] = 1 / form.across(followed.alpha[k] * form.r);
  }
  return followed;
}

CurvatureFollowing::CurvatureFollowing(const SideBasis& basis, std::vector<FollowedSide> sides, int of, double size,
                                       double tolerance)
    : basis_(basis), sides_(std::move(sides)), of_(of), size_(size) {
  constexpr int points = SideBasis::points;
  double curvature = 0, sines = 0;  // mean square of the sides' curvature
  for (double t : basis.t) sines += std::sin(std::numbers::pi * t);
  for (const FollowedSide& side : sides_)
    for (const SideForm& form : side.form) curvature += form.squared_norm() / points / of;
  const double tolerated = tolerance * std::sqrt(curvature + flat_curvature(size));
  for (FollowedSide& side : sides_) {
    const double unit = Vec2(tolerated, tolerated_deviations * side.curvature_error).stableNorm();
    for (int k = 0; k < points; ++k)
      side.weight[k] *=
          std::sqrt((weight_at_corners + std::sin(std::numbers::pi * basis.t[k])) / (of * (weight_at_corners * points + sines))) /
          unit;
  }
}

Eigen::VectorXd CurvatureFollowing::jumps(const Eigen::VectorXd& x, RowMajor* rows) const {
  constexpr int points = SideBasis::points;
  const Index m = basis_.slope.cols();
  Eigen::VectorXd value(points * static_cast<Index>(sides_.size()));
  if (rows) rows->setZero(value.size(), x.size());
  for (std::size_t f = 0; f < sides_.size(); ++f) {
    const FollowedSide& side = sides_[f];
    const Eigen::MatrixXd& second = basis_.second[side.i];
    const Index n = second.cols(), alpha_at = side.first, beta_at = alpha_at + m;
    const Eigen::VectorXd da = side.scale[0] * (basis_.slope * x.segment(alpha_at, m)),
                          db = side.scale[1] * (basis_.slope * x.segment(beta_at, m));
    for (int k = 0; k < points; ++k) {
      const SideForm& form = side.form[k];
      const Index row = points * static_cast<Index>(f) + k;
      const double a = side.alpha[k] + da[k], b = side.beta[k] + db[k], skew = side.skew[k];
      double jump =
          side.base[k] + skew * (da[k] * form.rc + db[k] * form.cc) - (a * a * form.rr + 2 * a * b * form.rc + b * b * form.cc);
      for (int c = 0; c < 3; ++c) jump += size_ * form.n[c] * second.row(k).dot(x.segment(c * n, n));
      value[row] = side.weight[k] * jump;
      if (!rows) continue;
      for (int c = 0; c < 3; ++c) rows->row(row).segment(c * n, n) = side.weight[k] * size_ * form.n[c] * second.row(k);
      rows->row(row).segment(alpha_at, m) =
          side.weight[k] * side.scale[0] * (skew * form.rc - 2 * a * form.rr - 2 * b * form.rc) * basis_.slope.row(k);
      rows->row(row).segment(beta_at, m) =
          side.weight[k] * side.scale[1] * (skew * form.cc - 2 * a * form.rc - 2 * b * form.cc) * basis_.slope.row(k);
    }
  }
  return value;
}

Quadratic CurvatureFollowing::linearized(const Eigen::VectorXd& x) const {
  RowMajor rows;
  const Eigen::VectorXd value = jumps(x, &rows);
  RowMajor normal = RowMajor::Zero(x.size(), x.size());
  add_gram(rows, normal);
  return {symmetric_of_lower(normal, x.size()), rows.transpose() * value, value.squaredNorm()};
}

}  // namespace tripatch
