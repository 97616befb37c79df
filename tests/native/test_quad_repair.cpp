// Quads that are pairs of triangles: vertices between two quads, and quads that are turned over.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>

#include "tripatch/quads/quad_repair.h"

using namespace tripatch;

TEST_CASE("two quads around an inside vertex become one, and the vertices behind it move up") {
  PlaneLayout layout;
  layout.rim = 6;
  layout.uv.resize(8, 2);
  layout.uv << 0, 0, 1, 0, 2, 0, 2, 1, 1, 1, 0, 1, 0.5, 0.5, 1.5, 0.4;
  layout.faces.add(std::array<Index, 4>{0, 1, 6, 5});  // around 6, between 0, 1, 4, 5
  layout.faces.add(std::array<Index, 4>{6, 1, 4, 5});
  layout.faces.add(std::array<Index, 4>{1, 2, 7, 4});  // around 7 there is a triangle too
  layout.faces.add(std::array<Index, 3>{2, 3, 7});
  layout.faces.add(std::array<Index, 3>{3, 4, 7});
  remove_doublets(layout);
  REQUIRE(layout.uv.rows() == 7);
  CHECK(layout.uv.row(6) == Eigen::RowVector2d(1.5, 0.4));
  REQUIRE(layout.faces.size() == 4);
  std::vector<Index> first(layout.faces[0].begin(), layout.faces[0].end());
  std::rotate(first.begin(), std::ranges::find(first, 0), first.end());
  CHECK(first == std::vector<Index>{0, 1, 4, 5});
  CHECK(layout.faces.corners[layout.faces.offsets[1] + 2] == 6);
}

TEST_CASE("only quads that are turned over are halved, at their corner") {
  Points points(5, 3);
  points << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0.6, 0.4, 0;
  Faces faces;
  faces.add(std::array<Index, 4>{0, 1, 2, 3});
  faces.add(std::array<Index, 4>{0, 4, 2, 3});  // flat at 4
  const Faces left = with_bad_quads_halved(points, faces);
  REQUIRE(left.size() == 2);
  points.row(4) << 0.2, 0.8, 0;  // turned over
  const Faces cut = with_bad_quads_halved(points, faces);
  REQUIRE(cut.size() == 3);
  for (Index f = 1; f < 3; ++f) {
    CHECK(std::ranges::count(cut[f], 4) == 1);
    CHECK(std::ranges::count(cut[f], 3) == 1);
  }
}
