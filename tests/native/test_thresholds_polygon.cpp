// What decides between n sides, on both sides of each threshold.
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "test_refusals.h"
#include "test_surfaces.h"
#include "tripatch/boundary/poles.h"
#include "tripatch/polygon/boundary.h"
#include "tripatch/polygon/domain.h"
#include "tripatch/polygon/joined.h"
#include "tripatch/polygon/round.h"
#include "tripatch/report/report.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

/// Whether domains of four sides are the same whose first turns are these (radians), the others alike.
bool same_domain(double first, double second) {
  const auto domain = [](double turn) {
    const double other = (whole - std::clamp(turn, 0.2, 2.6)) / 3;
    return polygon_like({turn, other, other, other}, {1, 1, 1, 1});
  };
  return (domain(first).corner(0) - domain(second).corner(0)).norm() < 1e-12;
}

bool same_lens(double first, double second) {
  const auto height = [](double turn) { return lens_like({turn, turn}).height(); };
  return height(first) == height(second);
}

/// A circle whose surroundings fall away by 0.3, and by so much more and less twice round it.
Side circle(double uneven) {
  Harmonic curve = Harmonic::Zero(3, 3), across = Harmonic::Zero(5, 3);
  curve.topLeftCorner<3, 2>() << 0, 0, 1, 0, 0, 1;
  across.topRows<3>() = curve;
  across(0, 2) = -0.3;
  across(3, 2) = uneven;
  return {around_circle(curve), around_circle(across), {}};
}

}  // namespace

TEST_CASE("slopes are of revolution that are uneven by less than a ten-thousandth of the size", "[thresholds]") {
  CHECK(round_patch(circle(0)).of_revolution);
  CHECK(round_patch(circle(3.9e-4)).of_revolution);
  CHECK_FALSE(round_patch(circle(4.7e-4)).of_revolution);
}

TEST_CASE("corners of a domain turn by 0.2 to 2.6 radians, those of a lens by pi - 1.8 and more", "[thresholds]") {
  CHECK(same_domain(0.15, 0.199));
  CHECK_FALSE(same_domain(0.199, 0.203));
  CHECK(same_domain(2.605, 2.7));
  CHECK_FALSE(same_domain(2.57, 2.6));
  const double widest = std::numbers::pi - 1.8;
  CHECK(same_lens(0.9, widest - 0.001));
  CHECK_FALSE(same_lens(widest, widest + 0.01));
  CHECK(same_lens(2.605, 2.9));
  CHECK_FALSE(same_lens(2.59, 2.6));
}

TEST_CASE("planes have a pole at an end that turn by two degrees in the last piece, and ten times as much as before",
          "[thresholds]") {
  // planes about a straight side that turn evenly by `before` degrees a piece, and by `last` in the last one
  const auto mended = [](double last, double before, bool at_start) {
    const auto turned = [&](double t) {
      const double pieces = 256 * (at_start ? t : 1 - t), degree = std::numbers::pi / 180;
      const double angle = degree * (before * pieces + (pieces < 1 ? (last - before) * (pieces - 1) : 0));
      return Vec3(0, -std::cos(angle), std::sin(angle));
    };
    Side side = straight(Vec3::Zero(), Vec3::UnitX());
    side.r = PiecewisePolynomial::fit(
        [&](std::span<const double> t, std::span<double> out) {
          for (std::size_t k = 0; k < t.size(); ++k) Vec3::Map(&out[3 * k]) = turned(t[k]);
        },
        3);
    const Side after = without_poles(side);
    const double end = at_start ? 0 : 1;
    const bool same = (after.r(end) - side.r(end)).norm() == 0;
    // continued as evenly as it turned
    const Vec3 even(0, -1, 0);
    if (!same) CHECK((after.r(end) - even).norm() < 2e-4);  // to the third power of the angle
    CHECK((after.r(0.5) - side.r(0.5)).norm() < 1e-12);
    return !same;
  };
  for (const bool at_start : {false, true}) {
    CHECK(mended(2.05, 0.1, at_start));
    CHECK_FALSE(mended(1.95, 0.1, at_start));
    CHECK(mended(30, 2.9, at_start));
    CHECK_FALSE(mended(30, 3.1, at_start));
  }
}

