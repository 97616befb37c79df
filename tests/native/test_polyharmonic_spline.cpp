// Polyharmonic splines as Gaussian fields: what they reproduce, their derivatives, and how well they know themselves.
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "tripatch/math/jet.h"
#include "tripatch/spline/polyharmonic_spline.h"

using namespace tripatch;

namespace {

PlanePoints scattered(Index n, double inner, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  PlanePoints points(n, 2);
  for (Index k = 0; k < n;) {
    points.row(k) << uniform(random), uniform(random);
    if (points.row(k).norm() > inner && points.row(k).norm() < 1) ++k;
  }
  return points;
}

using PlaneTurn = Eigen::Matrix2d;

template <class F>
Points over(const PlanePoints& at, const F& f) {
  Points out(at.rows(), 3);
  for (Index k = 0; k < at.rows(); ++k) out.row(k) << at(k, 0), at(k, 1), f(at(k, 0), at(k, 1));
  return out;
}

Points rows_of(const PlanePoints& uv) {
  Points rows = Points::Zero(uv.rows(), 3);
  rows.leftCols(2) = uv;
  return rows;
}

double wave(double x, double y) { return 0.3 * std::sin(1.3 * x + 0.2) * std::cos(1.1 * y); }

}  // namespace

TEST_CASE("a field reproduces polynomials below its order, across a gap") {
  const PlanePoints at = scattered(120, 0.5, 1), gap = scattered(50, 0, 2) * 0.5;
  const auto cubic = [](double x, double y) { return 1 + x - 2 * y + x * y + y * y - 0.5 * x * x * y + 0.3 * y * y * y; };
  const PolyharmonicSpline field(at, over(at, cubic), {{4}, 0.1});
  CHECK((field.positions(rows_of(gap)) - over(gap, cubic)).cwiseAbs().maxCoeff() < 1e-9);
}

TEST_CASE("a field meets samples without noise, and finds that there is none") {
  const PlanePoints at = scattered(150, 0.4, 3);
  const Points samples = over(at, wave);
  const PolyharmonicSpline field(at, samples, {{}, 0.1});
  CHECK((field.positions(rows_of(at)) - samples).cwiseAbs().maxCoeff() < 1e-7);
  CHECK(field.noise() < 1e-7);
}

TEST_CASE("the noise of samples is told from their surface") {
  const PlanePoints at = scattered(400, 0.3, 4);
  Points samples = over(at, wave);
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0, 0.01);
  for (Index k = 0; k < samples.rows(); ++k) samples(k, 2) += normal(random);
  const PolyharmonicSpline field(at, samples, {{2, 3, 4, 5, 6}, 1.0});
  CHECK(field.noise() > 0.008);
  CHECK(field.noise() < 0.012);
  const PlanePoints inside = scattered(200, 0, 6) * 0.3;
  const Points error = field.positions(rows_of(inside)) - over(inside, wave);
  CHECK(error.col(2).norm() / std::sqrt(200.0) < 0.01);
  Points up = Points::Zero(200, 3);
  up.col(2).setOnes();
  const Eigen::VectorXd deviation = field.deviation(inside, up);
  Index within = 0;
  for (Index k = 0; k < 200; ++k) within += std::abs(error(k, 2)) < 2 * deviation[k];
  CHECK(within >= 180);
  CHECK(deviation.maxCoeff() < 0.03);
}

