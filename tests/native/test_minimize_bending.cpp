// Triangles that bend least.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <random>

#include "tripatch/spline/minimize_bending.h"

using namespace tripatch;

namespace {

constexpr Index squares = 12, side = squares + 1;

/// A grid of squares in two triangles each with uneven steps, the free vertices (`inner` squares from the border on) last.
struct Grid {
  Points points;
  std::vector<std::array<Index, 3>> triangles;
  Index first = 0, count = 0;

  explicit Grid(Index inner) : points(side * side, 3) {
    std::vector<Index> row(side * side);
    Index next = 0;
    for (const bool free : {false, true})
      for (Index i = 0; i < side; ++i)
        for (Index j = 0; j < side; ++j) {
          if ((std::min({i, j, squares - i, squares - j}) >= inner) != free) continue;
          if (free && count++ == 0) first = next;
          points.row(next) << static_cast<double>(i) + 0.2 * std::sin(3.0 * j), static_cast<double>(j) + 0.2 * std::cos(2.0 * i),
              0;
          row[i * side + j] = next++;
        }
    for (Index i = 0; i < squares; ++i)
      for (Index j = 0; j < squares; ++j) {
        const Index a = i * side + j, b = a + side;
        triangles.push_back({row[a], row[b], row[b + 1]});
        triangles.push_back({row[a], row[b + 1], row[a + 1]});
      }
  }

  /// The triangles with free vertices and the others.
  std::array<std::vector<std::array<Index, 3>>, 2> parts() const {
    std::array<std::vector<std::array<Index, 3>>, 2> out;
    for (const std::array<Index, 3>& t : triangles)
      out[std::ranges::none_of(t, [&](Index v) { return v >= first; })].push_back(t);
    return out;
  }
};

}  // namespace

TEST_CASE("what lies in a plane stays where it is") {
  const Grid grid(4);
  const auto [fill, around] = grid.parts();
  for (const int order : {1, 2, 3})
    for (const auto& bent : {minimize_bending(grid.points, grid.triangles, {}, grid.first, grid.count, order),
                             minimize_bending(grid.points, fill, around, grid.first, grid.count, order)}) {
      REQUIRE(bent);
      CHECK((*bent - grid.points.bottomRows(grid.count)).cwiseAbs().maxCoeff() < 1e-9);
    }
}

TEST_CASE("a fill bends least by the planes beside it, however large and curved the surroundings are beyond") {
  const auto made = [](double longer) {
    Grid grid(4);
    for (Index k = 0; k < grid.points.rows(); ++k) {
      const double angle = (std::round(grid.points(k, 0)) - 6) * std::numbers::pi / 24, y = std::round(grid.points(k, 1)),
                   beyond = y - std::clamp(y, 3.0, 9.0);
      grid.points.row(k) << 7.6 * std::sin(angle), y + (longer - 1) * beyond, 7.6 * std::cos(angle);
    }
    const auto [fill, around] = grid.parts();
    const Points bent = *minimize_bending(grid.points, fill, around, grid.first, grid.count);
    CHECK((bent - grid.points.bottomRows(grid.count)).cwiseAbs().maxCoeff() < 0.02);  // a tube of facets, six across the hole
    return bent;
  };
  CHECK((made(20) - made(1)).cwiseAbs().maxCoeff() < 1e-9);
}

TEST_CASE("between flat surroundings a bump goes") {
  Grid grid(4);
  for (Index k = grid.first; k < grid.first + grid.count; ++k)
    grid.points(k, 2) = 0.4 + 0.1 * std::sin(5.0 * static_cast<double>(k));
  const auto bent = minimize_bending(grid.points, grid.triangles, {}, grid.first, grid.count);
  REQUIRE(bent);
  CHECK(bent->col(2).cwiseAbs().maxCoeff() < 1e-9);
}

TEST_CASE("the slope of the surroundings is continued, which no membrane does") {
  Grid grid(4);
  const auto dome = [](double x, double y) { return 0.02 * (36 - (x - 6) * (x - 6) - (y - 6) * (y - 6)); };
  double edge = 0;  // of what stays
  for (Index k = 0; k < grid.points.rows(); ++k) {
    const bool free = k >= grid.first;
    grid.points(k, 2) = free ? 0.02 * 28 : dome(grid.points(k, 0), grid.points(k, 1));
    if (!free) edge = std::max(edge, grid.points(k, 2));
  }
  const auto bent = minimize_bending(grid.points, grid.triangles, {}, grid.first, grid.count);
  REQUIRE(bent);
  CHECK(bent->col(2).maxCoeff() > edge + 0.02);
  for (Index k = 0; k < grid.count; ++k) CHECK(std::abs((*bent)(k, 2) - dome((*bent)(k, 0), (*bent)(k, 1))) < 0.05);
}

