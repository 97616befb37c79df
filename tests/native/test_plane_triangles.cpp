// Triangles of simple polygons, and folds next to a rim.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <random>

#include "tripatch/triangulation/ear_clipping.h"
#include "tripatch/triangulation/untangle.h"

using namespace tripatch;

namespace {

/// A star: every other vertex nearer to the middle.
PlanePoints star(Index n, double inner) {
  PlanePoints p(n, 2);
  for (Index k = 0; k < n; ++k) {
    const double turn = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n), r = k % 2 == 0 ? 1 : inner;
    p.row(k) << r * std::cos(turn), r * std::sin(turn);
  }
  return p;
}

double area(const PlanePoints& p, const std::array<Index, 3>& t) {
  const Eigen::RowVector2d a = p.row(t[1]) - p.row(t[0]), b = p.row(t[2]) - p.row(t[0]);
  return (a[0] * b[1] - a[1] * b[0]) / 2;
}

double shoelace(const PlanePoints& p) {
  double twice = 0;
  for (Index k = 0; k < p.rows(); ++k) {
    const Index j = (k + 1) % p.rows();
    twice += p(k, 0) * p(j, 1) - p(j, 0) * p(k, 1);
  }
  return twice / 2;
}

}  // namespace

TEST_CASE("ears: every triangle counterclockwise, together the polygon") {
  for (Index n : {3, 4, 7, 40, 3000})
    for (double inner : {1.0, 0.97, 0.4}) {
      if (n == 4 && inner < 0.5) continue;  // no simple polygon's business: see below
      const PlanePoints p = star(n, inner);
      const std::vector<std::array<Index, 3>> triangles = cut_ears(p);
      REQUIRE(static_cast<Index>(triangles.size()) == n - 2);
      double sum = 0, least = 1;
      for (const std::array<Index, 3>& t : triangles) sum += area(p, t), least = std::min(least, area(p, t));
      CHECK(least > 0);
      CHECK(sum == Approx(shoelace(p)));
    }
}

TEST_CASE("no ears of a polygon that crosses itself, or runs the other way") {
  PlanePoints bow(4, 2);
  bow << 0, 0, 1, 1, 1, 0, 0, 1;
  CHECK(cut_ears(bow).empty());
  CHECK(cut_ears(star(12, 0.9).colwise().reverse()).empty());
}

TEST_CASE("a vertex that folds its triangles goes back between its neighbors, and no other moves") {
  // a fan around a middle that lies beyond the rim, and one more vertex within its triangles
  Points p(8, 3);
  for (int k = 0; k < 6; ++k) p.row(k) << std::cos(std::numbers::pi * k / 3), std::sin(std::numbers::pi * k / 3), 0;
  p.row(6) << 1.4, 0.1, 0;
  p.row(7) << -0.3, 0.2, 0;
  std::vector<std::array<Index, 3>> triangles = {{0, 1, 6}, {1, 2, 6}, {2, 7, 6}, {2, 3, 7},
                                                 {3, 4, 7}, {4, 6, 7}, {4, 5, 6}, {5, 0, 6}};
  const Points before = p;
  Points same = p;
  CHECK(untangle(same, triangles, 6, 10) > 0);  // as many are allowed
  CHECK(same == before);
  CHECK(untangle(p, triangles, 6, 0) == 0);
  CHECK(p.topRows(6) == before.topRows(6));
  CHECK(p.row(6).norm() < 1);
  Points held = before;
  CHECK(untangle(held, triangles, 8, 0) > 0);  // nothing may move
  CHECK(held == before);
}
