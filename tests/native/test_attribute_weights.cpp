#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "tripatch/output/attribute_weights.h"

using namespace tripatch;

namespace {

/// r points of an ellipse.
Values ellipse(Index r) {
  Values rim(r, 2);
  for (Index k = 0; k < r; ++k) rim.row(k) << 2 * std::cos(2 * std::numbers::pi * k / r), std::sin(2 * std::numbers::pi * k / r);
  return rim;
}

Values at_ends(const Values& rim) {
  Values ends(2 * rim.rows(), rim.cols());
  for (Index e = 0; e < rim.rows(); ++e) {
    ends.row(2 * e) = rim.row(e);
    ends.row(2 * e + 1) = rim.row((e + 1) % rim.rows());
  }
  return ends;
}

}  // namespace

TEST_CASE("Attribute weights: linear functions come back, on one thread and on several") {
  const Index k = 20000;  // several threads' worth
  Values inside(k, 3), rim(6, 3);
  rim << 1, 0, 0, .3, .7, 0, 0, 1, 0, 0, .5, .5, 0, 0, 1, .4, 0, .6;
  for (Index i = 0; i < k; ++i) {
    const double a = std::fmod(i * 0.618, 1.0), b = (1 - a) * std::fmod(i * 0.414, 1.0);
    inside.row(i) << a, b, 1 - a - b;
  }
  const AttributeWeights weights(rim, inside);
  CHECK((weights.blend(at_ends(rim)) - inside).cwiseAbs().maxCoeff() < 1e-14);
  const AttributeWeights first(rim, inside.topRows(10));
  CHECK((first.blend(at_ends(rim)).array() == weights.blend(at_ends(rim)).topRows(10).array()).all());
}

TEST_CASE("Attribute weights: mean value coordinates are linear inside and on a rim of a thousand edges") {
  const Values rim = ellipse(1000);
  Values at(4, 2);
  at << 0.1, 0.2, 1.9, 0.1, rim(7, 0), rim(7, 1), (rim(3, 0) + rim(4, 0)) / 2, (rim(3, 1) + rim(4, 1)) / 2;
  CHECK((AttributeWeights(rim, at).blend(at_ends(rim)) - at).cwiseAbs().maxCoeff() < 1e-12);
  CHECK(AttributeWeights(rim, at).nearest()[2] / 2 >= 6);
}

TEST_CASE("Attribute weights: of another shape they are refused") {
  CHECK_THROWS_AS(AttributeWeights(ellipse(5), Values::Zero(1, 3)), InvalidArgument);
  CHECK_THROWS_AS(AttributeWeights(ellipse(2), Values::Zero(1, 2)), InvalidArgument);
  CHECK_THROWS_AS(AttributeWeights(ellipse(5), Values::Zero(1, 2)).blend(Values::Zero(5, 1)), InvalidArgument);
}