TEST_CASE("kernels around some of the samples make the surface that those around all of them do") {
  const PlanePoints inside = scattered(200, 0, 17) * 0.5;
  const Points truth = over(inside, wave);
  for (const double noise : {0.0, 1e-3, 0.02}) {
    double apart = 0, off_all = 0, off_some = 0, off_few = 0;
    for (unsigned seed = 20; seed < 26; ++seed) {
      const PlanePoints at = scattered(800, 0.5, seed);
      std::mt19937 random(seed);
      std::normal_distribution<double> normal(0, noise > 0 ? noise : 1);
      Points samples = over(at, wave);
      for (Index k = 0; noise > 0 && k < samples.rows(); ++k) samples(k, 2) += normal(random);
      const PolyharmonicSpline all(at, samples, {{2.5, 3.5, 5.5}, 0.1}), some(at, samples, {{2.5, 3.5, 5.5}, 0.1, 200});
      const PolyharmonicSpline few(at.topRows(200), samples.topRows(200), {{2.5, 3.5, 5.5}, 0.1});
      const auto off = [&](const PolyharmonicSpline& one) { return (one.positions(rows_of(inside)) - truth).norm(); };
      apart += (some.positions(rows_of(inside)) - all.positions(rows_of(inside))).norm();
      off_all += off(all);
      off_some += off(some);
      off_few += off(few);
    }
    CAPTURE(noise, off_all, off_some, off_few);
    CHECK(apart < 0.5 * off_all + 1e-4);
    CHECK(off_some < 1.3 * off_all + 1e-4);
    if (noise > 0) CHECK(off_some < 0.9 * off_few);
  }
}

TEST_CASE("derivatives of a field are those of its values") {
  const PlanePoints at = scattered(80, 0.4, 7);
  const PolyharmonicSpline field(at, over(at, wave), {{2, 3, 4}, 0.1});
  const PlanePoints where = scattered(20, 0, 8) * 0.9;
  const Points rows = rows_of(where);
  const double h = 1e-4;
  std::vector<double> jets(20 * jet_size(3) * 3);
  field.evaluate(rows.data(), 20, 3, jets.data());
  std::vector<double> fewer(20 * jet_size(2) * 3);
  field.evaluate(rows.data(), 20, 2, fewer.data());
  for (Index k = 0; k < 20; ++k)
    for (Index c = 0; c < jet_size(2) * 3; ++c)
      CHECK(fewer[k * jet_size(2) * 3 + c] == Approx(jets[k * jet_size(3) * 3 + c]).epsilon(1e-9).margin(1e-9));
  for (int axis = 0; axis < 2; ++axis) {
    Points plus = rows, minus = rows;
    plus.col(axis).array() += h;
    minus.col(axis).array() -= h;
    std::vector<double> a(20 * jet_size(2) * 3), b = a;
    field.evaluate(plus.data(), 20, 2, a.data());
    field.evaluate(minus.data(), 20, 2, b.data());
    for (Index k = 0; k < 20; ++k)
      for (int i = 0; i <= 2; ++i)
        for (int j = 0; i + j <= 2; ++j)
          for (int x = 0; x < 3; ++x) {
            const double slope =
                (a[(k * jet_size(2) + jet_index(i, j)) * 3 + x] - b[(k * jet_size(2) + jet_index(i, j)) * 3 + x]) / (2 * h);
            const int up = axis == 0 ? jet_index(i + 1, j) : jet_index(i, j + 1), factor = axis == 0 ? i + 1 : j + 1;
            CHECK(factor * jets[(k * jet_size(3) + up) * 3 + x] == Approx(slope).margin(2e-4).epsilon(1e-3));
          }
  }
}

TEST_CASE("a field does not depend on where the surface lies, nor on its size") {
  const PlanePoints at = scattered(100, 0.4, 9), gap = scattered(20, 0, 10) * 0.3;
  const Points samples = over(at, wave);
  const Points near = PolyharmonicSpline(at, samples, {{2, 3, 4, 5, 6}, 0.1}).positions(rows_of(gap));
  const Eigen::RowVector3d away(1e5, -2e5, 3e5);
  const Points far = PolyharmonicSpline(at, samples.rowwise() + away, {{2, 3, 4, 5, 6}, 0.1}).positions(rows_of(gap));
  CHECK(((far.rowwise() - away) - near).cwiseAbs().maxCoeff() < 1e-6);
  const PlanePoints large = at * 1e4, large_gap = gap * 1e4;
  const Points scaled = PolyharmonicSpline(large, samples * 1e4, {{2, 3, 4, 5, 6}, 1e3}).positions(rows_of(large_gap));
  CHECK((scaled / 1e4 - near).cwiseAbs().maxCoeff() < 1e-7);
}

