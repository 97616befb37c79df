// How many quads a rim wants where other gaps lie at its vertices, and places carried between two loops.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "tripatch/quads/spread.h"
#include "tripatch/quads/wanted_quads.h"

using namespace tripatch;

namespace {

constexpr Index side = 7;  // vertices of a grid

Index at(Index i, Index j) { return i * side + j; }

/// A grid without two blocks of 2 x 2 quads that touch at (3, 3).
Faces grid_with_two_holes() {
  Faces faces;
  for (Index i = 0; i + 1 < side; ++i)
    for (Index j = 0; j + 1 < side; ++j) {
      const auto in = [&](Index from) { return i >= from && i < from + 2 && j >= from && j < from + 2; };
      if (!in(1) && !in(3)) faces.add(std::array{at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return faces;
}

Points grid_places() {
  Points places(side * side, 3);
  for (Index i = 0; i < side; ++i)
    for (Index j = 0; j < side; ++j) places.row(at(i, j)) << static_cast<double>(i), static_cast<double>(j), 0;
  return places;
}

}  // namespace

TEST_CASE("a hole wants no quads in the gap of a hole that touches it") {
  const Faces faces = grid_with_two_holes();
  const Points places = grid_places();
  const Connectivity around(faces, places.rows());
  std::vector<Index> rim = {at(1, 1), at(2, 1), at(3, 1), at(3, 2), at(3, 3), at(2, 3), at(1, 3), at(1, 2)};
  const std::vector<int> wanted = {1, 2, 1, 2, 1, 2, 1, 2};
  for (const WantedQuads which : {WantedQuads::by_number, WantedQuads::by_angle}) {
    CHECK(wanted_quads(places, around, rim, which) == wanted);
    std::vector<Index> back(rim.rbegin(), rim.rend());
    std::vector<int> wanted_back(wanted.rbegin(), wanted.rend());
    CHECK(wanted_quads(places, around, back, which) == wanted_back);
  }
}

TEST_CASE("a hole that new edges close wants no quads beyond them") {
  Faces faces;  // an L, whose notch is closed between (1, 2) and (2, 1)
  for (const auto& [i, j] : {std::array<Index, 2>{0, 0}, {0, 1}, {1, 0}})
    faces.add(std::array{at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
  const Points places = grid_places();
  const Connectivity around(faces, places.rows());
  CHECK(wanted_quads(places, around, {at(1, 1), at(2, 1), at(1, 2)}, WantedQuads::by_angle) == std::vector<int>{1, 1, 1});
}

TEST_CASE("places between two loops are carried round them, by whole turns or not") {
  constexpr Index n = 24;
  const bool inside_out = GENERATE(false, true);                                           // the first loop is the inner one
  const std::array<double, 3> radii = {inside_out ? 0.5 : 1, inside_out ? 1 : 0.5, 0.75};  // first, second, middle
  const double along = (inside_out ? -2 : 2) * std::numbers::pi;
  PlanePoints points(3 * n, 2), ends_at(2 * n, 2);
  const auto row = [&](Index ring, Index k) { return ring * n + (ring == 1 ? n - 1 - k % n : k % n); };
  std::vector<std::array<Index, 3>> triangles;
  for (Index k = 0; k < n; ++k) {
    const double turn = static_cast<double>(k) / n;
    for (Index ring = 0; ring < 3; ++ring) {
      points.row(row(ring, k)) << 3 + radii[ring] * std::cos(along * turn), radii[ring] * std::sin(along * turn);
      if (ring < 2) ends_at.row(row(ring, k)) << turn + static_cast<double>(k % 3), static_cast<double>(ring);
    }
    for (const auto& [out, in] : {std::array<Index, 2>{0, 2}, {2, 1}}) {
      triangles.push_back({row(out, k), row(out, k + 1), row(in, k)});
      triangles.push_back({row(out, k + 1), row(in, k + 1), row(in, k)});
    }
  }
  const SpreadRing spread(triangles, points, ends_at);
  for (const double turn : {-0.31, 0.0, 0.2, 0.77, 2.2}) {
    const Vec2 place = spread.carried(Vec2(turn, 0.5)) - Vec2(3, 0);
    CHECK(place.norm() == Approx(0.75).margin(0.01));
    const double off = std::atan2(place[1], place[0]) / along - turn;
    CHECK(std::abs(off - std::round(off)) < 1.0 / n);
  }
}
