// Rows of quads that continue across outlines and past a pole: mixed differences, what they determine, and what is reported of it.
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <map>
#include <set>

#include "test_surfaces.h"
#include "tripatch/fill.h"
#include "tripatch/fill/rows_fill.h"
#include "tripatch/grid/continued_quads.h"
#include "tripatch/grid/continued_rows.h"
#include "tripatch/grid/mixed_differences.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

using Cell = std::array<Index, 2>;

/// A grid of n x n quads, or, where three faces meet at one vertex, the three faces of a box at its corner, n x n quads each.
struct Quads {
  Points vertices = Points(0, 3);
  Faces faces;
  std::map<std::array<double, 3>, Index> at;

  Index vertex(const std::array<double, 3>& place) {
    const auto [found, is_new] = at.emplace(place, vertices.rows());
    if (is_new) {
      vertices.conservativeResize(vertices.rows() + 1, 3);
      vertices.row(vertices.rows() - 1) << place[0], place[1], place[2];
    }
    return found->second;
  }
  static Quads grid(Index n) {
    Quads made;
    for (Index i = 0; i < n; ++i)
      for (Index j = 0; j < n; ++j) made.add([](double u, double v) { return std::array{u, v, 0.0}; }, i, j);
    return made;
  }
  static Quads corner(Index n) {
    Quads made;
    for (Index i = 0; i < n; ++i)
      for (Index j = 0; j < n; ++j) {
        made.add([](double u, double v) { return std::array{u, v, 0.0}; }, i, j);
        made.add([](double u, double v) { return std::array{0.0, u, v}; }, i, j);
        made.add([](double u, double v) { return std::array{v, 0.0, u}; }, i, j);
      }
    return made;
  }
  /// The end of a box, two quads thick, at two of its corners: faces with x and z from 0 to n.
  static Quads end_of_box(Index n) {
    Quads made;
    for (Index i = 0; i < n; ++i) {
      for (Index j = 0; j < 2; ++j) {
        made.add([](double u, double v) { return std::array{u, v, 0.0}; }, i, j);
        made.add([](double u, double v) { return std::array{0.0, u, v}; }, j, i);
      }
      for (Index j = 0; j < n; ++j) {
        made.add([](double u, double v) { return std::array{v, 0.0, u}; }, i, j);
        made.add([](double u, double v) { return std::array{u, 2.0, v}; }, i, j);
      }
    }
    return made;
  }
  void add(const std::function<std::array<double, 3>(double, double)>& place, Index i, Index j) {
    const double u = static_cast<double>(i), v = static_cast<double>(j);
    faces.add(std::array{vertex(place(u, v)), vertex(place(u + 1, v)), vertex(place(u + 1, v + 1)), vertex(place(u, v + 1))});
  }

  /// Without the faces whose middles are given; those are what is inside.
  QuadsInside taken_out(const std::function<bool(const Vec3&)>& is_gone, Faces& left) const {
    Faces gone;
    for (Index f = 0; f < faces.size(); ++f) {
      Vec3 middle = Vec3::Zero();
      for (const Index v : faces[f]) middle += vertices.row(v).transpose() / 4;
      (is_gone(middle) ? gone : left).add(faces[f]);
    }
    std::map<Index, Index> next;  // along the border of what is gone
    for (Index f = 0; f < gone.size(); ++f)
      for (std::size_t k = 0; k < 4; ++k) {
        const Index a = gone[f][k], b = gone[f][(k + 1) % 4];
        if (!Connectivity(gone, vertices.rows()).edge(b, a)) next[a] = b;
      }
    QuadsInside inside;
    for (Index v = next.begin()->first; inside.rim.empty() || v != inside.rim[0]; v = next.at(v)) inside.rim.push_back(v);
    std::map<Index, Index> number;
    for (const Index v : inside.rim) number.emplace(v, static_cast<Index>(number.size()));
    for (const Index v : gone.corners) number.emplace(v, static_cast<Index>(number.size()));
    inside.inside = static_cast<Index>(number.size() - inside.rim.size());
    inside.faces = gone;
    for (Index& v : inside.faces.corners) v = number.at(v);
    lost.assign(static_cast<std::size_t>(inside.inside), 0);
    for (const auto& [v, k] : number)
      if (k >= static_cast<Index>(inside.rim.size())) lost[static_cast<std::size_t>(k) - inside.rim.size()] = v;
    return inside;
  }
  mutable std::vector<Index> lost;  ///< vertices inside, in their order
};

