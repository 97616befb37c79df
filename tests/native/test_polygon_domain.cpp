#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <vector>

#include "tripatch/polygon/domain.h"

using namespace tripatch;

TEST_CASE("polygon domain: a point moved off a corner lies so far from it, on its ray") {
  const PolygonDomain lens = PolygonDomain::lens(3, 0.5), triangle({Vec2(0, 0), Vec2(2, 0), Vec2(0.5, 1.5)});
  for (const double part : {-0.8, 0.0, 0.5})
    for (int i : {0, 1}) {
      const double s = i == 0 ? 0.01 : 0.99;
      const Vec2 p(3 * s - 1.5, part * 4 * 0.5 * s * (1 - s)), off = lens.moved_off(i, p, 0.1) - lens.corner(i);
      CHECK(off.norm() == Approx(0.1 * lens.radius()).epsilon(0.05));  // along a parabola
      CHECK(off.normalized().dot((p - lens.corner(i)).normalized()) > 0.995);
    }
  for (int i = 0; i < 3; ++i) {
    const Vec2 p = triangle.corner(i) + 0.01 * (triangle.center() - triangle.corner(i)),
               off = triangle.moved_off(i, p, 0.1) - triangle.corner(i);
    CHECK(off.norm() == Approx(0.1 * triangle.radius()));
    CHECK(off.normalized().dot((p - triangle.corner(i)).normalized()) == Approx(1));
  }
}

TEST_CASE(
    "polygon domain: the bubble is 1 at the center of a regular polygon, nothing at all sides, and what a place says of it") {
  std::vector<Vec2> corners;
  for (int k = 0; k < 5; ++k)
    corners.emplace_back(std::cos(2 * std::numbers::pi * k / 5), std::sin(2 * std::numbers::pi * k / 5));
  for (const PolygonDomain& d : {PolygonDomain(corners), PolygonDomain({Vec2(0, 0), Vec2(2, 0.1), Vec2(2.2, 1.5), Vec2(-0.3, 1)}),
                                 PolygonDomain::lens(3, 0.5)}) {
    const auto at = [&](const Vec2& p) { return d.bubble(Jet<2>::linear(p[0], 1, 0), Jet<2>::linear(p[1], 0, 1)); };
    if (d.sides() != 4) CHECK(at(d.center()).value() == Approx(1));
    for (int i = 0; i < d.sides(); ++i)
      for (const double t : {0.1, 0.5, 0.8}) {
        CHECK(std::abs(at(d.on_side(i, t)).value()) < 1e-14);
        const Vec2 p = d.center() + 0.7 * (d.on_side(i, t) - d.center());
        const Jet<2> in_place = d.place(Jet<2>::linear(p[0], 1, 0), Jet<2>::linear(p[1], 0, 1)).bubble, alone = at(p);
        for (Index c = 0; c < Jet<2>::size; ++c) CHECK(alone.c[c] == Approx(in_place.c[c]));
        CHECK(alone.value() > 0);
      }
  }
}
