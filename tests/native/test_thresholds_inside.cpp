// Points inside that a patch shall meet, on both sides of what decides about them.
#include <cmath>
#include <numbers>

#include "test_refusals.h"
#include "test_surfaces.h"
#include "tripatch/polygon/patch.h"
#include "tripatch/polygon/round.h"

using namespace tripatch;

namespace {

PiecewisePolynomial field(const std::function<Vec3(double)>& f) {
  return PiecewisePolynomial::fit(
      [&](std::span<const double> t, std::span<double> out) {
        for (std::size_t k = 0; k < t.size(); ++k) Vec3::Map(&out[3 * k]) = f(t[k]);
      },
      3);
}

/// A flat square, its corners at a distance of 1 from the middle.
SideList square() {
  SideList sides;
  for (int i = 0; i < 4; ++i) {
    const auto corner = [](int k) { return Vec3(std::cos(k * std::numbers::pi / 2), std::sin(k * std::numbers::pi / 2), 0); };
    const Vec3 a = corner(i), b = corner(i + 1), out = (b - a).cross(Vec3::UnitZ());
    sides.push_back({field([=](double t) { return Vec3(a + t * (b - a)); }), field([=](double) { return out; }), {}});
  }
  return sides;
}

Side circle() {
  const auto at = [](double t) { return Vec3(std::cos(2 * std::numbers::pi * t), std::sin(2 * std::numbers::pi * t), 0); };
  return {field(at), field(at), {}};
}

PolygonPatchOptions plain(const std::vector<Through>& through) {
  PolygonPatchOptions options;
  options.fairing.reset();
  options.through = through;
  return options;
}

}  // namespace

TEST_CASE("points are met at a fiftieth of the radius or more from the sides of a polygon", "[thresholds]") {
  const double middle = std::sqrt(0.5);  // of a side, from the middle of the square
  for (const double inside : {0.019, 0.021, 0.2}) {
    const double share = (middle - inside) / middle;
    const Vec3 point(0.5 * share, 0.5 * share, 0);
    const PolygonPatch made = polygon_patch(square(), plain({{point, {}}}));
    double least = 1;
    for (int i = 0; i < 4; ++i) least = std::min(least, made.domain.phi(i, made.met[0]) / made.domain.radius());
    CHECK(least >= 0.02);
    CHECK((std::abs(least - inside) < 1e-9) == (inside > 0.02));
  }
}

TEST_CASE("points are met within 0.98 of the radius of a disc", "[thresholds]") {
  for (const double radius : {0.5, 0.975, 0.985}) {
    const RoundPatch made = round_patch(circle(), plain({{Vec3(0, radius, 0), {}}}), 8);
    CHECK(made.met[0].norm() == Approx(std::min(radius, 0.98)).epsilon(1e-3));
  }
}

TEST_CASE("two points in one place are met that are a millionth of the size apart", "[thresholds]") {
  for (const double share : {0.97e-6, 1.03e-6}) {
    const auto points = [&](double size) {  // each is missed by half of the gap
      const double gap = std::sqrt(2.0) * share * size;
      return plain({{Vec3(0.1, 0.2, 0), {}}, {Vec3(0.1, 0.2, gap), {}}});
    };
    const auto polygon = [&] { polygon_patch(square(), points(2)); };
    const auto disc = [&] { round_patch(circle(), points(2), 8); };
    if (share < 1e-6) {
      CHECK_NOTHROW(polygon());
      CHECK_NOTHROW(disc());
    } else {
      CHECK(refusal_code([&] { polygon(); }) == "points_in_one_place");
      CHECK(refusal_code([&] { disc(); }) == "points_in_one_place");
    }
  }
}
