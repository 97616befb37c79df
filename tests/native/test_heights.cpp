// Sums over heights, eight at a time, next to the same one after the other.
#include <Eigen/LU>
#include <catch2/catch.hpp>
#include <cmath>

#include "tripatch/estimate/heights.h"

using namespace tripatch;

namespace {

/// So many heights, the last eight not full.
struct Some {
  std::vector<SampleBlock> heights;
  Eigen::MatrixXd rows;  // of monomials
  Eigen::VectorXd z, share, g, weight;
  HeightVariances variances{0.3, 0.2};

  explicit Some(Index n) : heights((n + 7) / 8), rows(n, fit_terms), z(Eigen::VectorXd::Random(n)), share(n), g(n), weight(n) {
    const Eigen::MatrixXd place = Eigen::MatrixXd::Random(n, 2);
    share = Eigen::VectorXd::Random(n).cwiseAbs();
    g = Eigen::VectorXd::Random(n).cwiseAbs();
    for (SampleBlock& of : heights) of = {};
    for (Index k = 0; k < n; ++k) {
      SampleBlock& of = heights[k / 8];
      of.x[k % 8] = place(k, 0);
      of.y[k % 8] = place(k, 1);
      of.z[k % 8] = z[k];
      of.share[k % 8] = share[k];
      of.g[k % 8] = g[k];
      for (int d = 0; d <= fit_degree; ++d)
        for (int j = 0; j <= d; ++j) rows(k, place_of(d, j)) = std::pow(place(k, 0), d - j) * std::pow(place(k, 1), j);
    }
    weight = share.array() / (variances.noise + variances.truncation * g.array());
  }
  Eigen::MatrixXd normal_matrix() const { return rows.transpose() * weight.asDiagonal() * rows; }
};

/// A triangle that is well conditioned, and what its diagonal has over it.
struct Triangle {
  SquareOf24 r = SquareOf24::Zero();
  Reciprocals over;
  Eigen::MatrixXd square;

  Triangle() {
    r.topLeftCorner<fit_terms, fit_terms>() =
        Eigen::Matrix<double, fit_terms, fit_terms>(Eigen::MatrixXd::Random(fit_terms, fit_terms)).triangularView<Eigen::Upper>();
    r.diagonal().array() += 4;
    for (int k = 0; k < fit_terms; ++k) over[k] = 1 / r(k, k);
    square = r.topLeftCorner<fit_terms, fit_terms>();
  }
};

}  // namespace

TEST_CASE("the normal matrix is the sum of all products, however many heights there are") {
  for (const Index n : {1, 7, 8, 9, 61}) {
    CAPTURE(n);
    const Some some(n);
    Workspace room;
    SquareOf24 out = SquareOf24::Zero();
    sum_products(some.heights, some.variances, room, out);
    CHECK((out.topLeftCorner<fit_terms, fit_terms>() - some.normal_matrix()).cwiseAbs().maxCoeff() < 1e-13 * n);
    const Eigen::VectorXd right = some.rows.transpose() * some.weight.cwiseProduct(some.z);
    CHECK((out.col(fit_terms).head<fit_terms>() - right).cwiseAbs().maxCoeff() < 1e-13 * n);
    for (Index k = 0; k < n; ++k) CHECK(room.weight[k] == Approx(some.weight[k]));
  }
}

TEST_CASE("residuals are those of the polynomial above the heights") {
  for (const Index n : {3, 16, 50}) {
    CAPTURE(n);
    const Some some(n);
    Workspace room;
    SquareOf24 normal;
    sum_products(some.heights, some.variances, room, normal);
    const Eigen::VectorXd c = Eigen::VectorXd::Random(fit_terms), residual = some.rows * c - some.z;
    ByMonomial out;
    sum_residuals(some.heights, room, c.data(), out);
    const Eigen::VectorXd expected = some.rows.transpose() * some.weight.cwiseProduct(residual);
    for (int k = 0; k < fit_terms; ++k) CHECK(out[k] == Approx(expected[k]).margin(1e-12));

    const Triangle root;  // any does
    const Eigen::VectorXd known = (some.rows * root.square.inverse()).rowwise().squaredNorm();
    const ExplainedHeights e = explain_heights(some.heights, some.variances, room, c.data(), root.r, root.over);
    ExplainedHeights sum;
    for (Index k = 0; k < n; ++k) {
      const double rest = some.variances.truncation * some.g[k] / (some.variances.noise + some.variances.truncation * some.g[k]);
      const double square = some.share[k] * residual[k] * residual[k], left = some.share[k] - some.weight[k] * known[k];
      sum.noise += (1 - rest) * (1 - rest) * square;
      sum.truncation += rest * rest * square / some.g[k];
      sum.noise_count += std::max(left, 0.0) * (1 - rest);
      sum.truncation_count += std::max(left, 0.0) * rest;
      sum.noise_points += some.share[k] * (1 - rest);
      sum.truncation_points += some.share[k] * rest;
    }
    CHECK(e.noise == Approx(sum.noise));
    CHECK(e.truncation == Approx(sum.truncation));
    CHECK(e.noise_count == Approx(sum.noise_count));
    CHECK(e.truncation_count == Approx(sum.truncation_count));
    CHECK(e.noise_points == Approx(sum.noise_points));
    CHECK(e.truncation_points == Approx(sum.truncation_points));
    // where the polynomial is known to less than the heights none is left
    Triangle small;
    small.r /= 100;
    for (double& over : small.over) over *= 100;
    CHECK(explain_heights(some.heights, some.variances, room, c.data(), small.r, small.over).noise_count == 0);
  }
}

TEST_CASE("triangular systems of the terms are solved") {
  const Triangle t;
  const Eigen::VectorXd right = Eigen::VectorXd::Random(fit_terms);
  Eigen::VectorXd x = right;
  solve_upper(t.r, t.over, x.data());
  CHECK((t.square * x - right).cwiseAbs().maxCoeff() < 1e-13);
  x = right;
  solve_upper_transposed(t.r, t.over, x.data());
  CHECK((t.square.transpose() * x - right).cwiseAbs().maxCoeff() < 1e-13);
  const Eigen::MatrixXd columns = t.square.transpose().inverse();
  const ByMonomial variances = coefficient_variances(t.r, t.over);
  for (int k = 0; k < fit_terms; ++k) CHECK(variances[k] == Approx(columns.col(k).squaredNorm()));
  const auto [along, across, bend, both] = products_of_columns(t.r, t.over);
  CHECK(along == Approx(columns.col(1).squaredNorm()));
  CHECK(across == Approx(columns.col(2).squaredNorm()));
  CHECK(bend == Approx(columns.col(5).squaredNorm()));
  CHECK(both == Approx(columns.col(1).dot(columns.col(2))).margin(1e-14));
}
