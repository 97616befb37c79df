// What decides about singular systems of the Bezier methods, on both sides of each threshold.
#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <cmath>

#include "test_refusals.h"
#include "tripatch/constructions/coons_bezier.h"
#include "tripatch/math/linear.h"

using namespace tripatch;

namespace {

bool inside(int i, int j, int k) { return i > 0 && j > 0 && k > 0; }

/// The columns of the control points inside, or of those on the sides.
Eigen::MatrixXd columns(const Eigen::MatrixXd& equations, int degree, bool of_inside) {
  std::vector<Index> which;
  for (int r = 0; r <= degree; ++r)
    for (int k = 0; k <= r; ++k)
      if (inside(degree - r, r - k, k) == of_inside) which.push_back(BezierTriangle::row(degree - r, r - k, k));
  return equations(Eigen::all, which);
}

BoundaryCurves sides_of(const Points& net) {
  const BezierTriangle triangle(net);
  return {triangle.side(0), triangle.side(1), triangle.side(2)};
}

/// The least pivot over the largest of the permanence system of degree 4.
double min_pivot(double alpha) {
  const Eigen::MatrixXd system = columns(mask_equations(4, CoonsKind::permanence, alpha), 4, true);
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(system);
  return qr.matrixR().diagonal().cwiseAbs().minCoeff() / qr.maxPivot();
}

}  // namespace

TEST_CASE("a singular system is solved where it leaves a ten-billionth of the boundary's size", "[thresholds]") {
  const int n = 6;
  const Eigen::MatrixXd equations = mask_equations(n, CoonsKind::mask), of_inside = columns(equations, n, true);
  Points net(BezierTriangle::net_size(n), 3);  // a triangle of size 1 in the plane, which the mask leaves alone
  for (int i = 0; i <= n; ++i)
    for (int j = 0; i + j <= n; ++j) net.row(BezierTriangle::row(i, j, n - i - j)) << i, j, 0;
  net /= n;
  REQUIRE((equations * net).norm() < 1e-12);
  const Index moved = BezierTriangle::row(0, 2, 4);  // up by 1: what the system leaves of it, by least squares
  const Eigen::MatrixXd right = -equations.col(moved);
  const Eigen::MatrixXd left = right - of_inside * minimum_norm_least_squares(of_inside, right, 1e-11).x;
  REQUIRE(left.cwiseAbs().maxCoeff() > 1e-3);
  for (const double share : {0.97e-10, 1.03e-10}) {
    Points raised = net;
    raised(moved, 2) = share / left.cwiseAbs().maxCoeff();
    if (share < 1e-10) {
      CHECK_NOTHROW(coons_bezier(sides_of(raised), CoonsKind::mask));
    } else {
      CHECK(refusal_code([&] { coons_bezier(sides_of(raised), CoonsKind::mask); }) == "coons_without_solution");
    }
  }
}

TEST_CASE("a system is singular whose least pivot is a hundred-billionth of the largest", "[thresholds]") {
  const double root = -2.0 / 3, slope = min_pivot(root + 1e-5) / 1e-5;
  for (const double share : {0.97e-11, 1.03e-11}) {
    const double alpha = root + share / slope;
    REQUIRE(min_pivot(alpha) == Approx(share).epsilon(0.02));
    Points net(BezierTriangle::net_size(4), 3);
    net.setRandom();
    if (share < 1e-11) {
      CHECK(refusal_code([&] { coons_bezier(sides_of(net), CoonsKind::permanence, alpha); }) == "coons_without_solution");
    } else {
      CHECK_NOTHROW(coons_bezier(sides_of(net), CoonsKind::permanence, alpha));
    }
  }
}
