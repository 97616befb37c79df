// Borders that lie on other borders are joined, also where their vertices lie within edges (T-junctions).
#include <array>
#include <catch2/catch.hpp>

#include "tripatch/hole/near_duplicates.h"
#include "tripatch/mesh/border_loops.h"

using namespace tripatch;

namespace {

/// A square with two triangles, and next to it a row of squares of which the first vertices lie within its edge.
struct Strip {
  Points vertices;
  Faces faces;
  Mesh mesh() const { return {vertices, faces}; }
};

Strip strip(int squares, double apart) {
  Strip made{Points(4 + 2 * (squares + 1), 3), {}};
  made.vertices.topRows(4) << -1, 0, 0, 0, 0, 0, 0, 1, 0, -1, 1, 0;
  made.faces.add(std::array<Index, 3>{0, 1, 2});
  made.faces.add(std::array<Index, 3>{0, 2, 3});
  for (int k = 0; k <= squares; ++k)
    for (int i = 0; i < 2; ++i) made.vertices.row(4 + 2 * k + i) = Vec3(i + (i ? 0 : apart), double(k) / squares, 0);
  for (Index k = 0; k < squares; ++k) {
    const Index a = 4 + 2 * k;
    made.faces.add(std::array<Index, 4>{a, a + 1, a + 3, a + 2});
  }
  return made;
}

JoinedBorders joined_within(const Mesh& mesh, double distance, bool junctions) {
  return join_borders(mesh, border_loops(Connectivity(mesh)), distance, junctions);
}

std::size_t border_edges(const Mesh& mesh) {
  std::size_t count = 0;
  for (const std::vector<Index>& loop : border_loops(Connectivity(mesh))) count += loop.size();
  return count;
}

}  // namespace

TEST_CASE("vertices within an edge of another border go into the face there", "[near_duplicates]") {
  const int squares = GENERATE(1, 2, 5);
  const double apart = GENERATE(0.0, 1e-5);
  const Strip made = strip(squares, apart);
  const JoinedBorders joined = joined_within(made.mesh(), 1e-4, true);
  REQUIRE(joined.splits.size() == static_cast<std::size_t>(squares - 1));
  for (std::size_t k = 0; k < joined.splits.size(); ++k) {
    const EdgeSplit& split = joined.splits[k];
    CHECK(split.face == 0);
    CHECK(split.corner == 1);  // from vertex 1 to vertex 2
    CHECK(split.vertex == 4 + 2 * static_cast<Index>(k + 1));
    CHECK(split.t == Approx(double(k + 1) / squares));
  }
  CHECK(joined.stands[4] == 1);
  CHECK(joined.stands[4 + 2 * squares] == 2);
  CHECK(joined.faces[0].size() == static_cast<std::size_t>(3 + squares - 1));
  CHECK(border_edges({made.vertices, joined.faces}) == static_cast<std::size_t>(5 + squares));  // of an oblong
}

TEST_CASE("without junctions only edges with the same ends are joined", "[near_duplicates]") {
  CHECK(joined_within(strip(3, 0).mesh(), 1e-4, false).stands.empty());
  CHECK_FALSE(joined_within(strip(1, 0).mesh(), 1e-4, false).stands.empty());
}

TEST_CASE("an edge along which two others lie at one place is joined to none", "[near_duplicates]") {
  Strip made = strip(2, 0);
  const Index first = made.vertices.rows();
  made.vertices.conservativeResize(first + 3, 3);
  made.vertices.bottomRows(3) << 0, 0, 0, 0, 1, 0, 0.5, 0.5, 1;  // a third sheet at the same edge
  made.faces.add(std::array<Index, 3>{first, first + 2, first + 1});
  CHECK(joined_within(made.mesh(), 1e-4, true).splits.empty());
}

TEST_CASE("borders that are farther apart than the distance stay apart", "[near_duplicates]") {
  CHECK(joined_within(strip(3, 1e-2).mesh(), 1e-4, true).stands.empty());
}