TEST_CASE("a polygon that is given turns at its corners by a thousandth", "[thresholds]") {
  for (const double sine : {0.98e-3, 1.02e-3}) {
    const auto made = [&] { return PolygonDomain({{-1, 0}, {0, -0.5 * sine}, {1, 0}, {0, 1}}); };
    if (sine < 1e-3) {
      CHECK_THROWS_WITH(made(), Catch::Contains("straight angles"));
    } else {
      CHECK_NOTHROW(made());
    }
  }
}

TEST_CASE("sides of a polygon meet whose ends are a millionth of the size apart", "[thresholds]") {
  for (const double gap : {0.99e-6, 1.01e-6}) {
    const std::array<Vec3, 4> p = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)};
    SideList sides;
    for (int i = 0; i < 4; ++i) sides.push_back(straight(p[i], p[(i + 1) % 4]));
    sides[1] = moved_ends(sides[1], Vec3(0, 0, gap * std::sqrt(2.0)), Vec3::Zero());
    if (gap < 1e-6) {
      CHECK_NOTHROW(closed(sides));
    } else {
      CHECK(refusal_code([&] { closed(sides); }) == "sides_apart");
    }
  }
}

TEST_CASE("pieces are one side that meet within a millionth of its length and ten degrees", "[thresholds]") {
  const auto second = [](double degrees, double gap) {
    const double a = degrees * std::numbers::pi / 180;
    return straight(Vec3(1, 0, gap), Vec3(1 + std::cos(a), std::sin(a), gap));
  };
  const Side first = straight(Vec3(0, 0, 0), Vec3(1, 0, 0));
  CHECK_NOTHROW(joined({first, second(9.9, 0)}, {}));
  CHECK(refusal_code([&] { joined({first, second(10.1, 0)}, {}); }) == "pieces_meet_at_angle");
  CHECK_NOTHROW(joined({first, second(0, 2 * 0.99e-6)}, {}));
  CHECK(refusal_code([&] { joined({first, second(0, 2 * 1.01e-6)}, {}); }) == "pieces_apart");
  // nor may their planes turn
  Side turned = second(0, 0);
  const auto across = [](double degrees) -> Vec3 {
    return Eigen::AngleAxisd(degrees * std::numbers::pi / 180, Vec3::UnitX()) * Vec3(-Vec3::UnitY());
  };
  turned.r = line(across(9.9), across(9.9));
  CHECK_NOTHROW(joined({first, turned}, {}));
  turned.r = line(across(10.1), across(10.1));
  CHECK(refusal_code([&] { joined({first, turned}, {}); }) == "pieces_meet_at_angle");
}

TEST_CASE("two planes at a corner are told from one degree between them on", "[thresholds]") {
  Report report;
  const std::array<Index, 2> corners = {0, 1};
  take_corners({5, 7, 9}, corners, report);
  report.corner_planes_angle = report.corner_normals_spread = {0.99, 1.01};
  tell_corners(report);
  REQUIRE(report.warnings.size() == 1);
  CHECK_THAT(report.warnings[0].text(), Catch::Contains("differ by 1 degrees at corner 1 (vertex 7)"));
}

TEST_CASE("where a side of two turns away from the other its ribbon leads into the hole all along") {
  const auto field = [](const std::array<double, 9>& net) { return PiecewisePolynomial::bezier(net, 3); };
  const std::array<double, 9> up = {0, 1, 0, 0, 1, 0, 0, 1, 0};
  // in the middle of the first side the surroundings rise and lean over the hole
  const Side first = {field({-1, 0, 0, 0, -1, 0, 1, 0, 0}), field({0, -1, 0, 0, 2.6, 1.2, 0, -1, 0}), {}};
  const Side second = {field({1, 0, 0, 0, 1, 0, -1, 0, 0}), field(up), {}};
  const PolygonBoundary boundary = polygon_boundary({first, second});
  for (const PolygonRibbon& ribbon : boundary.ribbons)
    for (int k = 0; k <= 10; ++k) {
      double alpha = 0;
      ribbon.alpha.taylor(k / 10.0, 0, &alpha);
      CHECK(alpha > 0);
    }
}
