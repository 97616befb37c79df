#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "tripatch/creases/crease_curve.h"

using namespace tripatch;

namespace {

Points arc(double from, double to, int n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> jitter(-0.3, 0.3);
  Points p(n, 3);
  for (int k = 0; k < n; ++k) {
    const double inner = k > 0 && k + 1 < n ? jitter(random) : 0, a = from + (to - from) * (k + inner) / (n - 1);
    p.row(k) << std::cos(a), std::sin(a), 0.2 * std::sin(a);
  }
  return p;
}

const Eigen::VectorXd shares = Eigen::VectorXd::LinSpaced(11, 0, 1);

}  // namespace

TEST_CASE("a crease's curve is straight where the crease is") {
  Points before(4, 3), after(2, 3);
  before << -1, 0, 0, -0.6, 0, 0, -0.5, 0, 0, -0.2, 0, 0;
  after << 0.5, 0, 0, 0.9, 0, 0;
  const CreaseCurve curve(before, after, 0.2);
  CHECK(curve.length() == Approx(0.7));
  const Points p = curve.at(shares);
  for (Index k = 0; k < p.rows(); ++k) CHECK((p.row(k) - Eigen::RowVector3d(-0.2 + 0.7 * shares[k], 0, 0)).norm() < 1e-9);
}

TEST_CASE("a crease's curve goes on as an arc does, over a gap as long as its radius, and meets both rims to 1e-4 edges") {
  for (unsigned seed = 1; seed < 6; ++seed) {
    const Points before = arc(-1.2, -0.5, 8, seed), after = arc(0.5, 1.2, 8, seed + 10);
    const CreaseCurve curve(before, after, 0.1);
    const Points p = curve.at(shares);
    CHECK((p.row(0) - before.row(7)).norm() < 1e-5);
    CHECK((p.row(10) - after.row(0)).norm() < 1e-5);
    for (Index k = 0; k < p.rows(); ++k) {
      CHECK(std::abs(p.row(k).head<2>().norm() - 1) < 3e-4);
      CHECK(std::abs(p(k, 2) - 0.2 * p(k, 1)) < 3e-4);
    }
  }
}

TEST_CASE("the deviation of a crease's curve grows with noise and away from its ends, and holds its error") {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 0.005);
  int within = 0, all = 0;
  for (unsigned seed = 1; seed < 12; ++seed) {
    Points before = arc(-1.2, -0.4, 9, seed), after = arc(0.4, 1.2, 9, seed + 20);
    for (Points* p : {&before, &after})
      for (Index k = 0; k < p->size(); ++k) p->data()[k] += noise(random);
    const CreaseCurve curve(before, after, 0.1);
    const Points p = curve.at(shares);
    const Eigen::VectorXd s = curve.deviation(shares);
    CHECK(s[5] > s[0]);
    for (Index k = 0; k < p.rows(); ++k) {
      within += std::abs(p.row(k).head<2>().norm() - 1) < 2 * s[k];
      ++all;
    }
  }
  CHECK(within > 0.8 * all);
}

TEST_CASE("which order and how much noise a crease's curve has does not hang on rounding, be it straight or of three vertices") {
  Points straight(8, 3), bent(3, 3);
  for (Index k = 0; k < 8; ++k) straight.row(k) = (k < 5 ? 0.1 : 0.2) * static_cast<double>(k) * Eigen::RowVector3d(1, 0.7, -0.3);
  bent << 0, 0, 0, 0.9, 0.2, 0.1, 2.2, 0.1, 0.7;
  const auto at = [](const Points& p, Index before) {
    return CreaseCurve(p.topRows(before), p.bottomRows(p.rows() - before), 0.5).at(shares);
  };
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 1e-15);
  for (int round = 0; round < 20; ++round)
    for (const auto& [points, before] : {std::pair(straight, Index{5}), std::pair(bent, Index{2})}) {
      Points moved = points;
      for (double& x : moved.reshaped()) x += noise(random);
      CHECK((at(moved, before) - at(points, before)).cwiseAbs().maxCoeff() < 1e-11);
    }
}
