// Creases that are followed as far as the mesh is looked at.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "test_rings.h"
#include "tripatch/fill/spline_fill.h"
#include "tripatch/spline/disc.h"

using namespace tripatch;
using namespace tripatch::testing;

TEST_CASE("a crease that is followed over all the rings that are looked at does not get blunt there") {
  for (const double step : {0.004, 0.008})
    CHECK(Rings(radii(step, 60), [](double x, double y) { return roof(x, y, 20); }, 12).features().creases.size() == 1);
}
