// What quads that grow in from a rim cost and how long they are sought, on both sides of each threshold.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

#include "tripatch/fill/spline_fill.h"
#include "tripatch/quads/grown_quads.h"

using namespace tripatch;

namespace {

struct Outline {
  PlanePoints rim;
  std::vector<int> wanted;
  std::optional<PlaneLayout> grown() const { return grown_quads(rim, wanted); }
};

/// A square of so many edges a side, whose rim begins that many behind a corner; some of its vertices, counted from the corner, want other than
/// their quads.
Outline square(Index side, Index from, const std::map<Index, int>& other) {
  const Index n = 4 * side;
  Outline made{PlanePoints(n, 2), {}};
  for (Index k = 0; k < n; ++k) {
    const Index at = (k + from) % n;
    const double along = static_cast<double>(at % side), all = static_cast<double>(side);
    const std::array<Vec2, 4> place = {Vec2(along, 0), Vec2(all, along), Vec2(all - along, all), Vec2(0, all - along)};
    made.rim.row(k) = place[static_cast<std::size_t>(at / side)];
    const auto given = other.find(at);
    made.wanted.push_back(given != other.end() ? given->second : at % side == 0 ? 1 : 2);
  }
  return made;
}

bool is_grid(const std::optional<PlaneLayout>& layout, Index side) {
  return layout && layout->faces.size() == side * side && quad_quality(as_rows(layout->uv), layout->faces).least > 1 - 1e-9;
}

/// An ellipse, `height` next to 1, whose vertices want two quads but for some.
Outline ellipse(Index n, double height, const std::map<Index, int>& other) {
  Outline made{PlanePoints(n, 2), std::vector<int>(static_cast<std::size_t>(n), 2)};
  for (Index k = 0; k < n; ++k) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n);
    made.rim.row(k) << std::cos(angle), height * std::sin(angle);
  }
  for (const auto& [k, quads] : other) made.wanted[static_cast<std::size_t>(k)] = quads;
  return made;
}

double least(const PlaneLayout& layout) { return quad_quality(as_rows(layout.uv), layout.faces).least; }

}  // namespace

TEST_CASE("a square that wants no corners gets them wherever it begins, of 60 edges, not of 64", "[thresholds]") {
  const auto round = [](Index side) { return square(side, 1, {{0, 2}, {side, 2}, {2 * side, 2}, {3 * side, 2}}).grown(); };
  for (const Index side : {10, 13, 14, 15}) CHECK(is_grid(round(side), side));
  CHECK_FALSE(is_grid(round(16), 16));  // every other turn of 32 is tried
}

TEST_CASE("a rim that turns by four right angles too little gets quads, by five none", "[thresholds]") {
  for (const Index n : {8, 12, 16}) {
    CHECK(ellipse(n, 1, {{0, 1}, {n / 2, 3}}).grown());
    CHECK_FALSE(ellipse(n, 1, {{n / 2, 3}}).grown());
  }
}

TEST_CASE("poles are tried where the sine of a grid's least angle is 0.3", "[thresholds]") {
  for (const Index side : {3, 4, 5})
    for (const double sine : {0.298, 0.302}) {
      Outline blunt = square(side, 0, {});
      const double across = (1 - std::tan(std::asin(sine) / 2)) / 2;  // the corner, pushed in, is as blunt
      blunt.rim.row(0) << across, across;
      const std::optional<PlaneLayout> layout = blunt.grown();
      REQUIRE(layout);
      if (sine > 0.3) {
        CHECK(layout->poles.empty());
        CHECK(layout->faces.size() == side * side);
        CHECK(least(*layout) == Approx(sine));
      } else {
        CHECK_FALSE(layout->poles.empty());
        CHECK(least(*layout) > 0.7);
      }
    }
}

TEST_CASE("a round rim of eight edges gets a ring of quads where four corners would be of 128 degrees, not of 127",
          "[thresholds]") {
  // four quads, or eight around them
  const auto quads = [](double degrees) {
    Outline pillow = ellipse(8, 1, {});
    for (Index k = 1; k < 8; k += 2)
      pillow.rim.row(k) *= (1 + std::tan(std::numbers::pi * (180 - degrees) / 360)) / std::numbers::sqrt2;
    const std::optional<PlaneLayout> layout = pillow.grown();
    return layout ? layout->faces.size() : 0;
  };
  CHECK(quads(128.2) == 12);
  CHECK(quads(126.9) == 4);
}

