#include <algorithm>
#include <catch2/catch.hpp>
#include <map>
#include <set>

#include "tripatch/quads/quad_layout.h"

using namespace tripatch;

namespace {

std::array<std::vector<double>, 3> uniform(int a, int b, int c) {
  std::array<std::vector<double>, 3> parameters;
  const std::array<int, 3> n = {a, b, c};
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k <= n[i]; ++k) parameters[i].push_back(k == n[i] ? 1.0 : static_cast<double>(k) / n[i]);
  return parameters;
}

struct Check {
  bool watertight = true;  // rim edges once and forwards, inside edges once each way, one disc
  double smallest_corner = 1;
  Index straight_corners = 0;
  Index triangles = 0;
  Index largest_valence = 0;
};

Check check(const QuadLayout& layout) {
  Check result;
  std::map<std::pair<Index, Index>, int> edges;
  for (Index f = 0; f < layout.faces.size(); ++f) {
    const auto face = layout.faces[f];
    result.triangles += face.size() == 3;
    for (std::size_t k = 0; k < face.size(); ++k) {
      ++edges[{face[k], face[(k + 1) % face.size()]}];
      const Vec3 p = layout.barycentric.row(face[k]);
      const Vec3 e = layout.barycentric.row(face[(k + 1) % face.size()]).transpose() - p;
      const Vec3 g = layout.barycentric.row(face[(k + face.size() - 1) % face.size()]).transpose() - p;
      const double corner = e[0] * g[1] - e[1] * g[0];
      result.smallest_corner = std::min(result.smallest_corner, corner);
      result.straight_corners += corner < 1e-12;
    }
  }
  std::map<Index, Index> valence;
  for (const auto& [edge, uses] : edges) {
    const bool rim =
        edge.first < layout.rim && edge.second == (edge.first + 1) % layout.rim && !edges.contains({edge.second, edge.first});
    if (uses != 1 || (!rim && !edges.contains({edge.second, edge.first}))) result.watertight = false;
    if (edge.first >= layout.rim) result.largest_valence = std::max(result.largest_valence, ++valence[edge.first]);
  }
  for (Index v = 0; v < layout.rim; ++v)
    if (!edges.contains({v, (v + 1) % layout.rim})) result.watertight = false;
  const Index all = static_cast<Index>(edges.size()), undirected = (all + layout.rim) / 2;
  if (layout.barycentric.rows() - undirected + layout.faces.size() != 1) result.watertight = false;
  return result;
}

}  // namespace

TEST_CASE("every layout with an even sum is all quads, a disc, and turns no corner over") {
  for (int a = 1; a <= 12; ++a)
    for (int b = 1; b <= 12; ++b)
      for (int c = 1; c <= 12; ++c)
        for (int rows : {0, 1, 3}) {
          const Check result = check(quad_layout(uniform(a, b, c), rows, {0, 0}));
          CAPTURE(a, b, c, rows);
          REQUIRE(result.watertight);
          REQUIRE(result.triangles == (a + b + c) % 2);
          REQUIRE(result.largest_valence <= 5);
          const bool single_quad = rows == 0 && a + b + c == 4 && std::max({a, b, c}) == 2;
          REQUIRE(result.straight_corners == (single_quad ? 1 : 0));
          REQUIRE(result.smallest_corner > (single_quad ? -1e-15 : 0));
        }
}

TEST_CASE("one pole where each count is less than the sum of the others, with spokes of the closed form's length") {
  const QuadLayout layout = quad_layout(uniform(4, 3, 5), 0, {0, 0});
  REQUIRE(layout.poles.size() == 1);
  // s = (2, 3, 1): grids of 2 x 3, 3 x 1 and 1 x 2
  CHECK(layout.faces.size() == 2 * 3 + 3 * 1 + 1 * 2);
  CHECK(quad_layout(uniform(6, 6, 6), 0, {0, 0}).faces.size() == 27);
}

TEST_CASE("the pole moves where it is asked to, and no corner turns over") {
  const QuadLayout plain = quad_layout(uniform(4, 4, 4), 0, {0, 0}), moved = quad_layout(uniform(4, 4, 4), 0, {0.1, 0.05});
  const Vec3 shift = (moved.barycentric.row(moved.poles[0]) - plain.barycentric.row(plain.poles[0])).transpose();
  CHECK((shift[1] - shift[0]) / 2 == Approx(0.1));
  CHECK(shift[2] * std::sqrt(3.0) / 2 == Approx(0.05));
  CHECK(check(moved).smallest_corner > 0);
  CHECK(check(quad_layout(uniform(4, 4, 4), 0, {3, 3})).smallest_corner > 0);
}
