#include <algorithm>
#include <catch2/catch.hpp>
#include <map>
#include <random>

#include "tripatch/mesh/submesh.h"

using namespace tripatch;

namespace {

using Loop = std::vector<Index>;

Faces quads(Index n) {
  Faces faces;
  for (Index i = 0; i < n; ++i)
    for (Index k = 0; k < n; ++k) {
      const Index a = i * (n + 1) + k;
      faces.add(Loop{a, a + 1, a + n + 2, a + n + 1});
    }
  return faces;
}

}  // namespace

TEST_CASE("numbers are given in the order of the items, once each") {
  std::mt19937_64 random(3);
  Numbering numbering;
  CHECK(numbering.find(0) == -1);
  std::map<Index, int> expected;
  for (int k = 0; k < 5000; ++k) {
    // neighboring numbers, equal low bits and large ones
    const Index item = static_cast<Index>(k % 3 == 0 ? random() % 700 : k % 3 == 1 ? (random() % 300) << 32 : random() >> 2);
    const bool fresh = expected.try_emplace(item, static_cast<int>(expected.size())).second;
    REQUIRE(numbering.add(item) == fresh);
  }
  REQUIRE(numbering.size() == expected.size());
  for (const auto& [item, number] : expected) {
    REQUIRE(numbering.find(item) == number);
    REQUIRE(numbering.items()[number] == item);
  }
  CHECK(numbering.find(701) == -1);
}

TEST_CASE("numbers are the same where it is said below what all items are") {
  std::mt19937_64 random(5);
  for (const Index most : {Index{1}, Index{700}, Index{1} << 40}) {
    Numbering told(most), hashed;
    for (int k = 0; k < 3000; ++k) {
      const Index item = static_cast<Index>(random() % static_cast<std::uint64_t>(most));
      REQUIRE(told.find(item) == hashed.find(item));
      REQUIRE(told.add(item) == hashed.add(item));
    }
    CHECK(told.items() == hashed.items());
  }
}

TEST_CASE("rings around a vertex of a grid are squares") {
  const Faces faces = quads(20);
  const Index middle = 10 * 21 + 10;
  const Rings rings = rings_around(Connectivity(faces), Loop{middle}, 4);
  REQUIRE(rings.faces.size() == 4);
  for (Index r = 0; r < 4; ++r) {
    CHECK(static_cast<Index>(rings.faces[r].size()) == 4 * ((r + 1) * (r + 1) - r * r));
    CHECK(static_cast<Index>(rings.vertices[r + 1].size()) == 8 * (r + 1));
    for (Index v : rings.vertices[r + 1]) CHECK(std::max(std::abs(v % 21 - 10), std::abs(v / 21 - 10)) == r + 1);
  }
  const std::vector<Index> all = rings.all_faces();
  CHECK(all.size() == 64);
  CHECK(std::is_sorted(all.begin(), all.end()));
  CHECK(std::adjacent_find(all.begin(), all.end()) == all.end());
  // the grid ends
  CHECK(rings_around(Connectivity(faces), Loop{0}, 100).all_faces().size() == 400);
}

TEST_CASE("a submesh has the faces of the mesh by numbers of its own, and the faces at its vertices") {
  const Faces faces = quads(5);
  const Loop some = {7, 8, 12}, first = {14, 9};
  const Submesh part = submesh(faces, 36, some, first);
  CHECK(part.vertex.items()[0] == 14);
  CHECK(part.vertex.items()[1] == 9);
  for (int f = 0; f < 3; ++f) {
    Loop corners;
    for (int v : part[f]) corners.push_back(part.vertex.items()[v]);
    CHECK(corners == Loop(faces[some[f]].begin(), faces[some[f]].end()));
  }
  std::size_t corners = 0;
  for (int v = 0; v < static_cast<int>(part.vertex.size()); ++v)
    for (int f : part.faces_at(v)) {
      ++corners;
      CHECK(std::count(part[f].begin(), part[f].end(), v) == 1);
    }
  CHECK(corners == 12);
  const auto at = part.faces_at(part.vertex.find(15));  // of faces 7, 8 and 12, where the first two meet
  CHECK(std::is_sorted(at.begin(), at.end()));
}