TEST_CASE("triangles that bend least are the same turned, moved and scaled") {
  Grid grid(4);
  for (Index k = 0; k < grid.points.rows(); ++k)
    grid.points(k, 2) = std::sin(0.4 * grid.points(k, 0)) * std::cos(0.3 * grid.points(k, 1));
  const auto bent = minimize_bending(grid.points, grid.triangles, {}, grid.first, grid.count);
  Points turned(grid.points.rows(), 3);
  turned << grid.points.col(1), grid.points.col(2), grid.points.col(0);
  turned = (1e-5 * turned).rowwise() + Eigen::RowVector3d(3, -2, 1);
  const auto again = minimize_bending(turned, grid.triangles, {}, grid.first, grid.count);
  REQUIRE(bent);
  REQUIRE(again);
  const Points back = (again->rowwise() - Eigen::RowVector3d(3, -2, 1)) / 1e-5;
  CHECK((back.col(2) - bent->col(0)).cwiseAbs().maxCoeff() < 1e-6);
  CHECK((back.col(1) - bent->col(2)).cwiseAbs().maxCoeff() < 1e-6);
}

TEST_CASE("the least area is flat between a flat rim, which bends that are least or vary least are not where a dome goes on") {
  const auto dome = [](double x, double y) { return 0.02 * (36 - (x - 6) * (x - 6) - (y - 6) * (y - 6)); };
  Grid grid(4);
  for (Index k = 0; k < grid.points.rows(); ++k) grid.points(k, 2) = dome(grid.points(k, 0), grid.points(k, 1));
  const Points truth = grid.points.bottomRows(grid.count);
  double off[3];
  for (const int order : {1, 2, 3}) {
    const auto made = minimize_bending(grid.points, grid.triangles, {}, grid.first, grid.count, order);
    REQUIRE(made);
    off[order - 1] = (*made - truth).col(2).cwiseAbs().maxCoeff();
  }
  CHECK(off[1] < 0.5 * off[0]);
  CHECK(off[2] < 0.5 * off[0]);
  for (Index k = 0; k < grid.first; ++k) grid.points(k, 2) = 0;
  const auto film = minimize_bending(grid.points, grid.triangles, {}, grid.first, grid.count, 1);
  REQUIRE(film);
  CHECK(film->col(2).cwiseAbs().maxCoeff() < 1e-9);
}

TEST_CASE("beside triangles that are all but edges rounding has no say in what bends least, at any scale") {
  Grid grid(2);
  for (Index k = 0; k < grid.points.rows(); ++k)
    grid.points(k, 2) = std::sin(0.4 * grid.points(k, 0)) * std::cos(0.3 * grid.points(k, 1));
  const Index a = grid.first + 20;  // onto the middle of an edge, and next to another vertex
  for (std::array<Index, 3> t : grid.triangles)
    if (t[0] == a) {
      grid.points.row(a) = (1 - 2e-6) * (0.5 * grid.points.row(t[1]) + 0.5 * grid.points.row(t[2])) + 2e-6 * grid.points.row(a);
      break;
    }
  grid.points.row(grid.first + 40) =
      grid.points.row(grid.first + 41) + 1e-4 * (grid.points.row(grid.first + 40) - grid.points.row(grid.first + 41));
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 1e-14);
  Points moved = grid.points;
  for (double& x : moved.reshaped()) x += noise(random);
  for (const int order : {1, 2, 3}) {
    const auto bent = minimize_bending(grid.points, grid.triangles, {}, grid.first, grid.count, order);
    const auto other = minimize_bending(moved, grid.triangles, {}, grid.first, grid.count, order);
    const auto large = minimize_bending(1e9 * grid.points, grid.triangles, {}, grid.first, grid.count, order);
    REQUIRE((bent && other && large));
    CHECK((*other - *bent).cwiseAbs().maxCoeff() < 1e-9);
    CHECK((*large / 1e9 - *bent).cwiseAbs().maxCoeff() < 1e-9);
  }
}
