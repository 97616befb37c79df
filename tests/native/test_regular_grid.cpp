#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include "tripatch/output/regular_grid.h"

using namespace tripatch;

namespace {

/// Half a disc, about, whose border is straight at one corner.
class Half final : public Surface {
public:
  explicit Half(int flat) : flat_(flat) {}
  void evaluate(const double* b, Index n, int, double* out) const override {  // positions only
    for (Index k = 0; k < n; ++k, b += 3, out += 3) {
      const double before = b[(flat_ + 2) % 3], after = b[(flat_ + 1) % 3];
      out[0] = after - before, out[1] = 6 * after * before, out[2] = 0;
    }
  }

private:
  int flat_;
};

}  // namespace

TEST_CASE("a regular grid has no triangle without area where the rim goes straight on at a corner, whichever it is") {
  constexpr Index n = 5;
  std::vector<double> even(n + 1);
  for (Index k = 0; k <= n; ++k) even[k] = static_cast<double>(k) / n;
  Points rim = Points::Zero(3 * n, 3);
  for (Index k = 0; k < 3 * n; ++k) rim(k, k / n) = 1 - even[k % n], rim(k, (k / n + 1) % 3) = even[k % n];
  for (int flat = 0; flat < 3; ++flat) {
    const auto grid = regular_grid({even, even, even}, rim, Half(flat));
    REQUIRE(grid);
    CHECK(grid->triangles.size() == n * n);
    const Points p = Half(flat).positions(grid->barycentric);
    for (const auto& t : grid->triangles) CHECK(Vec3(p.row(t[1]) - p.row(t[0])).cross(Vec3(p.row(t[2]) - p.row(t[0])))[2] > 1e-3);
  }
}
