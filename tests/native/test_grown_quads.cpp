// Quads that grow in from a rim: holes in grids come back as they were, poles and all.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <random>
#include <set>

#include "tripatch/quads/grown_quads.h"

using namespace tripatch;

namespace {

/// Quads about one vertex, `valence` of them meeting there, `size` rings of them; places in a plane.
struct Fan {
  PlanePoints places;
  std::vector<std::array<Index, 4>> quads;
};

Fan fan(int valence, int size) {
  Fan made;
  std::map<std::array<int, 3>, Index> number;  // sector, steps along its first ray, along the next
  std::vector<Vec2> places;
  const auto vertex = [&](int sector, int i, int j) {
    if (i == 0 && j == 0) sector = 0;
    if (i == 0 && j > 0) sector = (sector + 1) % valence, i = j, j = 0;  // on the next ray
    const auto [it, isnew] = number.try_emplace({sector, i, j}, static_cast<Index>(places.size()));
    if (isnew) {
      const double a = 2 * std::numbers::pi * sector / valence, b = 2 * std::numbers::pi * (sector + 1) / valence;
      places.push_back(i * Vec2(std::cos(a), std::sin(a)) + j * Vec2(std::cos(b), std::sin(b)));
    }
    return it->second;
  };
  for (int s = 0; s < valence; ++s)
    for (int i = 0; i < size; ++i)
      for (int j = 0; j < size; ++j)
        made.quads.push_back({vertex(s, i, j), vertex(s, i + 1, j), vertex(s, i + 1, j + 1), vertex(s, i, j + 1)});
  made.places.resize(static_cast<Index>(places.size()), 2);
  for (std::size_t k = 0; k < places.size(); ++k) made.places.row(static_cast<Index>(k)) = places[k];
  return made;
}

/// A hole grown from one quad at random, with a rim that passes no vertex twice: the rim and the quads inside at each of its vertices.
struct Cut {
  std::vector<Index> rim;
  std::vector<int> wanted;
  Index quads = 0;
  bool pole = false;  ///< vertex 0 is inside
};

std::optional<Cut> cut(const Fan& whole, std::size_t count, std::mt19937& random) {
  std::map<std::array<Index, 2>, std::size_t> at;
  for (std::size_t q = 0; q < whole.quads.size(); ++q)
    for (int k = 0; k < 4; ++k) at[{whole.quads[q][k], whole.quads[q][(k + 1) % 4]}] = q;
  std::set<std::size_t> gone = {0};
  for (int tries = 0; gone.size() < count && tries < 10000; ++tries) {
    auto from = gone.begin();
    std::advance(from, random() % gone.size());
    const auto& q = whole.quads[*from];
    const std::size_t k = random() % 4;
    if (const auto it = at.find({q[(k + 1) % 4], q[k]}); it != at.end()) gone.insert(it->second);
  }
  std::map<Index, Index> next;
  std::map<Index, int> inside;
  for (const std::size_t q : gone)
    for (int k = 0; k < 4; ++k) {
      const Index a = whole.quads[q][k], b = whole.quads[q][(k + 1) % 4];
      ++inside[a];
      const auto it = at.find({b, a});
      if (it != at.end() && gone.contains(it->second)) continue;
      if (it == at.end() || !next.try_emplace(a, b).second) return {};  // no quad around, or twice through a vertex
    }
  Cut made;
  made.quads = static_cast<Index>(gone.size());
  made.pole = inside.contains(0) && !next.contains(0);
  Index v = next.begin()->first;
  do {
    made.rim.push_back(v);
    made.wanted.push_back(inside[v]);
    v = next[v];
  } while (v != made.rim[0]);
  if (made.rim.size() != next.size()) return {};  // an island
  return made;
}

}  // namespace

TEST_CASE("holes in a grid, round a pole or not, come back as they were") {
  const int valence = GENERATE(3, 4, 5);
  std::mt19937 random(static_cast<unsigned>(valence));
  const Fan whole = fan(valence, 8);
  int tried = 0, same = 0;
  for (int k = 0; k < 400; ++k) {
    const std::optional<Cut> hole = cut(whole, 2 + random() % 40, random);
    if (!hole) continue;
    if (std::find(hole->rim.begin(), hole->rim.end(), 0) != hole->rim.end()) continue;  // through the pole
    ++tried;
    const std::optional<PlaneLayout> layout = grown_quads(whole.places(hole->rim, Eigen::all), hole->wanted);
    REQUIRE(layout);
    same += layout->faces.size() == hole->quads && layout->poles.size() == (valence != 4 && hole->pole ? 1 : 0);
    CHECK(quad_quality(as_rows(layout->uv), layout->faces).least > 0.3);
  }
  CHECK(tried > 100);
  CHECK(same > 0.94 * tried);  // round a pole of five a rim may wind further than once
}

TEST_CASE("an odd rim has one triangle, and what turns by a right angle too little a pole of three") {
  // a corner of a cube, seen along its diagonal: three quads, an edge of the rim halved
  PlanePoints rim(7, 2);
  for (Index k = 0; k < 6; ++k)
    rim.row(k) << std::cos(std::numbers::pi * static_cast<double>(k) / 3),
        std::sin(std::numbers::pi * static_cast<double>(k) / 3);
  const std::optional<PlaneLayout> even = grown_quads(rim.topRows(6), {1, 2, 1, 2, 1, 2});
  REQUIRE(even);
  CHECK(even->faces.size() == 3);
  CHECK(even->poles == std::vector<Index>{6});
  rim.row(6) = (rim.row(5) + rim.row(0)) / 2;
  const std::optional<PlaneLayout> odd = grown_quads(rim, {1, 2, 1, 2, 1, 2, 2});
  REQUIRE(odd);
  Index triangles = 0;
  for (Index f = 0; f < odd->faces.size(); ++f) triangles += odd->faces[f].size() == 3;
  CHECK(triangles == 1);
}

