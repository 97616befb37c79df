// What numbers weigh that decide nothing by themselves, by the identities that they stand for.
#include <cmath>
#include <numbers>

#include "test_surfaces.h"
#include "tripatch/constructions/side_vertex.h"
#include "tripatch/fairing/candidates.h"
#include "tripatch/fairing/curvature_following.h"
#include "tripatch/fairing/energy.h"
#include "tripatch/fairing/fairing_problem.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

/// Sides, one of them followed, of which everything is the same at all points: a jump of 1 on forms of squared norm 2.
CurvatureFollowing alike(const SideBasis& basis, double curvature_error, double tolerance) {
  FollowedSide side = {0, 0, {1, 1}, curvature_error, {}, {}, {}, {}, {}, {}};
  for (int k = 0; k < SideBasis::points; ++k) {
    side.form[k].n = Vec3::UnitZ(), side.form[k].r = Vec3::UnitX(), side.form[k].dc = Vec3::UnitY();
    side.form[k].rr = side.form[k].cc = 1, side.form[k].rc = 0;
    side.alpha[k] = side.beta[k] = side.skew[k] = 0;
    side.base[k] = side.weight[k] = 1;
  }
  return {basis, {side}, 1, 1, tolerance};
}

SideBasis without_unknowns() {
  SideBasis basis({});
  basis.slope = Eigen::MatrixXd(SideBasis::points, 0);
  basis.second = {Eigen::MatrixXd(SideBasis::points, 0)};
  return basis;
}

/// Of points or directions along a side, the third coordinate so many times as high.
PiecewisePolynomial lifted(const PiecewisePolynomial& field, double higher) {
  if (field.empty() || higher == 1) return field;
  return PiecewisePolynomial::fit(
      [&](std::span<const double> t, std::span<double> out) {
        for (std::size_t k = 0; k < t.size(); ++k) Vec3::Map(&out[3 * k]) = field(t[k]).cwiseProduct(Vec3(1, 1, higher));
      },
      3);
}

/// higher: times as high as they are.
FairingBase waves(double higher = 1) {
  FairingBase base;
  base.sides = sides_of(wave());
  for (Side& side : base.sides)
    for (PiecewisePolynomial* field : {&side.c, &side.r, &side.q}) *field = lifted(*field, higher);
  base.boundary = make_boundary(base.sides);
  base.patch = side_vertex(base.boundary);
  return base;
}

/// What a descent is led by over the waves.
struct OverWaves {
  explicit OverWaves(double higher = 1) : base(waves(higher)) {}
  FairingBase base;
  FairingOptions options;
  FairingProblem problem{base, options, 5};
  Quadratic third = problem.quadratic(3);
  Merit merit = merit_of(problem, third);
  Eigen::VectorXd start = Eigen::VectorXd::Zero(problem.count());
};

}  // namespace

TEST_CASE("the soft minimum of two energies is that of the first and ten times the second", "[thresholds]") {
  CHECK(soft_minimum(10, 1) == Approx(10 / std::pow(2, 0.25)).epsilon(1e-12));
  CHECK(soft_minimum(1e-3, 1) == Approx(1e-3).epsilon(1e-12));
  CHECK(soft_minimum(1e5, 1) == Approx(10).epsilon(1e-12));
}

TEST_CASE("a tenth of the third derivatives' logarithm is added to an energy's", "[thresholds]") {
  const OverWaves d;
  const Merit::Value v = d.merit(d.start);
  REQUIRE(v.third > 0);
  REQUIRE(std::abs(std::log(v.third)) > 0.1);
  CHECK(v.log == Approx(std::log(v.energy) + 0.1 * std::log(v.third)).epsilon(1e-12));
}

TEST_CASE("descent ends with the first step that gains less than a hundredth", "[thresholds]") {
  const OverWaves d;
  const auto after = [&](int steps) {  // how many were made, and where they led
    Eigen::VectorXd x = d.start;
    Merit::Value value = d.merit(x);
    const int made = descend(d.merit, d.third.normal, x, value, steps);
    return std::pair(made, value.log);
  };
  const int last = after(100).first;
  REQUIRE(last > 2);
  REQUIRE(last < 100);
  for (int k = 1; k <= last; ++k) CHECK((after(k - 1).second - after(k).second < 0.01) == (k == last));
}

TEST_CASE("descent ends where an energy is a ten-thousandth", "[thresholds]") {
  const auto after = [](double higher, int steps) {
    const OverWaves d(higher);
    Eigen::VectorXd x = d.start;
    Merit::Value value = d.merit(x);
    const int made = descend(d.merit, d.third.normal, x, value, steps);
    return std::tuple(made, value.energy, value.log);
  };
  double higher = 0.01;
  for (int k = 0; k < 10; ++k) higher *= std::sqrt(1e-4 / std::get<1>(after(higher, 1)));  // after a step it is that
  for (const double share : {0.95, 1.05}) {
    const auto [made, energy, log] = after(share * higher, 100);
    CAPTURE(higher, made, energy);
    CHECK((made == 1) == (share < 1));
  }
}

TEST_CASE("curvature counts a twentieth more than like a sine along a side, in all as much as a mean square", "[thresholds]") {
  const SideBasis basis = without_unknowns();
  const Eigen::VectorXd jumps = alike(basis, 0, 1).jumps(Eigen::VectorXd(0), nullptr);
  const auto share = [&](int k) { return 0.05 + std::sin(std::numbers::pi * basis.t[k]); };
  for (int k = 1; k < SideBasis::points; ++k)
    CHECK(jumps[k] * jumps[k] / (jumps[0] * jumps[0]) == Approx(share(k) / share(0)).epsilon(1e-12));
  CHECK(jumps.squaredNorm() == Approx(1 / (2 + flat_curvature(1))).epsilon(1e-12));
}

TEST_CASE("what a mesh does not know of the curvature is tolerated three times over", "[thresholds]") {
  const SideBasis basis = without_unknowns();
  for (const double error : {0.5, 2.0})
    CHECK(alike(basis, error, 0).jumps(Eigen::VectorXd(0), nullptr).norm() == Approx(1 / (3 * error)).epsilon(1e-12));
}

TEST_CASE("a slope may shrink to a tenth of what it was", "[thresholds]") {
  const auto constant = [](double value) { return PiecewisePolynomial::linear(value, value); };
  CHECK(alpha_reach(constant(2), constant(-1)) == Approx(1.8));
}
