// Which border loops of a mesh are meant, by known shapes of holes in a plane.
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

#include "tripatch/hole/choose_holes.h"

using namespace tripatch;

namespace {

struct Sheet {
  Points vertices;
  Faces faces;
  Mesh mesh() const { return {vertices, faces}; }
};

/// A plane lattice of unit squares, 20 a side, without those for which `gone` holds (by column and row).
Sheet sheet(const std::function<bool(int, int)>& gone) {
  constexpr int n = 20;
  Sheet made{Points((n + 1) * (n + 1), 3), {}};
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) made.vertices.row(j * (n + 1) + i) = Vec3(i, j, 0);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      if (!gone(i, j)) {
        const Index a = j * (n + 1) + i, b = a + n + 1;
        made.faces.add(std::array<Index, 4>{a, a + 1, b + 1, b});
      }
  return made;
}

bool within(int i, int j, int left, int bottom, int size) {
  return i >= left && i < left + size && j >= bottom && j < bottom + size;
}

std::vector<std::size_t> edges(const Sheet& s, const HoleChoice& choice) {
  std::vector<std::size_t> found;
  for (const std::vector<Index>& loop : choose_holes(s.mesh(), choice)) found.push_back(loop.size());
  return found;
}

using Sizes = std::vector<std::size_t>;

}  // namespace

TEST_CASE("square holes of a sheet are chosen by edges, diameter and corners") {
  const Sheet s = sheet([](int i, int j) { return within(i, j, 2, 2, 2) || within(i, j, 10, 10, 4); });
  CHECK(edges(s, {}) == Sizes{8, 16});
  CHECK(edges(s, {.max_edges = 16}) == Sizes{8, 16});
  CHECK(edges(s, {.max_edges = 15}) == Sizes{8});
  CHECK(edges(s, {.max_edges = 7}).empty());
  const double across = 4 * std::sqrt(2.0);  // the diagonal of the larger
  CHECK(edges(s, {.max_diameter = across * (1 + 1e-12)}) == Sizes{8, 16});
  CHECK(edges(s, {.max_diameter = across * (1 - 1e-12)}) == Sizes{8});
  CHECK(edges(s, {.corner_count = CountRange{4, 4}}) == Sizes{8, 16});
  CHECK(edges(s, {.corner_count = CountRange{5, 12}}).empty());
  CHECK(edges(s, {.corner_count = CountRange{0, 3}}).empty());
  CHECK_THROWS_AS(edges(s, {.corner_count = CountRange{6, 2}}), InvalidArgument);
}

TEST_CASE("the outer border is chosen only if it is asked for") {
  const Sheet holed = sheet([](int i, int j) { return within(i, j, 2, 2, 2); });
  CHECK(edges(holed, {}) == Sizes{8});
  CHECK(edges(holed, {.outer = true}) == Sizes{8, 80});
  const Sheet whole = sheet([](int, int) { return false; });
  CHECK(edges(whole, {}).empty());  // a sheet without a hole has nothing to fill
  CHECK(edges(whole, {.outer = true}) == Sizes{80});
  // filters come after: that no hole is small enough does not make the border one
  CHECK(edges(holed, {.max_edges = 7}).empty());
}
