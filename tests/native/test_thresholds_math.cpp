// Ties, and what counts as one place of a parameter: on both sides of each threshold.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "tripatch/math/piecewise_polynomial.h"
#include "tripatch/math/tolerant_compare.h"

using namespace tripatch;

TEST_CASE("numbers are a tie that differ by two parts in a hundred million", "[thresholds]") {
  for (const double size : {1e-9, 1.0, 3e7})
    for (const double apart : {1.9e-8, 2.1e-8}) {
      CHECK(clearly_less((1 - apart) * size, size) == (apart > 2e-8));
      CHECK(clearly_more((1 + apart) * size, size) == (apart > 2e-8));
      CHECK(at_least((1 - apart) * size, size) == (apart < 2e-8));
    }
  const double none = std::numeric_limits<double>::quiet_NaN();
  CHECK_FALSE((clearly_less(none, 1) || clearly_more(none, 1) || at_least(none, 1)));
}

TEST_CASE("a key to sort by has sixteen binary digits", "[thresholds]") {
  CHECK(coarse(1 + 0.9 / (1 << 16)) == 1);
  CHECK(coarse(1 + 1.1 / (1 << 16)) > 1);
  CHECK(coarse(3e5 * (1 + 1.1 / (1 << 15))) > coarse(3e5));
}

TEST_CASE("breaks of two fields are one that are a million-millionth apart", "[thresholds]") {
  for (const double apart : {0.9e-12, 1.1e-12}) {
    const auto broken = [](double at) { return PiecewisePolynomial({0, at, 1}, 1, 1, {0, 1, 1, 2}); };
    CHECK((broken(0.5) + broken(0.5 + apart)).pieces() == (apart < 1e-12 ? 2 : 3));
  }
}
