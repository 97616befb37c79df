// Which creases continue across a hole, on both sides of each threshold.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "test_rings.h"
#include "tripatch/fill/spline_fill.h"
#include "tripatch/spline/disc.h"

using namespace tripatch;
using namespace tripatch::testing;

TEST_CASE("a crease bends by 25 degrees", "[thresholds]") {
  const auto creases = [](double degrees) {
    return Rings(radii(0.1, 8), [=](double x, double y) { return roof(x, y, degrees / 2); }).features().creases.size();
  };
  CHECK(creases(24.9) == 0);
  CHECK(creases(25.1) == 1);
}

TEST_CASE("a crease of a single edge is as long as a quarter of the hole", "[thresholds]") {
  const auto creases = [](double length) {
    return Rings({0.5, 0.5 + length}, [](double x, double y) { return roof(x, y, 30); }).features().creases.size();
  };
  CHECK(creases(0.248) == 0);
  CHECK(creases(0.252) == 1);
}

TEST_CASE("where all else is smooth a crease is followed to 12.5 degrees", "[thresholds]") {
  Index shortest = 100, longest = 0;
  for (double last = 11.5; last < 14; last += 0.1) {
    const auto lift = [&](double x, double y) {  // 28 degrees at the rim; less with every ring
      const double ring = (std::hypot(x, y) - 0.5) / 0.1;
      const double angle = ring < 6.5 ? 28 + (last - 28) * std::max(ring - 0.5, 0.0) / 6 : std::max(last - 4 * (ring - 6.5), 0.0);
      return roof(x, y, angle / 2);
    };
    const Rings rings(radii(0.1, 9), lift);
    Index sharp = 0;
    while (rings.bend(sharp) > 12.5) ++sharp;
    const Features found = rings.features();
    REQUIRE(found.creases.size() == 1);
    CHECK(static_cast<Index>(found.creases[0].ends[0].chain.size()) == sharp + 1);
    shortest = std::min(shortest, sharp);
    longest = std::max(longest, sharp);
  }
  CHECK(shortest < longest);
}

TEST_CASE("a crease that gets blunt is as long as 0.35 of the hole", "[thresholds]") {
  for (const double length : {0.346, 0.354}) {
    const double step = length / 4;
    const Rings rings(radii(step, 10), [&](double x, double y) {
      const double ring = (std::hypot(x, y) - 0.5) / step;
      return roof(x, y, std::max(14 - (ring < 4.5 ? 1.5 : 2.5) * std::max(ring - 0.5, 0.0), 0.0));
    });
    REQUIRE(rings.bend(3) > 12.5);
    REQUIRE(rings.bend(4) < 12.5);
    CHECK(rings.features().creases.size() == (length < 0.35 ? 0 : 1));
  }
}

TEST_CASE("the ends of a crease bend alike to a factor of three, and their faces lie within 50 degrees", "[thresholds]") {
  // over the width of the hole the roof changes from one end's to the other's
  const auto creases = [](double bend, double other, double turned) {
    return Rings(radii(0.1, 8),
                 [=](double x, double y) {
                   const double s = std::clamp((x + 0.4) / 0.8, 0.0, 1.0);
                   const Vec3 p = roof(x, y, (bend + (other - bend) * s) / 2);
                   const double a = turned * s * std::numbers::pi / 180;
                   return Vec3(p[0], std::cos(a) * p[1] - std::sin(a) * p[2], std::sin(a) * p[1] + std::cos(a) * p[2]);
                 })
        .features()
        .creases.size();
  };
  CHECK(creases(30, 89, 0) == 1);
  CHECK(creases(30, 91, 0) == 0);
  CHECK(creases(60, 60, 49.7) == 1);
  CHECK(creases(60, 60, 50.3) == 0);
}

TEST_CASE("the ends of a crease see each other within 65 degrees", "[thresholds]") {
  for (const double degrees : {64.7, 65.3}) {
    const double slope = std::tan(degrees * std::numbers::pi / 180);
    const Rings rings(radii(0.1, 8), [&](double x, double y) {
      const Vec3 p = roof(x, y, 30);
      return Vec3(p[0], p[1] + slope * std::max(std::abs(x) - 0.5, 0.0), p[2]);
    });
    CHECK(rings.features().creases.size() == (degrees < 65 ? 1 : 0));
  }
}

TEST_CASE("a crease ends where it turns by 45 degrees", "[thresholds]") {
  for (const double degrees : {44.5, 45.5}) {
    const double slope = std::tan(degrees * std::numbers::pi / 180);
    const Rings rings(radii(0.1, 8), [&](double x, double y) {  // turned two edges away from the rim
      const Vec3 p = roof(x, y, 30);
      return Vec3(p[0], p[1] + slope * std::max(std::abs(x) - 0.7, 0.0), p[2]);
    });
    CHECK(rings.features().creases.size() == (degrees < 45 ? 1 : 0));
  }
}

TEST_CASE("a crease is followed over three quarters of the hole", "[thresholds]") {
  for (const double step : {0.0745, 0.0755}) {
    const Features found = Rings(radii(step, 14), [](double x, double y) { return roof(x, y, 30); }).features();
    REQUIRE(found.creases.size() == 1);
    CHECK(found.creases[0].ends[0].chain.size() == (step < 0.075 ? 12 : 11));
  }
}

TEST_CASE("a crease that is followed over all the rings that are looked at does not get blunt there") {
  for (const double step : {0.004, 0.008})
    CHECK(Rings(radii(step, 60), [](double x, double y) { return roof(x, y, 20); }, 12).features().creases.size() == 1);
}

TEST_CASE("surroundings whose border is shorter than 0.7 of the rim close behind the hole", "[thresholds]") {
  for (const double last : {0.345, 0.355}) {
    const Rings tube({0.5, 0.4, 0.3, last}, [](double x, double y) { return Vec3(x, y, 0); });
    const Disc disc = disc_around(tube.mesh(), Connectivity(tube.mesh()), {tube.rim}, 10, 10);
    CHECK(disc.rings == (last < 0.35 ? 2 : 3));  // two are taken in any case
  }
}

TEST_CASE("a fill has the creases that are found in all of a mesh", "[thresholds]") {
  // one that is followed over forty rings, over a sixth of the hole, ends at a vertex whose faces tell whether it runs out there
  const Rings fine(radii(0.004, 60), [](double x, double y) { return roof(x, y, 20); }, 12);
  const Connectivity around(fine.mesh());
  CHECK(fill_with_spline(fine.mesh(), around, fine.rim, {}, {}).feature_edges.empty() == fine.features().creases.empty());
}