TEST_CASE("rings of quads around a layout are as many in each as the rim has edges, and none turns over") {
  const Index side = 4, n = 4 * side;
  PlanePoints rim(n, 2);
  std::vector<int> wanted;
  for (Index k = 0; k < n; ++k) {
    const double along = static_cast<double>(k % side), all = static_cast<double>(side);
    const std::array<Vec2, 4> place = {Vec2(3 + along, 2), Vec2(3 + all, 2 + along), Vec2(3 + all - along, 2 + all),
                                       Vec2(3, 2 + all - along)};
    rim.row(k) = place[static_cast<std::size_t>(k / side)];
    wanted.push_back(k % side == 0 ? 1 : 2);
  }
  const std::optional<PlaneLayout> plain = grown_quads(rim, wanted);
  REQUIRE(plain);
  for (const int rows : {1, 2, 3}) {
    const PlaneLayout made = with_rows(*plain, rows);
    CHECK(made.rim == n);
    CHECK(made.uv.rows() == plain->uv.rows() + rows * n);
    CHECK(made.faces.size() == plain->faces.size() + rows * n);
    CHECK(made.poles.size() == 4);  // the grid's corners
    CHECK((made.uv.topRows(n) - rim).norm() == 0);
    CHECK(quad_quality(as_rows(made.uv), made.faces).least > 0.4);
  }
}

TEST_CASE("a vertex on an edge of the rim, which the mesh has not, runs on") {
  Points vertices = Points::Zero(4, 3);
  vertices << 0, 0, 0, 1, 0, 0, 0, -1, 0, 1, -1, 0;
  Faces faces;
  faces.add(std::array<Index, 4>{0, 2, 3, 1});
  CHECK(wanted_quads(vertices, Connectivity(Mesh{vertices, faces}), {0, 4, 1}) == std::vector<int>{3, 2, 3});
}

TEST_CASE("angles that are right but for rounding owe nothing, and three halves of them are rounded up") {
  // the faces at each vertex of the rim end at given angles from the rim, turned out of the plane by rounding
  const auto wanted = [](std::array<double, 2> quads, double rounding) {
    Points vertices = Points::Zero(8, 3);
    Faces faces;
    std::vector<Index> rim;
    for (Index k = 0; k < 2; ++k) {
      const double all = std::numbers::pi / 2 * (4 - quads[static_cast<std::size_t>(k)]) + rounding;
      const Index own = 4 * k;
      vertices.row(own) << 9.0 * static_cast<double>(k), 0, 0;
      for (Index j = 0; j < 3; ++j) {
        const double turn = all * static_cast<double>(j) / 2;
        vertices.row(own + 1 + j) << vertices(own, 0) + std::cos(turn), std::sin(turn), 0;
      }
      for (Index j = 0; j < 2; ++j) faces.add(std::array<Index, 3>{own, own + 1 + j, own + 2 + j});
      rim.push_back(own);
    }
    return wanted_quads(vertices, Connectivity(Mesh{vertices, faces}), rim, WantedQuads::by_angle);
  };
  for (const double rounding : {-1e-9, 0.0, 1e-9}) {
    CHECK(wanted({1.5, 2.4}, rounding) == std::vector<int>{2, 2});  // of the second the half is taken that the first got
    CHECK(wanted({2.4, 2}, rounding) == std::vector<int>{2, 2});    // four tenths are left, and wait
    CHECK(wanted({1.3, 2}, rounding) == std::vector<int>{1, 2});
  }
  CHECK(wanted({2.4, 2.2}, 0) == std::vector<int>{2, 3});
}

TEST_CASE("what is rounded at one vertex of a rim is made up for at the next") {
  // a hexagon of six triangles out of a plane of them: each vertex of its rim lacks 120 degrees, 1.33 quads
  Points vertices = Points::Zero(12, 3);
  Faces faces;
  for (Index k = 0; k < 6; ++k) {
    const double a = std::numbers::pi * static_cast<double>(k) / 3, b = a + std::numbers::pi / 6;
    vertices.row(k) << std::cos(a), std::sin(a), 0;
    vertices.row(6 + k) << 2 * std::cos(b), 2 * std::sin(b), 0;
  }
  for (Index k = 0; k < 6; ++k) {
    faces.add(std::array<Index, 3>{(k + 1) % 6, k, 6 + k});
    faces.add(std::array<Index, 3>{(k + 1) % 6, 6 + k, 6 + (k + 1) % 6});
  }
  const Connectivity around(Mesh{vertices, faces});
  const std::vector<int> wanted = wanted_quads(vertices, around, {0, 1, 2, 3, 4, 5});
  CHECK(std::accumulate(wanted.begin(), wanted.end(), 0) == 8);  // of a plane polygon of six edges: (6 - 2) * 2
  CHECK(*std::max_element(wanted.begin(), wanted.end()) == 2);
}