TEST_CASE("as many quads grow in a rim as an eighth of its edges squared, and four more", "[thresholds]") {
  // where one vertex of 21 shows a corner the quads with the best angles are 64 around three poles: a triangle among them gives the rim 22 edges
  for (const double height : {0.9, 0.95, 1.0}) {
    const std::optional<PlaneLayout> odd = ellipse(21, height, {{5, 1}}).grown();
    REQUIRE(odd);
    CHECK(odd->faces.size() == 64);
    CHECK(least(*odd) > 0.8);
  }
  // 66 around as many would be better here, too
  Outline lobes = ellipse(22, 0.734, {{7, 1}, {14, 1}});
  for (Index k = 0; k < 22; ++k) lobes.rim.row(k) *= 1 + 0.098 * std::cos(8 * std::numbers::pi * static_cast<double>(k) / 22);
  const std::optional<PlaneLayout> even = lobes.grown();
  REQUIRE(even);
  CHECK(even->faces.size() < 64);
}

TEST_CASE("the best four of the layouts that are tried are smoothed", "[thresholds]") {
  // the best is among the first four as they are embedded, or just behind them
  const std::optional<PlaneLayout> even = ellipse(8, 0.8, {{0, 1}, {4, 1}}).grown(), odd = ellipse(9, 0.4, {{0, 1}}).grown();
  REQUIRE(even);
  REQUIRE(odd);
  CHECK(least(*even) > 0.8);
  CHECK(least(*odd) < 0.82);
}

TEST_CASE("of layouts with two poles 24 are tried", "[thresholds]") {
  // the square is among the first of them or behind them
  const auto begun = [](Index from) { return square(6, from, {{2, 3}, {3, 1}}).grown(); };
  CHECK(is_grid(begun(1), 6));
  CHECK_FALSE(is_grid(begun(3), 6));
}

TEST_CASE("where one vertex of a rim wants a quad too many a square comes back of up to 52 edges", "[thresholds]") {
  const auto begun = [](Index side, Index from) { return is_grid(square(side, from, {{side / 2, 3}}).grown(), side); };
  for (const Index from : {0, 5, 10, 15}) CHECK(begun(13, from));
  CHECK_FALSE(begun(14, 0));
}

TEST_CASE("quads grow across a hole in a sheared grid as long as its corners have ten degrees", "[thresholds]") {
  const auto quads = [](double sine) {  // of a hole of 3 x 3
    constexpr Index n = 11;
    Points vertices((n + 1) * (n + 1), 3);
    const auto at = [](Index i, Index j) { return i * (n + 1) + j; };
    for (Index i = 0; i <= n; ++i)
      for (Index j = 0; j <= n; ++j)
        vertices.row(at(i, j)) << static_cast<double>(i) + static_cast<double>(j) * std::sqrt(1 - sine * sine),
            static_cast<double>(j) * sine, 0;
    Faces faces;
    for (Index i = 0; i < n; ++i)
      for (Index j = 0; j < n; ++j)
        if (std::min(i, j) < 4 || std::max(i, j) > 6)
          faces.add(std::array<Index, 4>{at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
    std::vector<Index> rim;
    for (Index k = 0; k < 3; ++k) rim.push_back(at(4 + k, 4));
    for (Index k = 0; k < 3; ++k) rim.push_back(at(7, 4 + k));
    for (Index k = 0; k < 3; ++k) rim.push_back(at(7 - k, 7));
    for (Index k = 0; k < 3; ++k) rim.push_back(at(4, 7 - k));
    SplineFillOptions options;
    options.quads = true;
    const Fill fill = fill_with_spline({vertices, faces}, Connectivity(faces, vertices.rows()), rim, {}, options);
    Index count = 0;
    for (Index f = 0; f < fill.faces.size(); ++f) count += fill.faces[f].size() == 4;
    return count;
  };
  CHECK(quads(0.168) != 9);  // a disc of quads
  CHECK(quads(0.172) == 9);
}
