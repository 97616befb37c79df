// The surface of a fill across creases.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <set>

#include "test_rings.h"
#include "tripatch/creases/creased_fill.h"

using namespace tripatch;
using namespace tripatch::testing;

TEST_CASE("the surface of a fill across creases has its vertices where more than a full turn of faces meets in a point") {
  for (const double slope : {0.5, 0.7, 1.0, 1.5, 2.0}) {  // two ridges and two valleys
    const Rings rings(radii(0.1, 8), [=](double x, double y) { return Vec3(x, y, slope * (std::abs(x) - std::abs(y))); });
    const Features found = rings.features();
    REQUIRE(found.creases.size() == 1);
    REQUIRE(found.creases[0].ends.size() == 4);
    const auto fill = fill_across_creases(rings.mesh(), Connectivity(rings.mesh()), rings.rim, found, {});
    REQUIRE(fill);
    CAPTURE(slope);
    CHECK((fill->surface->positions(as_rows(fill->uv)) - fill->vertices).rowwise().norm().maxCoeff() < 1e-2);
  }
}