bool in_an_l(const Vec3& p) { return p[0] > 3 && p[1] > 3 && p[0] < 8 && p[1] < 8 && (p[0] < 5 || p[1] < 5); }
bool at_the_corner(const Vec3& p) { return p.maxCoeff() < 3; }

double farthest(const Points& found, const Points& truth) { return (found - truth).rowwise().norm().maxCoeff(); }

}  // namespace

TEST_CASE("mixed differences stand over all blocks of quads of a grid, each once", "[quad_rows]") {
  const Quads grid = Quads::grid(6);
  const Connectivity mesh(grid.faces, grid.vertices.rows());
  for (int order = 1; order <= 3; ++order) {
    const std::vector<Difference> found = mixed_differences(mesh, order);
    const Index blocks = 6 - order + 1;
    CHECK(static_cast<Index>(found.size()) == blocks * blocks);
    std::set<std::set<Index>> different;
    for (const Difference& each : found) {
      std::set<Index> vertices;
      double sum = 0;
      Vec3 moment = Vec3::Zero();
      for (const auto& [v, weight] : each) {
        vertices.insert(v);
        sum += weight;
        moment += weight * grid.vertices.row(v).transpose();
      }
      CHECK(static_cast<int>(vertices.size()) == (order + 1) * (order + 1));
      CHECK(sum == 0);
      CHECK(moment.norm() == 0);
      different.insert(vertices);
    }
    CHECK(different.size() == found.size());
  }
}

TEST_CASE("no block of quads reaches over a pole, as a vertex amid it, or over a triangle", "[quad_rows]") {
  const Quads corner = Quads::corner(4);
  const Connectivity mesh(corner.faces, corner.vertices.rows());
  const Index pole = corner.at.at({0, 0, 0});
  CHECK(mixed_differences(mesh, 1).size() == 48);
  CHECK(mixed_differences(mesh, 2).size() == 36);  // 9 in each face of the box and 3 on each of the edges
  for (int order = 2; order <= 3; ++order)
    for (const Difference& each : mixed_differences(mesh, order))
      for (std::size_t k = 0; k < each.size(); ++k) {
        const std::size_t row = k / static_cast<std::size_t>(order + 1), column = k % static_cast<std::size_t>(order + 1);
        const bool amid =
            row > 0 && row < static_cast<std::size_t>(order) && column > 0 && column < static_cast<std::size_t>(order);
        CHECK((!amid || each[k].first != pole));
      }
  Faces cut = Quads::grid(3).faces;
  const std::vector<Index> middle(cut[4].begin(), cut[4].end());
  Faces with_triangles;
  for (Index f = 0; f < cut.size(); ++f)
    if (f != 4) with_triangles.add(cut[f]);
  with_triangles.add(std::array{middle[0], middle[1], middle[2]});
  with_triangles.add(std::array{middle[0], middle[2], middle[3]});
  CHECK(mixed_differences(Connectivity(with_triangles, 16), 1).size() == 8);
  CHECK(mixed_differences(Connectivity(with_triangles, 16), 2).empty());
}

