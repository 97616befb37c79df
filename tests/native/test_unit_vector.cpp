#include <catch2/catch.hpp>

#include "tripatch/math/unit_vector.h"

using namespace tripatch;

TEST_CASE("Vectors of any length become unit vectors, zero stays zero") {
  const Vec3 way(2, -6, 9);  // 11 long
  for (double scale : {1e-320, 1e-300, 1e-150, 1e-124, 1e-6, 1.0, 1e6, 1e124, 1e150, 1e300}) {
    CAPTURE(scale);
    const double off = scale < 1e-310 ? 1e-2 : 1e-15;  // so small numbers have few digits
    CHECK((unit_vector(scale * way) - way / 11).norm() < off);
  }
  CHECK(unit_vector(Vec3::Zero()).isZero(0));
}
