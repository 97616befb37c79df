#include <catch2/catch.hpp>

#include "tripatch/math/smoothstep.h"

using namespace tripatch;

TEST_CASE("smoothstep goes from 0 to 1 with no slope at its ends and is one half in the middle") {
  CHECK(smoothstep(-1) == 0);
  CHECK(smoothstep(0) == 0);
  CHECK(smoothstep(0.5) == 0.5);
  CHECK(smoothstep(1) == 1);
  CHECK(smoothstep(2) == 1);
  const double h = 1e-4;
  CHECK(smoothstep(h) < 3.1 * h * h);
  CHECK(1 - smoothstep(1 - h) < 3.1 * h * h);
  for (double x = 0.05; x < 1; x += 0.05) {
    CHECK(smoothstep(x) > smoothstep(x - 0.05));
    CHECK(smoothstep(x) + smoothstep(1 - x) == Approx(1).epsilon(1e-14));
  }
}
