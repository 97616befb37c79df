#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "tripatch/math/angle.h"

using namespace tripatch;

TEST_CASE("angles between vectors of any length are exact to the last digits, near 0 and 180 degrees too") {
  const Vec3 a(3, 0, 0);
  for (double angle : {0.0, 1e-12, 1e-6, 0.5, std::numbers::pi / 2, 3.0, std::numbers::pi - 1e-6, std::numbers::pi}) {
    INFO(angle);
    const Vec3 b = 1e5 * Vec3(std::cos(angle), 0, -std::sin(angle));
    CHECK(angle_between(a, b) == Approx(angle).epsilon(1e-14).margin(1e-15));
    CHECK(angle_between(b, a) == angle_between(a, b));
    CHECK(degrees_between(a, b) == Approx(angle * 180 / std::numbers::pi).epsilon(1e-14).margin(1e-13));
  }
  CHECK(angle_between(a, Vec3::Zero()) == 0);
}
