// Sides of pieces that are joined.
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "test_surfaces.h"
#include "tripatch/polygon/joined.h"
#include "tripatch/polygon/patch.h"
#include "tripatch/polygon/space.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

PolygonPatchOptions plain() {
  PolygonPatchOptions options;
  options.fairing.reset();
  return options;
}

}  // namespace

TEST_CASE("a patch has two to twelve sides") {
  const auto ring = [](int n) {
    const auto corner = [&](int k) { return Vec3(std::cos(whole * k / n), std::sin(whole * k / n), 0); };
    SideList sides;
    for (int k = 0; k < n; ++k) sides.push_back(straight(corner(k), corner(k + 1 == n ? 0 : k + 1)));
    return sides;
  };
  CHECK_NOTHROW(polygon_patch(ring(12), plain()));
  CHECK_THROWS_AS(polygon_patch(ring(13), plain()), InvalidArgument);
}

TEST_CASE("pieces that are joined are run through at an even speed, to 2e-10") {
  const auto piece = [](double from, double to) {  // of a cubic whose speed grows fivefold
    const auto field = [&](const auto& f) {
      return PiecewisePolynomial::fit(
          [&](std::span<const double> t, std::span<double> out) {
            for (std::size_t k = 0; k < t.size(); ++k) Vec3::Map(&out[3 * k]) = f(from + (to - from) * t[k]);
          },
          3);
    };
    return Side{field([](double x) { return Vec3(x * x * x + 0.2 * x, x * x, 0.3 * std::sin(4 * x)); }),
                field([](double x) { return Vec3(2 * x, -3 * x * x - 0.2, 0); }),
                {}};
  };
  const Side whole = joined({piece(0, 0.5), piece(0.5, 1.3)}).side;
  const double speed = whole.c.derivative_at(0).norm();
  for (int k = 0; k <= 200; ++k) CHECK(whole.c.derivative_at(k / 200.0).norm() == Approx(speed).epsilon(2e-10));
}