TEST_CASE("what is a sum along rows and across is continued exactly across an L, with whatever is in it", "[quad_rows]") {
  Quads grid = Quads::grid(11);
  std::vector<Vec3> a, b;
  for (int k = 0; k < 12; ++k) {
    a.push_back(0.4 * Vec3(std::sin(3.0 * k), std::cos(7.0 * k), std::sin(5.0 * k + 1)));
    b.push_back(0.4 * Vec3(std::cos(4.0 * k), std::sin(9.0 * k), std::cos(2.0 * k + 1)));
  }
  for (Index v = 0; v < grid.vertices.rows(); ++v) {
    const Vec3 p = grid.vertices.row(v);
    grid.vertices.row(v) += (a[static_cast<std::size_t>(p[0])] + b[static_cast<std::size_t>(p[1])]).transpose();
  }
  Faces left;
  const QuadsInside quads = Quads::grid(11).taken_out(in_an_l, left);
  const Quads plain = Quads::grid(11);
  Faces again;
  plain.taken_out(in_an_l, again);
  const Connectivity around(left, grid.vertices.rows());
  REQUIRE(go_on(grid.vertices, around, quads));
  const ContinuedRows made = continued_quads(grid.vertices, around, quads);
  REQUIRE(made.order > 0);
  CHECK(farthest(made.inside, grid.vertices(plain.lost, Eigen::all)) < 1e-9);
  CHECK(made.missed < 1e-9);
}

TEST_CASE("rows go on across an outline whose inside hangs together by one row of quads only", "[quad_rows]") {
  Quads grid = Quads::grid(18);
  Faces left;
  const QuadsInside quads = grid.taken_out(
      [](const Vec3& p) {
        const bool high = p[1] > 2 && p[1] < 8;
        return high && ((p[0] > 2 && p[0] < 8) || (p[0] > 10 && p[0] < 16) || (p[0] > 2 && p[0] < 16 && p[1] > 4 && p[1] < 5));
      },
      left);
  REQUIRE(quads.inside == 50);
  for (Index v = 0; v < grid.vertices.rows(); ++v) {
    const double x = grid.vertices(v, 0), y = grid.vertices(v, 1);
    grid.vertices(v, 2) = 0.01 * x * x * x + std::sin(y);
  }
  const ContinuedRows made = continued_quads(grid.vertices, Connectivity(left, grid.vertices.rows()), quads);
  REQUIRE(made.order > 0);
  CHECK(farthest(made.inside, grid.vertices(grid.lost, Eigen::all)) < 1e-9);
}

TEST_CASE("the corner of a box comes back round its pole, and rows do not go on past two", "[quad_rows]") {
  const Quads corner = Quads::corner(6);
  Faces left;
  QuadsInside quads = corner.taken_out(at_the_corner, left);
  const Connectivity around(left, corner.vertices.rows());
  REQUIRE(go_on(corner.vertices, around, quads));
  const ContinuedRows made = continued_quads(corner.vertices, around, quads);
  REQUIRE(made.order > 0);
  CHECK(farthest(made.inside, corner.vertices(corner.lost, Eigen::all)) < 1e-9);
  CHECK(made.missed < 1e-9);

  const Quads end = Quads::end_of_box(6);
  Faces left_of_end;
  const QuadsInside both = end.taken_out([](const Vec3& p) { return p[0] < 3 && p[2] < 3; }, left_of_end);
  REQUIRE(is_among_quads(Connectivity(left_of_end, end.vertices.rows()), both.rim));
  CHECK_FALSE(go_on(end.vertices, Connectivity(left_of_end, end.vertices.rows()), both));

  Faces without_a_face;  // a vertex of the rim has three quads then
  for (Index f = 1; f < quads.faces.size(); ++f) without_a_face.add(quads.faces[f]);
  CHECK_FALSE(go_on(corner.vertices, around, {quads.rim, without_a_face, quads.inside}));
  Faces cut = quads.faces;  // a triangle
  cut.corners.pop_back();
  --cut.offsets.back();
  CHECK_FALSE(go_on(corner.vertices, around, {quads.rim, cut, quads.inside}));
}

