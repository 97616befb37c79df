#include <catch2/catch.hpp>
#include <limits>

#include "tripatch/output/fill_result.h"

using namespace tripatch;

TEST_CASE("a fill is refused where any position or normal of its own, at its rim or of what it moves is not finite") {
  Fill fill;
  for (Points Fill::* points : {&Fill::vertices, &Fill::normals, &Fill::rim_normals, &Fill::moved_to})
    fill.*points = Points::Ones(2, 3);
  CHECK(is_finite(fill));
  CHECK_NOTHROW(refuse_infinite(fill, {7, 8, 9}));
  for (Points Fill::* points : {&Fill::vertices, &Fill::normals, &Fill::rim_normals, &Fill::moved_to})
    for (double value : {std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::infinity()}) {
      Fill spoiled = fill;
      (spoiled.*points)(1, 2) = value;
      CHECK(!is_finite(spoiled));
      try {
        refuse_infinite(spoiled, {7, 8, 9});
        FAIL("it was not refused");
      } catch (const Refusal& refusal) {
        CHECK(refusal.where() == std::vector<Index>{7});
      }
    }
}
