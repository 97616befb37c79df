#include "tripatch/fairing/curvature_following.h"

#include <cmath>
#include <numbers>

#include "tripatch/fairing/energy.h"
#include "tripatch/math/linear.h"

namespace tripatch {
namespace {

/// A mesh's curvature is known to the standard deviation Side::curvature_error; what lies within three of these costs little. Five let
/// the holes of docs/fairness.md at n = 8 end an eighth farther from the truth (docs/notes/fairing.md, the jump of curvature).
constexpr double deviations = 3;
/// Points count like sin(pi t), so that the corners, where the sides' own data meet, do not decide, but not less than this there.
constexpr double weight_at_corners = 0.05;

}  // namespace

CurvatureFollowing::CurvatureFollowing(const FairingSpace& space, const Unknowns& unknowns, const FairingBase& base,
                                       const FairingOptions& options)
    : space_(space), unknowns_(unknowns) {
  constexpr int points = FairingSpace::side_points;
  double curvature = 0;  // mean square of the sides'
  for (int i = 0; i < 3; ++i) {
    if (!options.curvature[i] || base.sides[i].q.empty() || unknowns_.scale[i][0] == 0) continue;
    Followed side;
    side.i = i;
    const std::vector<Across> across = derivatives_across(*base.patch, i, space_.side_t);
    for (int k = 0; k < points; ++k) {
      const double t = space_.side_t[k];
      const SideForm form = side_form(base.sides[i], t);
      side.form[k] = form;
      base.boundary.ribbons[i].alpha.taylor(t, 0, &side.alpha[k]);
      base.boundary.ribbons[i].beta.taylor(t, 0, &side.beta[k]);
      side.base[k] = form.n.dot(across[k].second);
      side.weight[k] = 1 / form.across(side.alpha[k] * form.r);
      curvature += form.squared_norm() / points / 3;
    }
    sides_.push_back(side);
  }
  const double tolerated = options.curvature_jump * std::sqrt(curvature + flat_curvature(unknowns_.size));
  for (Followed& side : sides_) {
    const double unit = std::hypot(tolerated, deviations * base.sides[side.i].curvature_error);
    for (int k = 0; k < points; ++k)
      side.weight[k] *= std::sqrt((weight_at_corners + std::sin(std::numbers::pi * space_.side_t[k])) /
                                  (3 * (weight_at_corners * points + space_.side_sum))) /
                        unit;
  }
}

Eigen::VectorXd CurvatureFollowing::jumps(const Eigen::VectorXd& x, RowMajor* rows) const {
  constexpr int points = FairingSpace::side_points;
  const int m = unknowns_.slopes;
  const Index n = unknowns_.interior;
  Eigen::VectorXd value(points * static_cast<Index>(sides_.size()));
  if (rows) rows->setZero(value.size(), unknowns_.count());
  for (std::size_t f = 0; f < sides_.size(); ++f) {
    const Followed& side = sides_[f];
    const int i = side.i;
    const Index alpha_at = 3 * n + unknowns_.first[i], beta_at = alpha_at + m;
    const Eigen::VectorXd da = unknowns_.scale[i][0] * (space_.side_slope * x.segment(alpha_at, m)),
                          db = unknowns_.scale[i][1] * (space_.side_slope * x.segment(beta_at, m));
    for (int k = 0; k < points; ++k) {
      const SideForm& form = side.form[k];
      const Index row = points * static_cast<Index>(f) + k;
      const double a = side.alpha[k] + da[k], b = side.beta[k] + db[k], skew = 2 * (0.5 - space_.side_t[k]);
      double jump =
          side.base[k] + skew * (da[k] * form.rc + db[k] * form.cc) - (a * a * form.rr + 2 * a * b * form.rc + b * b * form.cc);
      for (int c = 0; c < 3; ++c) jump += unknowns_.size * form.n[c] * space_.side_second[i].row(k).dot(x.segment(c * n, n));
      value[row] = side.weight[k] * jump;
      if (!rows) continue;
      for (int c = 0; c < 3; ++c)
        rows->row(row).segment(c * n, n) = side.weight[k] * unknowns_.size * form.n[c] * space_.side_second[i].row(k);
      rows->row(row).segment(alpha_at, m) = side.weight[k] * unknowns_.scale[i][0] *
                                            (skew * form.rc - 2 * a * form.rr - 2 * b * form.rc) * space_.side_slope.row(k);
      rows->row(row).segment(beta_at, m) = side.weight[k] * unknowns_.scale[i][1] *
                                           (skew * form.cc - 2 * a * form.rc - 2 * b * form.cc) * space_.side_slope.row(k);
    }
  }
  return value;
}

}  // namespace tripatch
