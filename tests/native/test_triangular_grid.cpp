#include <catch2/catch.hpp>
#include <map>
#include <set>
#include <utility>

#include "tripatch/math/triangular_grid.h"

using namespace tripatch;

TEST_CASE("a triangular grid numbers its points in a row and knows their neighbors") {
  for (Index rows : {1, 2, 5, 8}) {
    INFO(rows);
    const TriangularGrid grid = {rows};
    Index next = 0;
    for (Index q = 0; q <= rows; ++q)
      for (Index p = 0; p + q <= rows; ++p) CHECK(grid.at(p, q) == next++);
    CHECK(grid.size() == next);
    const Points b = grid.barycentric();
    REQUIRE(b.rows() == next);
    CHECK((b.rowwise().sum().array() - 1).abs().maxCoeff() < 1e-15);
    CHECK(b(grid.at(0, 0), 0) == 1);
    CHECK(b(grid.at(rows, 0), 1) == 1);
    CHECK(b(grid.at(0, rows), 2) == 1);

    std::set<std::pair<Index, Index>> edges;
    std::map<Index, int> degree;
    grid.for_edges([&](Index a, Index c) {
      CHECK(edges.insert(std::minmax(a, c)).second);
      CHECK((b.row(a) - b.row(c)).cwiseAbs().maxCoeff() == Approx(1.0 / static_cast<double>(rows)));
      ++degree[a];
      ++degree[c];
    });
    CHECK(static_cast<Index>(edges.size()) == 3 * rows * (rows + 1) / 2);
    int inside = 0;
    for (const auto& [point, count] : degree) inside += count == 6;
    CHECK(inside == (rows - 1) * (rows - 2) / 2);
  }
}
