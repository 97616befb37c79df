#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <random>

#include "tripatch/boundary/side.h"
#include "tripatch/boundary/smoothed.h"

using namespace tripatch;

namespace {

/// A spline through points of a quarter of a circle, each moved by some noise, as a side has it.
Side arc(int edges, double noise) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal(0, 1);
  Side side;
  std::vector<double> points, across;
  for (int k = 0; k <= edges; ++k) {
    const double t = static_cast<double>(k) / edges, a = 0.5 * std::numbers::pi * t;
    side.rim.push_back(t);
    const double moved = k == 0 || k == edges ? 0 : noise;
    for (double x : {std::cos(a) + moved * normal(random), std::sin(a) + moved * normal(random), moved * normal(random)})
      points.push_back(x);
    for (double x : {0.0, 0.0, -1.0}) across.push_back(x);
  }
  side.c = PiecewisePolynomial::spline(side.rim, points, 3);
  side.r = PiecewisePolynomial::spline(side.rim, across, 3);
  return side;
}

double farthest_from_circle(const PiecewisePolynomial& c) {
  double most = 0;
  for (int k = 0; k <= 200; ++k) most = std::max(most, std::abs(c(k / 200.0).norm() - 1));
  return most;
}

/// Root mean square of the third derivative.
double third(const PiecewisePolynomial& c) {
  double squares = 0;
  for (int k = 0; k < 200; ++k) squares += c.derivative_at((k + 0.5) / 200, 3).squaredNorm() / 200;
  return std::sqrt(squares);
}

}  // namespace

TEST_CASE("the third derivative of a smoothed side is that of the curve and not of the noise of its vertices") {
  const Side noisy = arc(30, 1e-3);
  const Side smooth = smoothed(Sides{noisy, noisy, noisy})[1];
  const double of_circle = std::pow(std::numbers::pi / 2, 3);
  CHECK(third(noisy.c) > 20 * of_circle);
  CHECK(third(smooth.c) < 0.2 * third(noisy.c));
  CHECK(farthest_from_circle(smooth.c) < 5e-3);
}

TEST_CASE("without noise a smoothed side is the same curve, with its ends and their first two derivatives") {
  const Side given = arc(30, 0);
  const Side smooth = smoothed(Sides{given, given, given})[0];
  CHECK(farthest_from_circle(smooth.c) < 1e-5);
  for (const double end : {0.0, 1.0}) {
    CHECK((smooth.c(end) - given.c(end)).norm() < 1e-12);
    CHECK((smooth.c.derivative_at(end) - given.c.derivative_at(end)).norm() < 1e-9);
    CHECK((smooth.c.derivative_at(end, 2) - given.c.derivative_at(end, 2)).norm() < 1e-7);
    CHECK((smooth.r(end) - given.r(end)).norm() < 1e-12);
  }
}

TEST_CASE("a side of few vertices, or of none, stays as it is") {
  for (const int edges : {3, 7}) {
    const Side given = arc(edges, 1e-2);
    const Side same = smoothed(Sides{given, given, given})[2];
    for (int k = 0; k <= 20; ++k) CHECK(same.c(k / 20.0) == given.c(k / 20.0));
  }
  Side without = arc(30, 1e-2);
  without.rim.clear();
  const Side same = smoothed(Sides{without, without, without})[0];
  CHECK(same.c(0.37) == without.c(0.37));
}

TEST_CASE("a side is smoothed the same whichever way it is walked") {
  for (int step = 0; step <= 40; ++step) {
    const double wave = 4e-6 * std::pow(1.1, step);  // of degree 16, which polynomials of lower degree follow where it is seen
    Side side, back;
    std::vector<double> points, across;
    for (int k = 0; k <= 32; ++k) {
      const double t = k / 32.0, inner = 4 * t * (1 - t);
      side.rim.push_back(t);
      for (double x : {inner + 0.2 * t, 0.0, wave * std::pow(inner, 3) * std::cos(10 * std::acos(2 * t - 1))})
        points.push_back(x);
      for (double x : {0.0, -1.0, 0.0}) across.push_back(x);
    }
    side.c = PiecewisePolynomial::spline(side.rim, points, 3);
    side.r = PiecewisePolynomial::spline(side.rim, across, 3);
    back = piece_of(side, 1, 0);
    back.rim = side.rim;
    const Sides both = smoothed(Sides{side, back, side});
    double off = 0;
    for (int k = 0; k <= 100; ++k) off = std::max(off, (both[0].c(k / 100.0) - both[1].c(1 - k / 100.0)).norm());
    CAPTURE(wave, off);
    CHECK(off < 1e-9);
  }
}
