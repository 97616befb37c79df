// Which folded edges are mended, on both sides of each threshold.
#include <algorithm>
#include <catch2/catch.hpp>

#include "test_triangles.h"
#include "tripatch/report/folded_triangles.h"
#include "tripatch/triangulation/untangle.h"

using namespace tripatch;
using namespace tripatch::testing;

TEST_CASE("a flip leaves no triangle flatter than a fiftieth of its longest edge", "[thresholds]") {
  for (const double share : {0.0195, 0.0205}) {
    Points points(4, 3);  // the ear 0-1-2 lies outside; flipped, 0-1 belongs to vertex 3
    points << 0, 0, 0, 4, 0, 0, 5, -1, 0, 2, 4 * share, 0;
    Triangles triangles = {{0, 1, 2}, {0, 2, 3}};
    const std::vector<AdjacentFace> beyond = {{0, 1, Vec3(0, 0, 1)}};
    flip_folded(points, triangles, {}, 0, beyond);
    CHECK(has_edge(triangles, 1, 3) == (share > 0.02));
  }
}

TEST_CASE("up to four folded edges, and three in a hundred of all, are mended", "[thresholds]") {
  const auto left = [](Index n, Index pushed, Index& folded) {  // of a sheet of n x n squares, its border fixed
    Points x((n + 1) * (n + 1), 3);
    std::vector<Index> row(x.rows());
    Index next = 0, border = 0;
    for (const bool inside : {false, true})
      for (Index k = 0; k < x.rows(); ++k) {
        const Index i = k / (n + 1), j = k % (n + 1);
        if ((i > 0 && i < n && j > 0 && j < n) != inside) continue;
        x.row(next) << static_cast<double>(i), static_cast<double>(j), 0;
        row[k] = next++;
        border += !inside;
      }
    Triangles triangles;
    for (Index i = 0; i < n; ++i)
      for (Index j = 0; j < n; ++j) {
        const Index a = i * (n + 1) + j, b = a + n + 1;
        triangles.push_back({row[a], row[b], row[b + 1]});
        triangles.push_back({row[a], row[b + 1], row[a + 1]});
      }
    for (Index k = 0; k < pushed; ++k)  // over a neighbor
      x(row[(2 + 4 * (k / 4)) * (n + 1) + 2 + 4 * (k % 4)], 0) += 1.2;
    folded = count_folded_edges(x, Points(0, 3), faces_of(triangles));
    return untangle(x, triangles, border, 0);
  };
  Index folded = 0;
  for (Index n : {4, 5, 6, 8, 12, 16, 18}) {
    const Index most = std::max<Index>(4, static_cast<Index>(0.03 * 1.5 * static_cast<double>(2 * n * n)));
    for (Index pushed = 1; pushed <= (n < 8 ? 1 : n < 16 ? 4 : 16); ++pushed) {
      const Index after = left(n, pushed, folded);
      INFO(n << " " << pushed << " " << folded << " " << most);
      REQUIRE(folded > 0);
      CHECK((after == 0) == (folded <= most));
    }
  }
}