TEST_CASE("what a single row of quads around the corner of a box does not determine counts for nothing") {
  for (const Index size : {3, 4}) {
    Quads corner = Quads::corner(size + 1);
    Faces left;
    const QuadsInside quads = corner.taken_out([&](const Vec3& p) { return p.maxCoeff() < static_cast<double>(size); }, left);
    for (Index v = 0; v < corner.vertices.rows(); ++v)
      corner.vertices.row(v) *= 1 + 0.1 * std::sin(0.4 * corner.vertices.row(v).sum() + 1);
    const ContinuedRows made = continued_quads(corner.vertices, Connectivity(left, corner.vertices.rows()), quads);
    CHECK(made.order == 2);
    CHECK(made.missed < 3 * farthest(made.inside, corner.vertices(corner.lost, Eigen::all)));  // by the third order 1e10
  }
}

TEST_CASE("an outline that is a block is continued as that block", "[quad_rows]") {
  for (const double wave : {0.3, 0.9, 2.5}) {
    Quads grid = Quads::grid(11);  // of 5 x 5 quads, three rows around
    Faces left;
    const QuadsInside quads =
        grid.taken_out([](const Vec3& p) { return p.head<2>().minCoeff() > 3 && p.head<2>().maxCoeff() < 8; }, left);
    for (Index v = 0; v < grid.vertices.rows(); ++v)
      grid.vertices(v, 2) = std::sin(wave * grid.vertices(v, 0) + 0.4) * std::cos(0.8 * wave * grid.vertices(v, 1));
    const Connectivity around(left, grid.vertices.rows());
    const ContinuedRows as_outline = continued_quads(grid.vertices, around, quads),
                        as_block = continued_rows(grid.vertices, quad_rows(around, quads.rim).value());
    REQUIRE(as_outline.order == as_block.order);
    CHECK(as_outline.inside.rows() == as_block.inside.rows());
    for (Index k = 0; k < as_outline.inside.rows(); ++k)
      CHECK((as_block.inside.rowwise() - as_outline.inside.row(k)).rowwise().norm().minCoeff() < 1e-10);
    if (wave > 1)  // else another order is farther off than that
      CHECK(as_outline.missed == Approx(as_block.missed));
    else
      CHECK(as_outline.missed > as_block.missed);
  }
}

TEST_CASE("what rows miss is told, by the rim or by another order", "[quad_rows]") {
  const auto on_ball = [](Points& vertices) {
    for (Index v = 0; v < vertices.rows(); ++v) {
      const Vec3 p = vertices.row(v);
      vertices.row(v) = (6.0 * (Vec3(6, 6, 6) - p).stableNormalized()).transpose();
    }
  };
  Quads corner = Quads::corner(6);
  Faces left;
  const QuadsInside quads = corner.taken_out(at_the_corner, left);
  on_ball(corner.vertices);
  const ContinuedRows made = continued_quads(corner.vertices, Connectivity(left, corner.vertices.rows()), quads);
  REQUIRE(made.order > 0);
  const Points off = made.inside - corner.vertices(corner.lost, Eigen::all);
  CHECK(off.rowwise().norm().maxCoeff() > 1e-3);
  CHECK(off.norm() / std::sqrt(static_cast<double>(off.rows())) < made.missed);
}

TEST_CASE("creases go on in rows as far as they are sharp", "[quad_rows]") {
  const Quads corner = Quads::corner(6);
  Faces left;
  const QuadsInside quads = corner.taken_out(at_the_corner, left);
  FillOptions options;
  options.rim = quads.rim;
  options.output = Output::quads;
  const Fill fill = tripatch::fill({corner.vertices, left}, options);
  CHECK(fill.report.method == "quad_rows");
  CHECK(fill.feature_edges.size() == 9);
  CHECK(fill.report.poles.size() == 1);
  for (const auto& [a, b] : fill.feature_edges)
    for (const Index v : {a, b}) {
      const Vec3 p =
          v < corner.vertices.rows() ? Vec3(corner.vertices.row(v)) : Vec3(fill.vertices.row(v - corner.vertices.rows()));
      CHECK((p.array().abs() < 1e-9).count() >= 2);  // on an axis
    }
  options.features = false;
  CHECK(tripatch::fill({corner.vertices, left}, options).feature_edges.empty());
}
