// How many new edges a crease gets.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <set>

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

namespace {

/// New points of a straight crease, from 0 at one end to 1 at the other, by their places on it. Next to each end are two edges of the rim, the first of
/// `first` of the rim's other edges, the second of `second`.
std::vector<double> along_crease(double first, double second) {
  const Rings rings(radii(0.1, 8), [=](double x, double y) {
    const double a = std::atan2(y, x), step = std::numbers::pi / 12, r = std::hypot(x, y), beside = std::abs(a);
    double turned = a;
    if (beside > 0.5 * step && beside < 1.5 * step) turned = std::copysign(first * step, a);
    if (beside > 10.5 * step && beside < 11.5 * step) turned = std::copysign(std::numbers::pi - second * step, a);
    return roof(r * std::cos(turned), y == 0 ? 0 : r * std::sin(turned), 30);
  });
  const auto fill = fill_across_creases(rings.mesh(), Connectivity(rings.mesh()), rings.rim, rings.features(), {});
  REQUIRE(fill);
  const Index given = static_cast<Index>(rings.rim.size());
  std::set<double> places;
  for (const auto& [a, b] : fill->creases)
    for (const Index v : {a, b})
      if (v >= given) places.insert(0.5 - fill->vertices(v - given, 0));
  return {places.begin(), places.end()};
}

}  // namespace

TEST_CASE("edges along a crease are alike where those at its ends are to a millionth", "[thresholds]") {
  for (const double differ : {0.9e-6, 1.1e-6, -0.9e-6, -1.1e-6}) {
    const std::vector<double> places = along_crease(1, 1 + differ);
    REQUIRE(places.size() == 7);
    CAPTURE(differ, places[3] - 0.5);
    CHECK((std::abs(places[3] - 0.5) < 1e-9) == (std::abs(differ) < 1e-6));
  }
}

TEST_CASE("edges at a crease's ends count as a millionth of the rim at least", "[thresholds]") {
  const auto middle = [](double share) {
    const std::vector<double> places = along_crease(share * 24, 1);
    REQUIRE(places.size() == 23);
    return places[11];
  };
  CHECK(middle(0.4e-6) == Approx(middle(0.8e-6)).epsilon(1e-6));
  CHECK(middle(1.2e-6) < 0.8 * middle(2.4e-6));
}

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
