// Quads that grow in from a rim: holes in grids come back as they were, poles and all.
#include <catch2/catch.hpp>
#include <map>
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
