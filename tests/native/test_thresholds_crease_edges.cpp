// How many new edges a crease gets.
#include <catch2/catch.hpp>
#include <cmath>

#include "test_rings.h"
#include "tripatch/creases/creased_fill.h"

using namespace tripatch;
using namespace tripatch::testing;

TEST_CASE("a crease gets as many new edges as its ends' ask for, but no more than the rim has", "[thresholds]") {
  // of the 24 edges of the rim those at the crease's ends are shorter than the mean by `closer`
  const auto edges = [](double closer) {
    const Rings rings(radii(0.1, 8), [=](double x, double y) {
      const double a = std::atan2(y, x), turned = a - closer * std::sin(2 * a) / 2, r = std::hypot(x, y);
      return roof(r * std::cos(turned), y == 0 ? 0 : r * std::sin(turned), 30);
    });
    const auto fill = fill_across_creases(rings.mesh(), Connectivity(rings.mesh()), rings.rim, rings.features(), {});
    return fill ? static_cast<Index>(fill->creases.size()) : -1;
  };
  CHECK(edges(0) == 8);
  CHECK(edges(0.7) == 23);
  CHECK(edges(0.75) == 24);
  CHECK(edges(0.9) == 24);
}