TEST_CASE("a field of a narrow strip is the same however the strip lies in the plane") {
  const PlanePoints square = scattered(120, 0, 7), inside = 0.9 * scattered(30, 0, 8);
  const PlaneTurn narrow = Eigen::Vector2d(1, 1e-4).asDiagonal();
  const PlanePoints along = square * narrow, there = inside * narrow;
  std::mt19937 random(9);
  std::normal_distribution<double> noise(0, 0.001);
  Points samples = over(square, [&](double x, double y) { return wave(x, y) + noise(random); });
  samples.leftCols<2>() = along;
  const PolyharmonicSpline straight(along, samples, {{5.5}, 0.1});
  for (const double angle : {0.3, 1.2, 2.6}) {
    PlaneTurn turn;
    turn << std::cos(angle), std::sin(angle), -std::sin(angle), std::cos(angle);
    const PolyharmonicSpline aslant(along * turn, samples, {{5.5}, 0.1});
    CHECK((aslant.positions(rows_of(there * turn)) - straight.positions(rows_of(there))).cwiseAbs().maxCoeff() < 1e-9);
    CHECK(aslant.noise() == Approx(straight.noise()).epsilon(1e-9));
    // derivatives along the strip and across it
    const Index n = there.rows();
    std::vector<double> own(static_cast<std::size_t>(18 * n)), other = own;
    straight.evaluate(rows_of(there).data(), n, 2, own.data());
    aslant.evaluate(rows_of(there * turn).data(), n, 2, other.data());
    for (Index k = 0; k < n; ++k) {
      const double *a = &own[static_cast<std::size_t>(18 * k)], *b = &other[static_cast<std::size_t>(18 * k)];
      const Vec3 u = turn(0, 0) * Vec3::Map(b + 3) + turn(0, 1) * Vec3::Map(b + 6);
      const Vec3 uu = turn(0, 0) * turn(0, 0) * Vec3::Map(b + 9) + turn(0, 0) * turn(0, 1) * Vec3::Map(b + 12) +
                      turn(0, 1) * turn(0, 1) * Vec3::Map(b + 15);
      CHECK((u - Vec3::Map(a + 3)).norm() < 1e-7);
      CHECK((uu - Vec3::Map(a + 9)).norm() < 1e-5);
    }
  }
}

TEST_CASE("samples that make no field are refused") {
  const PlanePoints at = scattered(10, 0, 11);
  CHECK_THROWS_AS(PolyharmonicSpline(at.topRows(3), over(at.topRows(3), wave), {}), InvalidArgument);
  CHECK_THROWS_AS(PolyharmonicSpline(at * 0, over(at, wave), {}), InvalidArgument);
  Points broken = over(at, wave);
  broken(4, 1) = NAN;
  CHECK_THROWS_AS(PolyharmonicSpline(at, broken, {}), InvalidArgument);
}

TEST_CASE("on a smooth surface without noise the deviation is about the error, not many times that") {
  double logarithms = 0;
  for (unsigned seed = 1; seed < 9; ++seed) {
    const PlanePoints at = scattered(150, 0.4, seed), inside = scattered(100, 0, seed + 20) * 0.3;
    const PolyharmonicSpline field(at, over(at, wave), {{2.5, 3.5, 5.5}, 0.1});
    Points up = Points::Zero(100, 3);
    up.col(2).setOnes();
    const Points error = field.positions(rows_of(inside)) - over(inside, wave);
    logarithms += std::log(error.col(2).norm() / field.deviation(inside, up).norm()) / 8;
  }
  CAPTURE(std::exp(logarithms));
  CHECK(logarithms > std::log(0.3));
  CHECK(logarithms < std::log(2));
}

TEST_CASE("at no places a field has no deviation") {
  const PlanePoints at = scattered(100, 0.4, 9);
  CHECK(PolyharmonicSpline(at, over(at, wave), {{2, 3, 4, 5, 6}, 0.1}).deviation(PlanePoints(0, 2), Points(0, 3)).size() == 0);
}
