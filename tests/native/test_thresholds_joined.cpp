// Thresholds of sides that are run through by length.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "tripatch/polygon/joined.h"

using namespace tripatch;

namespace {

/// Straight, of length 1, from the speed `slowest` on, which grows evenly; the surface is the plane.
Side slowing(double slowest) {
  Side side;
  side.c = PiecewisePolynomial::bezier(std::vector<double>{0, 0, 0, slowest / 2, 0, 0, 1, 0, 0}, 3);
  side.r = PiecewisePolynomial::bezier(std::vector<double>{0, -1, 0}, 3);
  return side;
}

/// The same, by a speed whose logarithm changes at this rate.
Side hastening(double rate) {
  Side side = slowing(1);
  side.c = PiecewisePolynomial::fit(
      [&](std::span<const double> t, std::span<double> out) {
        for (std::size_t k = 0; k < t.size(); ++k)
          Vec3::Map(&out[3 * k]) = Vec3(std::expm1(rate * t[k]) / std::expm1(rate), 0, 0);
      },
      3);
  return side;
}

}  // namespace

TEST_CASE("all sides of a patch are run through by length where the speed of one changes quickly", "[thresholds]") {
  const auto fastest = [](const SideList& sides) {
    double most = 0;
    for (const Side& side : sides) most = std::max(most, side.c.derivative_at(1).norm());
    return most;
  };
  CHECK(fastest(evenly_run({hastening(0.44), hastening(0.2)})) == Approx(fastest({hastening(0.44)})));
  CHECK(fastest(evenly_run({hastening(0.46), hastening(0.2)})) == Approx(1));
  CHECK(fastest(evenly_run({hastening(-0.46), hastening(0.2)})) == Approx(1));
}

TEST_CASE("a side is run through by length whose speed falls below a quarter of it", "[thresholds]") {
  CHECK(joined({slowing(0.26)}).side.c.derivative_at(0).norm() == Approx(0.26));
  CHECK(joined({slowing(0.24)}).side.c.derivative_at(0).norm() == Approx(1));
  CHECK(joined({slowing(0.24)}).side.c.derivative_at(0.5).norm() == Approx(1));
}
