// What decides about sides that come from normals, on both sides of each threshold.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numbers>

#include "test_refusals.h"
#include "tripatch/boundary/normal_sides.h"

using namespace tripatch;

TEST_CASE("between normals that are 120 degrees apart the derivative across is four times that of their mean, and no more",
          "[thresholds]") {
  for (const double degrees : {110.0, 118.0, 122.0, 130.0}) {
    const double half = degrees * std::numbers::pi / 180 / 2;
    const Vec3 p = Vec3::Zero(), q = Vec3::UnitX();
    const Vec3 np(0, std::sin(half), std::cos(half)), nq(0, -std::sin(half), std::cos(half));
    const Side side = side_from_normals(p, np, q, nq, NormalCurve::smits);
    CHECK(side.r(0.5).norm() == Approx(std::min(1 / std::pow(std::cos(half), 2), 4.0) * std::cos(half)));
  }
}

TEST_CASE("a normal is none that is shorter than normal numbers are", "[thresholds]") {
  const double least = std::numeric_limits<double>::min();
  for (const double length : {0.9 * least, 1.1 * least}) {
    const auto made = [&] {
      side_from_normals(Vec3::Zero(), length * Vec3::UnitZ(), Vec3::UnitX(), Vec3::UnitZ(), NormalCurve::smits);
    };
    if (length < least) {
      CHECK(refusal_code([&] { made(); }) == "normal_zero");
    } else {
      CHECK_NOTHROW(made());
    }
  }
}
