// What decides over polygons, on both sides of each threshold; corners of domains are in test_thresholds_polygon.
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

Vec3 turned(const Vec3& v, const Vec3& axis, double degrees) {
  return Eigen::AngleAxisd(degrees * std::numbers::pi / 180, axis.normalized()) * v;
}

/// A square of side 1 in the plane.
SideList square() {
  const std::array<Vec3, 4> p = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)};
  SideList sides;
  for (int i = 0; i < 4; ++i) sides.push_back(straight(p[i], p[(i + 1) % 4]));
  return sides;
}

PolygonPatchOptions plain() {
  PolygonPatchOptions options;
  options.fairing.reset();
  return options;
}

}  // namespace

TEST_CASE("a side of a domain is drawn as long as a quarter of the mean at least", "[thresholds]") {
  for (const double given : {0.15, 0.17, 0.19}) {  // two opposite sides of a hexagon that closes as it is
    const PolygonDomain d = polygon_like(std::vector<double>(6, whole / 6), {1, 1, given, 1, 1, given});
    const double drawn = (d.corner(3) - d.corner(2)).norm() / (d.corner(1) - d.corner(0)).norm(), mean = (4 + 2 * given) / 6;
    CHECK(drawn == Approx(std::max(given, 0.25 * mean)).epsilon(1e-9));
  }
}

TEST_CASE("angles of a domain give way where a side would be drawn shorter than 0.4 of its length", "[thresholds]") {
  // between right angles the nearest lengths to 1 and L are both L (L + 1) / (L^2 + 1): 0.4 L at L = 3
  for (const double longer : {2.95, 3.05}) {
    const PolygonDomain d = polygon_like(std::vector<double>(4, whole / 4), {1, 1, longer, 1});
    const double ratio = (d.corner(3) - d.corner(2)).norm() / (d.corner(2) - d.corner(1)).norm();
    CHECK((std::abs(ratio - 1) < 1e-9) == (longer > 3));  // all lengths are 1 then
  }
}

TEST_CASE("a rim that turns back by 179 degrees turns either way and counts as convex", "[thresholds]") {
  for (const double degrees : {178.9, 179.1}) {
    const Vec3 back = turned(Vec3::UnitX(), Vec3::UnitZ(), -degrees), p = Vec3(1, 0, 0), q = p + 0.5 * back;
    const SideList sides = {straight(Vec3::Zero(), p), straight(p, q), straight(q, Vec3(0, 1, 0)),
                            straight(Vec3(0, 1, 0), Vec3::Zero())};
    CHECK(polygon_boundary(sides).turn_deg[1] == Approx(degrees < 179 ? -degrees : degrees));
  }
}

TEST_CASE("a patch has two to twelve sides", "[thresholds]") {
  const auto ring = [](int n) {
    const auto corner = [&](int k) { return Vec3(std::cos(whole * k / n), std::sin(whole * k / n), 0); };
    SideList sides;
    for (int k = 0; k < n; ++k) sides.push_back(straight(corner(k), corner(k + 1 == n ? 0 : k + 1)));
    return sides;
  };
  CHECK_NOTHROW(polygon_patch(ring(12), plain()));
  CHECK_THROWS_AS(polygon_patch(ring(13), plain()), InvalidArgument);
}

TEST_CASE("the four spaces that were asked for last are kept", "[thresholds]") {
  const auto space = [](int k) {
    return polygon_space(polygon_like(std::vector<double>(4, whole / 4), {1, 1, 1, 1}), k, 0, 1, 2);
  };
  std::vector<std::shared_ptr<const PolygonSpace>> made;
  for (int k = 0; k < 4; ++k) made.push_back(space(k));
  CHECK(space(0) == made[0]);
  space(4);
  CHECK(space(0) == made[0]);
  CHECK(space(2) == made[2]);
  CHECK(space(1) != made[1]);
}

TEST_CASE("the seam is measured at a corner whose planes are a millionth of a degree apart, else beside it", "[thresholds]") {
  for (const double degrees : {0.9e-6, 1.1e-6}) {
    SideList sides = square();
    const Vec3 out = sides[1].r(0);
    sides[1].r = line(turned(out, Vec3::UnitY(), degrees), out);
    const PolygonPatch made = polygon_patch(sides, plain());
    CHECK((std::max(made.seam_angle_max[0], made.seam_angle_max[1]) > 1e-7) == (degrees < 1e-6));
  }
}

TEST_CASE("pieces that are joined are run through at an even speed, to 2e-10", "[thresholds]") {
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

TEST_CASE("four sides are a strip where one is three times as long as another: its patch has more unknowns, and less energy",
          "[thresholds]") {
  const auto height = [](double x, double y) { return 0.1 * x * x * x - 0.2 * x * x - 0.4 * y * y + 0.1 * x * y; };
  const auto slope = [](double x, double y) { return Vec2(0.3 * x * x - 0.4 * x + 0.1 * y, -0.8 * y + 0.1 * x); };
  const auto rectangle = [](double length) {
    return std::array{Vec2(-length / 2, -0.5), Vec2(length / 2, -0.5), Vec2(length / 2, 0.5), Vec2(-length / 2, 0.5)};
  };
  SideList sides;
  for (int i = 0; i < 4; ++i) {
    const Vec2 a = rectangle(3)[i], b = rectangle(3)[(i + 1) % 4], way = (b - a).normalized(), out(way[1], -way[0]);
    const auto field = [&](const auto& f) {
      return PiecewisePolynomial::fit(
          [&](std::span<const double> t, std::span<double> values) {
            for (std::size_t k = 0; k < t.size(); ++k) Vec3::Map(&values[3 * k]) = f(Vec2(a + t[k] * (b - a)));
          },
          3);
    };
    sides.push_back({field([&](const Vec2& p) { return Vec3(p[0], p[1], height(p[0], p[1])); }),
                     field([&](const Vec2& p) { return Vec3(out[0], out[1], out.dot(slope(p[0], p[1]))); }),
                     {}});
  }
  const auto energy = [&](double length) {
    const auto corners = rectangle(length);
    PolygonPatchOptions options;
    options.domain = PolygonDomain({corners.begin(), corners.end()});
    return polygon_patch(sides, options).energy_after;
  };
  const double no_strip = energy(2.98), strip = energy(3.02);
  CHECK(no_strip > energy(2.94));
  CHECK(strip < no_strip);
  CHECK(strip < energy(3.06));
}
