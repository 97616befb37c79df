// Patches between two sides.
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
