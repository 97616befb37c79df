// By which polynomial a side is smoothed, on both sides of each threshold.
#include <Eigen/QR>
#include <catch2/catch.hpp>
#include <cmath>

#include "tripatch/boundary/smoothed.h"

using namespace tripatch;

namespace {

/// Largest distance of values from the nearest polynomial of a degree.
double left_by(int degree, const Eigen::VectorXd& t, const Eigen::MatrixXd& values) {
  Eigen::MatrixXd basis(t.size(), degree + 1);
  for (Index k = 0; k < t.size(); ++k)
    for (int d = 0; d <= degree; ++d) basis(k, d) = std::cos(d * std::acos(std::clamp(2 * t[k] - 1, -1.0, 1.0)));
  return (basis * basis.colPivHouseholderQr().solve(values) - values).rowwise().norm().maxCoeff();
}

/// A side whose second derivative across has a wave of degree 8 and noise; its degree once it is smoothed, what polynomials of degree 6
/// and 16 leave of it, and its size.
struct Waving {
  int degree;
  double by_6, by_16, scale = 0;
  Waving(double wave, double noise) {
    constexpr int n = 40;
    Eigen::VectorXd t(n);
    Eigen::MatrixXd values = Eigen::MatrixXd::Zero(n, 3);
    Side side;
    std::vector<double> q;
    for (int k = 0; k < n; ++k) {
      side.rim.push_back(t[k] = static_cast<double>(k) / (n - 1));
      values(k, 1) = 1 + t[k];
      values(k, 2) = wave * std::cos(8 * std::acos(2 * t[k] - 1)) + (k % 2 ? noise : -noise);
      q.insert(q.end(), {values(k, 0), values(k, 1), values(k, 2)});
    }
    const std::array<double, 6> line = {0, 0, 0, 1, 0, 0};
    side.c = side.r = PiecewisePolynomial::bezier(line, 3);
    side.q = PiecewisePolynomial::spline(side.rim, q, 3);
    for (int k = 0; k < n; ++k) scale = std::max(scale, (values.row(k) - values.row(0)).norm() + values.row(k).norm());
    by_6 = left_by(6, t, values);
    by_16 = left_by(16, t, values);
    const PiecewisePolynomial smooth = smoothed(Sides{side, side, side})[0].q;
    degree = smooth.pieces() == n - 1 ? 0 : smooth.degree();
  }
};

}  // namespace

TEST_CASE("a side is smoothed by the least degree that leaves twice what the highest does, or 2e-5 of it", "[thresholds]") {
  double below = 0, above = 10;
  for (double wave = 0.005; wave < 0.05; wave *= 1.03) {
    const Waving side(wave, 0.01);
    const double share = side.by_6 / side.by_16;
    CHECK(side.degree == (share < 2 ? 6 : 8));
    (share < 2 ? below : above) = share < 2 ? std::max(below, share) : std::min(above, share);
  }
  CHECK(below > 1.9);
  CHECK(above < 2.1);
  for (const double share : {1.95e-5, 2.05e-5}) {
    const Waving one(1e-5, 0);
    CHECK(Waving(share * 1e-5 / (one.by_6 / one.scale), 0).degree == (share < 2e-5 ? 6 : 8));
  }
}

TEST_CASE("a side is not smoothed of which the highest degree leaves a tenth", "[thresholds]") {
  double below = 0, above = 1;
  for (double noise = 0.2; noise < 0.8; noise *= 1.02) {
    const Waving side(0, noise);
    const double share = side.by_16 / side.scale;
    CHECK((side.degree == 0) == (share > 0.1));
    (share < 0.1 ? below : above) = share < 0.1 ? std::max(below, share) : std::min(above, share);
  }
  CHECK(below > 0.095);
  CHECK(above < 0.105);
}
