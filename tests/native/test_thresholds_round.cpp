// What decides over discs, on both sides of each threshold; ends that meet are in test_thresholds_inputs.
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

/// A patch of the unit circle between surroundings that lean down by an angle (degrees) and do not bend along their meridians.
RoundBase base_of_circle(double degrees) {
  RoundBase base;
  base.side = circle(0, degrees);
  base.side.q = PiecewisePolynomial::constant(std::array<double, 3>{0, 0, 0});
  base.size = 2;
  base.curvature = true;
  const auto inwards = [&](double t) -> Vec3 { return (base.side.c(t) - base.side.r(t)) / 2; };
  base.terms = {fourier([&](double t) { return base.side.c(t); }, 2), fourier(inwards, 2)};
  return base;
}

}  // namespace

TEST_CASE("quadrics count where a rim's curvatures are between a twentieth and three of a sphere's", "[thresholds]") {
  CHECK(quadrics_count(0.0499) == 0);
  CHECK(quadrics_count(0.0501) > 0);
  CHECK(quadrics_count(0.1) == Approx(0.5));
  CHECK(quadrics_count(0.1499) < 1);
  CHECK(quadrics_count(0.1501) == 1);
}

TEST_CASE("surroundings are of revolution to a millionth of the size", "[thresholds]") {
  CHECK(round_patch(circle(2 * 0.97e-6, 0), {}, 8).of_revolution);
  CHECK_FALSE(round_patch(circle(2 * 1.03e-6, 0), {}, 8).of_revolution);
}

TEST_CASE("slopes at a round rim grow to five times what they are at most, and shrink to a tenth", "[thresholds]") {
  RoundBase base;
  base.side = circle(0, 40);
  base.size = 2;
  base.terms = {fourier([&](double t) { return base.side.c(t); }, 2), Harmonic::Zero(9, 3)};
  FairingOptions options;
  options.degree = 2;
  options.slopes = 1;
  const RoundProblem problem(base, options, 4);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(problem.count());
  x[problem.scalars()] = 1 / base.size;  // alpha grows by 1
  CHECK(base.alpha + problem.reach(x) == Approx(5));
  CHECK(base.alpha - problem.reach(-x) == Approx(0.1));
}

TEST_CASE("caps between the surroundings of a sphere are the sphere's to 8e-8 of the radius", "[thresholds]") {
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

TEST_CASE("what is not known of the curvature at a round rim is tolerated up to a twentieth of it, or a fifth of the meridian's",
          "[thresholds]") {
  const double degrees = 40, parallel = std::sin(degrees * std::numbers::pi / 180), flat = 9e-4 / 4;
  for (const double bend : {0.0, 2.0}) {  // of the meridian; in between no error is both known and without consequence
    const auto cap = [&](double unknown) {
      Side side = circle(0, degrees);
      const double sine = std::sin(degrees * std::numbers::pi / 180), cosine = std::cos(degrees * std::numbers::pi / 180);
      side.q = PiecewisePolynomial::constant(std::array<double, 3>{0, 0, -bend * cosine}) - (bend * sine) * side.c;
      side.curvature_error = unknown / tolerated_deviations;
      return round_patch(side, {}, 12).patch->positions(Points::Zero(1, 3))(0, 2);
    };
    const double most = std::max(0.05 * std::sqrt(bend * bend + parallel * parallel + flat), 0.2 * bend);
    CAPTURE(bend, cap(0), cap(0.9 * most), cap(0.98 * most), cap(1.02 * most), cap(1.2 * most));
    CHECK(cap(0.9 * most) != cap(0.98 * most));
    CHECK(cap(1.02 * most) == cap(1.2 * most));
  }
}

TEST_CASE("surfaces of revolution follow curvature to three tenths of the jump that others are followed to", "[thresholds]") {
  const double squares = std::pow(std::sin(std::numbers::pi * 40 / 180), 2) + 9e-4 / 4;
  const auto top = [](double jump, double unknown) {
    RoundBase base = base_of_circle(40);
    base.side.curvature_error = unknown / tolerated_deviations;
    const std::vector<Harmonic> made = fairest_of_revolution(base, Eigen::Matrix3d::Identity(), Fairing::automatic, jump).value();
    return RoundSurface(made).positions(Points::Zero(1, 3))(0, 2);
  };
  for (const double jump : {0.05, 0.1}) {  // what is not known is tolerated as it is, up to a twentieth
    const auto as_unknown = [&](double share) { return top(0, share * jump * std::sqrt(squares)); };
    CHECK(top(jump, 0) == Approx(as_unknown(0.3)).epsilon(1e-6));
    CHECK(std::abs(top(jump, 0) - as_unknown(0.25)) > 5e-6);
    CHECK(std::abs(top(jump, 0) - as_unknown(0.35)) > 5e-6);
  }
}

TEST_CASE("each jump of curvature that is tolerated weighs a tenth of a quadratic energy", "[thresholds]") {
  const RoundBase base = base_of_circle(40);
  FairingOptions options;
  options.slopes = 0;
  const RoundProblem problem(base, options, 8);
  const Quadratic energy = problem.quadratic(3);
  const auto jumps = [&](const Eigen::VectorXd& x) { return problem.following().jumps(x, nullptr).squaredNorm(); };
  const Eigen::VectorXd x = minimum(problem, energy);
  REQUIRE(energy(x) > 0.01 * energy.constant);
  REQUIRE(jumps(x) > 0.01);
  int tell = 0;
  for (Index k = 0; k < problem.count(); ++k) {
    const Eigen::VectorXd step = 1e-4 * Eigen::VectorXd::Unit(problem.count(), k);
    const double of_energy = energy(x + step) - energy(x - step), of_jumps = jumps(x + step) - jumps(x - step);
    CHECK(std::abs(of_energy + 0.1 * energy.constant * of_jumps) <= 1e-6 * std::abs(of_energy) + 1e-12 * energy.constant);
    tell += std::abs(of_energy) > 1e-9 * energy.constant;
  }
  CHECK(tell > 0);
}
