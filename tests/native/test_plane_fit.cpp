// Fits of planes to heights.
#include <Eigen/QR>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "test_drafts.h"
#include "tripatch/creases/crease_curve.h"
#include "tripatch/estimate/plane_fit.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

/// What is seen from a vertex of a side in a sheet over so many rings, with heights of its own.
template <class F>
Stencil stencil(int rings, const F& height) {
  FlatDrafts flat(6);
  SideSearch search(flat.w, flat.drafts, 2);
  Seen seen;
  measure(flat.w, flat.drafts[2], 3, {rings, false, true, false}, search, seen);
  Stencil& s = seen.stencil;
  for (SampleBlock& of : s.heights)
    for (int k = 0; k < 8; ++k) of.z[k] = height(of.x[k], of.y[k]);
  return s;
}

/// The terms at each point, whose coefficients are the derivatives of the height.
Eigen::MatrixXd rows_of(const Stencil& s) {
  Eigen::MatrixXd rows(s.points, fit_terms);
  for (Index k = 0; k < s.points; ++k)
    for (int d = 0, column = 0; d <= fit_degree; ++d)
      for (int j = 0; j <= d; ++j, ++column)
        rows(k, column) = std::pow(s.heights[k / 8].x[k % 8], d - j) / std::tgamma(d - j + 1) *
                          std::pow(s.heights[k / 8].y[k % 8], j) / std::tgamma(j + 1);
  return rows;
}

/// Inverse variances of the heights, times their shares.
Eigen::VectorXd weights_of(const Stencil& s, const VarianceComponents& components) {
  Eigen::VectorXd weights(s.points);
  for (Index k = 0; k < s.points; ++k) {
    const SampleBlock& of = s.heights[k / 8];
    weights[k] = of.share[k % 8] / (components.noise + components.truncation * of.g[k % 8]);
  }
  return weights;
}

}  // namespace

TEST_CASE("a fit that is refined is that of an orthogonal triangularization to its last digits") {
  const Stencil s = stencil(2, [](double x, double y) { return 0.1 * std::sin(x + y) + 0.03 * std::cos(2 * x * y); });
  VarianceComponents components;
  components.noise = 1e-8;
  FitRoom room;
  double variance = 1;  // as large as normal equations take it
  for (PlaneFit fit; fit = fit_plane(s, components, room), room.normal_equations; variance *= 1.1)
    components.term = {1, 100, variance, variance, variance, variance};
  variance /= 1.3;
  components.term = {1, 100, variance, variance, variance, variance};
  PlaneFit fit = fit_plane(s, components, room);
  refine(s, room, fit);
  using Long = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  const Index n = s.points;
  Long rows = Long::Zero(n + fit_terms, fit_terms), right = Long::Zero(n + fit_terms, 1);
  const Eigen::MatrixXd given = rows_of(s);
  const Eigen::VectorXd weight = weights_of(s, components);
  for (Index k = 0; k < n; ++k) {
    const long double root = std::sqrt(static_cast<long double>(weight[k]));
    rows.row(k) = root * given.row(k).cast<long double>();
    right(k) = root * s.heights[k / 8].z[k % 8];
  }
  for (Index k = 0; k < fit_terms; ++k) rows(n + k, k) = std::sqrt(static_cast<long double>(fit.prior[k]));
  right(n + 2) = rows(n + 2, 2) * s.faces;
  const Long exact = rows.householderQr().solve(right);
  double off = 0;
  for (Index k = 0; k < fit_terms; ++k) off = std::max(off, static_cast<double>(std::abs(fit.mean[k] - exact(k))));
  CHECK(off < 1e-11 * fit.mean.norm());
}

TEST_CASE("noise is found in as many rounds as there are") {
  for (const double deviation : {1e-4, 1e-2}) {
    std::mt19937 random(3);
    std::normal_distribution<double> normal(0, deviation);
    std::vector<Stencil> noisy;
    for (int k = 0; k < 7; ++k)
      noisy.push_back(stencil(4, [&](double x, double y) { return 0.1 * x * x - 0.05 * y * y + normal(random); }));
    const double found = estimate_components({noisy, noisy, noisy}, 2.5, 0.04).noise;
    CAPTURE(deviation, std::sqrt(found));
    CHECK(std::abs(std::log(found / (deviation * deviation))) < 0.3);
  }
}
