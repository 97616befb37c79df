#include <catch2/catch.hpp>

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
