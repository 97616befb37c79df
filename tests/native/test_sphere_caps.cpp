// Caps of spheres.
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "test_surfaces.h"
#include "tripatch/fairing/curvature_following.h"
#include "tripatch/fairing/descent.h"
#include "tripatch/polygon/round.h"
#include "tripatch/polygon/round_problem.h"
#include "tripatch/polygon/surface_of_revolution.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

/// A unit circle with a wave of two periods so high, its surroundings leaning down by an angle (degrees).
Side circle(double wave, double degrees) {
  const auto field = [](const auto& f) {
    return PiecewisePolynomial::fit(
        [&](std::span<const double> t, std::span<double> out) {
          for (std::size_t k = 0; k < t.size(); ++k) Vec3::Map(&out[3 * k]) = f(whole * t[k]);
        },
        3);
  };
  const double lean = degrees * std::numbers::pi / 180;
  return {field([&](double a) { return Vec3(std::cos(a), std::sin(a), wave * std::cos(2 * a)); }),
          field([&](double a) { return Vec3(std::cos(lean) * std::cos(a), std::cos(lean) * std::sin(a), -std::sin(lean)); }),
          {}};
}

}  // namespace

TEST_CASE("caps between the surroundings of a sphere are the sphere's to 8e-8 of the radius") {
  for (const double degrees : {20, 60, 85})
    for (const bool bends : {false, true}) {
      Side side = circle(0, degrees);
      const double sine = std::sin(degrees * std::numbers::pi / 180);
      if (bends)
        side.q = (-sine * sine) * side.c +
                 PiecewisePolynomial::constant(std::array<double, 3>{0, 0, -sine * std::cos(degrees * std::numbers::pi / 180)});
      const RoundPatch made = round_patch(side, {}, 12);
      CHECK(std::abs(made.patch->positions(Points::Zero(1, 3))(0, 2) - std::tan(degrees * std::numbers::pi / 360)) < 8e-8);
    }
}
