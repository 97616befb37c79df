#include <array>
#include <catch2/catch.hpp>
#include <cmath>

#include "tripatch/math/polyharmonic.h"

using namespace tripatch;

namespace {

double kernel(double order, double r) {
  const int e = polyharmonic_exponent(order);
  const double power = r > 0 ? std::pow(r, e) : 0;
  return polyharmonic_factor(e) * (e % 2 == 0 ? (r > 0 ? 2 * power * std::log(r) : 0) : power);
}

PlanePoints spiral(Index n, double turn) {
  PlanePoints out(n, 2);
  for (Index k = 0; k < n; ++k) {
    const double t = turn * static_cast<double>(k), r = 0.1 + 0.9 * static_cast<double>(k) / static_cast<double>(n);
    out.row(k) << r * std::cos(t), r * std::sin(t);
  }
  return out;
}

}  // namespace

TEST_CASE("A sum of polyharmonic kernels and polynomials is what its formula says, each place by itself", "[field]") {
  const PlanePoints centers = spiral(23, 2.4);
  PlanePoints at(27, 2);
  at << spiral(26, 1.1), centers.row(7);  // one of them at a center
  PolyharmonicSum sum(centers);
  Points expected = Points::Zero(at.rows(), 3);
  double share = 0.3;
  for (const double order : {5.5, 2.5, 3.0, 3.5, 2.0}) {
    const Index q = free_polynomials(order);
    const Eigen::MatrixXd weights = (Eigen::MatrixXd::Ones(23, 3) * order + Eigen::MatrixXd::Random(23, 3)) / 10;
    const Eigen::MatrixXd polynomial = Eigen::MatrixXd::Random(q, 3);
    sum.add(order, share, weights, polynomial);
    for (Index k = 0; k < at.rows(); ++k) {
      for (Index i = 0; i < 23; ++i)
        expected.row(k) += share * kernel(order, (at.row(k) - centers.row(i)).norm()) * weights.row(i);
      Index row = 0;
      for (int i = 0; i <= free_degree_of(order); ++i)
        for (int j = 0; i + j <= free_degree_of(order); ++j)
          expected.row(k) += share * std::pow(at(k, 0), i) * std::pow(at(k, 1), j) * polynomial.row(row++);
    }
    share += 0.1;
  }
  const Points found = sum.values(at);
  CHECK((found - expected).cwiseAbs().maxCoeff() < 1e-12);
  for (Index k = 0; k < at.rows(); ++k) CHECK(sum.values(at.row(k)).row(0) == found.row(k));

  Eigen::Matrix<double, Eigen::Dynamic, 9, Eigen::RowMajor> jets(at.rows(), 9);
  sum.evaluate(at, 1, jets.data());
  CHECK((jets.leftCols<3>() - expected).cwiseAbs().maxCoeff() < 1e-12);
  const double h = 1e-5;
  for (int axis = 0; axis < 2; ++axis) {
    PlanePoints low = at, high = at;
    low.col(axis).array() -= h;
    high.col(axis).array() += h;
    const Points slope = (sum.values(high) - sum.values(low)) / (2 * h);
    CHECK((jets.middleCols<3>(3 + 3 * axis) - slope).cwiseAbs().maxCoeff() < 1e-6);
  }

  using SecondJets = Eigen::Matrix<double, Eigen::Dynamic, 18, Eigen::RowMajor>;
  SecondJets second(at.rows(), 18);
  sum.evaluate(at, 2, second.data());
  CHECK((second.leftCols<9>() - jets).cwiseAbs().maxCoeff() < 1e-12);
  const Index apart = at.rows() - 2;  // the first and the last are at a center, where the lowest orders have no second derivative
  for (int axis = 0; axis < 2; ++axis) {
    PlanePoints low = at, high = at;
    low.col(axis).array() -= h;
    high.col(axis).array() += h;
    Eigen::Matrix<double, Eigen::Dynamic, 9, Eigen::RowMajor> before(at.rows(), 9), after(at.rows(), 9);
    sum.evaluate(low, 1, before.data());
    sum.evaluate(high, 1, after.data());
    const Eigen::MatrixXd bend = (after - before).rightCols<6>().middleRows(1, apart) / (2 * h);
    const int own = axis == 0 ? 9 : 15;  // half of the second derivative
    CHECK((2 * second.middleCols(own, 3).middleRows(1, apart) - bend.middleCols(3 * axis, 3)).cwiseAbs().maxCoeff() < 1e-5);
    CHECK((second.middleCols(12, 3).middleRows(1, apart) - bend.middleCols(3 - 3 * axis, 3)).cwiseAbs().maxCoeff() < 1e-5);
  }
  CHECK(second.allFinite());
}
