#include "tripatch/creases/crease_curve.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tripatch/math/decompositions.h"
#include "tripatch/math/thresholds.h"

namespace tripatch {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Over a gap as long as its radius an arc of a circle with twelve vertices on either side is met to 1.3e-5 of that, with orders up to 4 to
/// 1.6e-5, up to 3 to 3.0e-5.
constexpr int lowest_curve_order = 2, highest_curve_order = 5;
/// Over the mean eigenvalue of the curve_kernel, in decades: from rounding to a straight line. On 68 holes across creases (features.cpp) half
/// and twice of the ends change the mean distance by 0.3% at most, half of the step by 0.1%; twice of it leaves them 5% nearer, by a few.
constexpr double min_curve_nugget = -13, max_curve_nugget = 3, curve_nugget_step = 0.5;
/// Of a unit, an edge: so much rounding may have moved each sample, a million sizes from the origin too. Of a straight crease nothing else
/// is left across it, and neither order nor nugget is to be chosen by that.
constexpr double rounding_of_samples = tolerance::solved;
/// The length of the gap is that of the curve in it, which is not known before it: each round leaves a twentieth of the error over
/// such an arc, four 1e-5 of the length, as much as the pieces do.
constexpr int gap_rounds = count::several;
/// That the length is summed over: with half or twice as many the mean distance of those 68 changes by less than 0.1%.
constexpr int length_pieces = count::many_places;

double curve_kernel(int order, double t) {
  const double r = std::abs(t);
  double power = r;
  for (int k = 1; k < order; ++k) power *= r * r;
  return order % 2 == 0 ? power : -power;
}

MatrixXd curve_kernels(int order, const VectorXd& a, const VectorXd& b) {
  MatrixXd k(a.size(), b.size());
  for (Index j = 0; j < b.size(); ++j)
    for (Index i = 0; i < a.size(); ++i) k(i, j) = curve_kernel(order, a[i] - b[j]);
  return k;
}

MatrixXd powers(int order, const VectorXd& t) {
  MatrixXd p(t.size(), order);
  for (Index i = 0; i < t.size(); ++i)
    for (int k = 0; k < order; ++k) p(i, k) = std::pow(t[i], k);
  return p;
}

/// The curve_kernel among samples seen through the combinations of them in which polynomials cancel.
struct CurveContrasts {
  CurveContrasts(int order, const VectorXd& t)
      : among(curve_kernels(order, t, t)),
        polynomials(orthonormal_columns(powers(order, t), true)),
        eigen(symmetric_eigen(MatrixXd(polynomials.rest.transpose() * among) * polynomials.rest)) {}
  MatrixXd among;
  OrthonormalColumns polynomials;
  SymmetricEigen eigen;
};

}  // namespace

CreaseCurve::CreaseCurve(const Points& before, const Points& after, double unit) : samples_(before.rows() + after.rows(), 3) {
  const Index n = before.rows(), m = after.rows();
  if (n < 2 || m < 1) throw InvalidArgument("a crease needs an edge before the gap and a point after it");
  samples_ << before, after;
  VectorXd along(n + m);
  along[n - 1] = 0;
  for (Index k = n - 1; k-- > 0;) along[k] = along[k + 1] - (before.row(k + 1) - before.row(k)).norm();
  gap_ = (after.row(0) - before.row(n - 1)).norm();
  for (int round = 0; round < gap_rounds; ++round) {
    along[n] = gap_;
    for (Index k = 1; k < m; ++k) along[n + k] = along[n + k - 1] + (after.row(k) - after.row(k - 1)).norm();
    middle_ = (along[0] + along[n + m - 1]) / 2;
    half_ = std::max((along[n + m - 1] - along[0]) / 2, tolerance::tiny);
    t_ = (along.array() - middle_) / half_;
    choose(unit);
    const Points curve = at(VectorXd::LinSpaced(length_pieces + 1, 0, 1));
    double length = 0;
    for (int k = 0; k < length_pieces; ++k) length += (curve.row(k + 1) - curve.row(k)).norm();
    if (round + 1 < gap_rounds) gap_ = length;
  }
}

void CreaseCurve::choose(double unit) {
  const Index n = t_.size();
  double most = -std::numeric_limits<double>::infinity();
  for (int order = lowest_curve_order; order <= highest_curve_order; ++order) {
    if (order > lowest_curve_order && 2 * order > n) break;
    const CurveContrasts contrasts(order, t_);
    const VectorXd& values = contrasts.eigen.values;
    const Eigen::Matrix<double, Eigen::Dynamic, 3> seen = contrasts.polynomials.rest.transpose() * (samples_ / unit);
    const MatrixXd z = contrasts.eigen.vectors.transpose() * seen;
    const double scale = std::max(values.mean(), tolerance::tiny), count = static_cast<double>(values.size());
    for (double decade = min_curve_nugget; decade <= max_curve_nugget; decade += curve_nugget_step) {
      const double nugget = std::pow(10, decade) * scale;
      const Eigen::ArrayXd pivots = values.array() + nugget;
      if (!(pivots.minCoeff() > 0)) continue;
      // Two directions across the curve, of which each sample says something.
      constexpr double rounding = rounding_of_samples * rounding_of_samples * 2;
      const double squares = ((z.rowwise().squaredNorm().array() + rounding) / pivots).sum();
      const double variance = squares / (2 * count);
      const double likelihood = -count * std::log(variance) - pivots.log().sum();
      if (!(likelihood > most + tolerance::same)) continue;
      most = likelihood;
      order_ = order;
      nugget_ = nugget;
      variance_ = variance * unit * unit;
    }
  }
}

MatrixXd CreaseCurve::weights(const VectorXd& shares, VectorXd* variance) const {
  VectorXd t(shares.size());
  for (Index k = 0; k < t.size(); ++k) t[k] = normalised(shares[k] * gap_);
  const CurveContrasts contrasts(order_, t_);
  const MatrixXd polynomials = powers(order_, t);
  const MatrixXd at_points = curve_kernels(order_, t_, t);
  // the polynomial through the samples that is nearest, and what the contrasts add to it
  const MatrixXd &rest = contrasts.polynomials.rest, &vectors = contrasts.eigen.vectors;
  const MatrixXd nearest =
      contrasts.polynomials.basis *
      contrasts.polynomials.triangle.triangularView<Eigen::Upper>().transpose().solve(polynomials.transpose());
  const MatrixXd left = at_points - contrasts.among * nearest - nugget_ * nearest;
  const VectorXd pivots = contrasts.eigen.values.array() + nugget_;
  const MatrixXd w =
      nearest + rest * (vectors * pivots.cwiseInverse().asDiagonal() * (vectors.transpose() * (rest.transpose() * left)));
  if (variance) {
    const MatrixXd covered = contrasts.among * w + nugget_ * w - 2 * at_points;
    *variance = w.cwiseProduct(covered).colwise().sum().transpose().cwiseMax(0);
  }
  return w.transpose();
}

Points CreaseCurve::at(const VectorXd& shares) const {
  const Eigen::RowVector3d origin = samples_.colwise().mean();
  return (weights(shares, nullptr) * (samples_.rowwise() - origin)).rowwise() + origin;
}

VectorXd CreaseCurve::deviation(const VectorXd& shares) const {
  VectorXd variance;
  weights(shares, &variance);
  return (variance_ * variance).cwiseSqrt();
}

}  // namespace tripatch
