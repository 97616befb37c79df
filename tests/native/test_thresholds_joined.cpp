// Thresholds of sides that are run through by length.
#include <catch2/catch.hpp>

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

}  // namespace

TEST_CASE("a side is run through by length whose speed falls below a quarter of it", "[thresholds]") {
  CHECK(joined({slowing(0.26)}).side.c.derivative_at(0).norm() == Approx(0.26));
  CHECK(joined({slowing(0.24)}).side.c.derivative_at(0).norm() == Approx(1));
  CHECK(joined({slowing(0.24)}).side.c.derivative_at(0.5).norm() == Approx(1));
}
