// Thresholds of patches past hooks of their sides.
#include <catch2/catch.hpp>
#include <cmath>

#include "tripatch/polygon/surface.h"

using namespace tripatch;

namespace {

/// A square with sides of length 1 in the plane, whose first side turns its plane by `twist` a length where it begins.
SideList twisted_square(double twist) {
  const std::vector<Vec3> corner = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  SideList sides(4);
  for (int i = 0; i < 4; ++i) {
    const Vec3 from = corner[i], to = corner[(i + 1) % 4], along = to - from, out(along[1], -along[0], 0);
    std::vector<double> line = {from[0], from[1], from[2], to[0], to[1], to[2]}, across;
    for (int k = 0; k < 4; ++k)  // twist t (1 - t)^2 upwards
      for (int x = 0; x < 3; ++x) across.push_back(out[x] + (i == 0 && k == 1 && x == 2 ? twist / 3 : 0));
    sides[i].c = PiecewisePolynomial::bezier(line, 3);
    sides[i].r = PiecewisePolynomial::bezier(across, 3);
  }
  return sides;
}

/// How high the corner patch lies next to its first corner, for each unit of the twist, on the diagonal or off it.
double height(double twist, const Vec2& share) {
  PolygonRibbonOptions options;
  options.past_hooks = true;
  const PolygonBoundary boundary = polygon_boundary(twisted_square(twist), options);
  const Vec2 corner = boundary.domain.corner(0);
  const Points at = (Points(1, 3) << share[0] * corner[0], share[1] * corner[1], 0).finished();
  return corner_blend(boundary)->positions(at)(0, 2) / twist;
}

}  // namespace

TEST_CASE("a twist of four lengths of its side is that of a hook, and not met halfway", "[thresholds]") {
  const Vec2 diagonal(0.98, 0.98);
  const double halfway = height(1, diagonal);
  CHECK(height(3.9, diagonal) == Approx(halfway).epsilon(1e-6));
  CHECK(std::abs(height(4.1, diagonal) / halfway - 1) > 0.05);
}

TEST_CASE("what is left of a twist comes to a fifth of a side at most, or dies away as fast as degree 40 lets it",
          "[thresholds]") {
  const Vec2 beside(0.98, 0.9);
  // half of the twist is left: as a cubic up to 2 * 0.2 * 3 e
  CHECK(height(3.2, beside) == Approx(height(1, beside)).epsilon(1e-6));
  CHECK(std::abs(height(3.3, beside) / height(1, beside) - 1) > 1e-3);
  // past a hook all of it: of degree 40 from 0.2 * 39 e on
  CHECK(std::abs(height(20.9, beside) / height(21.5, beside) - 1) > 1e-4);
  CHECK(height(40, beside) == Approx(height(21.5, beside)).epsilon(1e-6));
}
