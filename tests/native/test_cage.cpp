#include <algorithm>
#include <catch2/catch.hpp>
#include <set>

#include "test_cages.h"
#include "tripatch/cage/cage_layout.h"
#include "tripatch/cage/cage_samples.h"
#include "tripatch/cage/closed_cage.h"
#include "tripatch/cage/limit_mesh.h"
#include "tripatch/report/folded_triangles.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

double flat(double, double) { return 0; }

std::vector<CageHole> laid_out(const CubeCorner& corner, int rows) {
  return {{corner.hole, cage_layout(corner.hole, corner.vertices, false, rows, {0, 0})}};
}

}  // namespace

TEST_CASE("rows are tried one after the other, those asked for after the plain layout", "[cage]") {
  CHECK(rows_to_try({}, false, false) == std::vector<int>{0, 1, 2, 3, 4});
  CHECK(rows_to_try({}, false, true) == std::vector<int>{0, 1, 2, 3, 4});
  CHECK(rows_to_try({.rows = 2}, false, false) == std::vector<int>{0, 2});
  CHECK(rows_to_try({.rows = 2}, false, true) == std::vector<int>{2});
  CHECK(rows_to_try({.rows = 0}, false, false) == std::vector<int>{0});
  CHECK(rows_to_try({}, true, false) == std::vector<int>{0});
}

TEST_CASE("an odd rim gets a vertex in the middle of its longest edge, with its creases and corners", "[cage]") {
  Points vertices(6, 3);
  vertices << 0, 0, 0, 1, 0, 0, 0, 1.2, 0, -1, -1, 0, 2, -1, 0, -1, 2, 0;
  Faces faces;
  for (const std::array<Index, 4>& quad : {std::array<Index, 4>{1, 0, 3, 4}, {2, 1, 4, 5}, {0, 2, 5, 3}}) faces.add(quad);
  const Hole hole = {{0, 1, 2}, {0, 1, 2}};
  Subdivision settings;
  settings.crease_edges = {{2, 1}, {0, 1}};
  settings.edge_creases = {0.5, 0.25};
  const SplitMesh split = split_odd_rims({vertices, faces}, {hole}, settings, true);
  REQUIRE(split.split[0]);
  CHECK(split.split[0]->middle == 6);
  CHECK(split.split[0]->edge == std::array<Index, 2>{1, 2});  // the longest
  CHECK((split.vertices.row(6) - 0.5 * (vertices.row(1) + vertices.row(2))).norm() == 0);
  CHECK(split.holes[0].rim == std::vector<Index>{0, 1, 6, 2});
  CHECK(split.holes[0].corners == std::vector<Index>{0, 1, 3});
  CHECK(split.faces[0].size() == 4);
  CHECK(std::vector<Index>(split.faces[1].begin(), split.faces[1].end()) == std::vector<Index>{2, 6, 1, 4, 5});
  CHECK(split.settings.crease_edges == std::vector<std::array<Index, 2>>{{1, 6}, {0, 1}, {6, 2}});
  CHECK(split.settings.edge_creases == std::vector<double>{0.5, 0.25, 0.5});
  CHECK(!split_odd_rims({vertices, faces}, {hole}, settings, false).split[0]);
}

TEST_CASE("a closed cage has the surroundings first, no border at the rim, and starts in the plane of the corners", "[cage]") {
  for (int rings : {1, 2, 3}) {
    const CubeCorner corner(rings + 3, rings, flat);
    for (int rows : {0, 2}) {
      const std::vector<CageHole> holes = laid_out(corner, rows);
      const ClosedCage cage = close_holes(corner.mesh(), holes, {});
      CHECK(cage.kept.size() == static_cast<std::size_t>(corner.faces.size()));
      CHECK(cage.first_face == std::vector<Index>{corner.faces.size(), cage.faces.size()});
      CHECK(find_holes(cage.faces).size() == 1);  // the outer border
      CHECK(cage.vertices.col(2).norm() < 1e-14);
      const DirectedEdges edges = rim_edges(Connectivity(cage.mesh()), holes);
      const std::vector<Index>& rim = corner.hole.rim;
      for (std::size_t k = 0; k < rim.size(); ++k) {
        const Index a = rim[k], b = rim[(k + 1) % rim.size()];
        CHECK(edges.at({a, b}).face >= cage.first_face[0]);
        CHECK(edges.at({b, a}).face < cage.first_face[0]);
      }
      if (rows == 0) CHECK(cage.faces.size() == corner.whole.size());  // the faces that were taken out
    }
  }
}

TEST_CASE("replaced faces are left out, and rings count by what touches the rim", "[cage]") {
  const CubeCorner corner(5, 2, flat);
  const std::vector<CageHole> holes = laid_out(corner, 0);
  const ClosedCage cage = close_holes({corner.vertices, corner.whole}, holes, corner.gone);
  CHECK(cage.faces.size() == corner.whole.size());
  for (Index f : cage.kept) CHECK(std::count(corner.gone.begin(), corner.gone.end(), f) == 0);
  const auto rings = rings_around(cage, Connectivity(cage.mesh()), corner.hole);
  CHECK(rings[0].size() == 3 * (2 * 2 + 1));  // around a square of 2 x 2 in its corner: 2 + 1 + 2
  CHECK(rings[1].size() == 3 * (2 * 3 + 1));
  std::set<Index> all(rings[0].begin(), rings[0].end());
  all.insert(rings[1].begin(), rings[1].end());
  CHECK(all.size() == rings[0].size() + rings[1].size());
}

TEST_CASE("samples are spread evenly, and their coordinates are linear in those of the face", "[cage]") {
  const Points square = (Points(4, 3) << 1, 0, 0, 0, 1, 0, 0, 0, 1, 0.5, 0, 0.5).finished();
  const std::vector<Index> four = {0, 1, 2, 3}, three = {0, 1, 2};
  for (const bool loop : {false, true}) {
    const std::vector<Index>& face = loop ? three : four;
    const std::vector<FacePlace> places = spread_places(face.size(), loop);
    CHECK(places.size() == (loop ? 10 : 16));
    Vec3 mean = Vec3::Zero(), center = Vec3::Zero();
    for (const FacePlace& place : places) mean += barycentric_at(place, face, square, loop) / static_cast<double>(places.size());
    for (Index v : face) center += square.row(v) / static_cast<double>(face.size());
    CHECK((mean - center).norm() < 1e-15);
  }
  CHECK(spread_places(5, false).size() == 5 * 4);
  CHECK((barycentric_at({0, 1, 0}, four, square, false) - Vec3::UnitY()).norm() < 1e-15);
  CHECK((barycentric_at({2, 0, 0}, three, square, false) - Vec3::UnitZ()).norm() < 1e-15);
  CHECK((barycentric_at({1, 1, 1}, three, square, false) - Vec3::Constant(1.0 / 3)).norm() < 1e-15);
}

TEST_CASE("quarters of a face that is no quad meet in the middles of its edges and in its own", "[cage]") {
  const Points corners = (Points(5, 3) << 1, 0, 0, 0, 1, 0, 0, 0.4, 0.6, 0.1, 0.3, 0.6, 0.7, 0, 0.3).finished();
  for (const std::vector<Index>& face : {std::vector<Index>{0, 1, 2}, {0, 1, 2, 3, 4}}) {
    const int n = static_cast<int>(face.size());
    for (int k = 0; k < n; ++k) {
      const Vec3 here = corners.row(k), next = corners.row((k + 1) % n);
      const auto at = [&](int quarter, double u, double v) { return mean_at({quarter, u, v}, face, corners, false); };
      CHECK((at(k, 0, 0) - here).norm() < 1e-15);
      CHECK((at(k, 1, 0) - (here + next) / 2).norm() < 1e-15);
      CHECK((at((k + 1) % n, 0, 1) - (here + next) / 2).norm() < 1e-15);
      CHECK((at(k, 1, 0.3) - at((k + 1) % n, 0.3, 1)).norm() < 1e-15);  // the spoke between two quarters
      CHECK((at(k, 1, 1) - at(0, 1, 1)).norm() < 1e-15);
    }
  }
}

TEST_CASE("a limit mesh of triangles has one vertex at each place, whichever edges of theirs two faces share", "[cage]") {
  // an icosahedron, whose faces begin at corners that differ
  Points vertices(12, 3);
  const double g = (1 + std::sqrt(5.0)) / 2;
  vertices << -1, g, 0, 1, g, 0, -1, -g, 0, 1, -g, 0, 0, -1, g, 0, 1, g, 0, -1, -g, 0, 1, -g, g, 0, -1, g, 0, 1, -g, 0, -1, -g, 0,
      1;
  Faces faces;
  const std::vector<std::array<Index, 3>> triangles = {
      {0, 11, 5}, {5, 1, 0}, {0, 1, 7}, {10, 0, 7}, {0, 10, 11}, {1, 5, 9}, {11, 4, 5}, {10, 2, 11}, {7, 6, 10}, {7, 1, 8},
      {3, 9, 4},  {4, 2, 3}, {3, 2, 6}, {8, 3, 6},  {3, 8, 9},   {4, 9, 5}, {4, 11, 2}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (const auto& t : triangles) faces.add(t);
  Subdivision settings;
  settings.loop = true;
  for (int level : {1, 2, 3}) {
    const LimitMesh mesh = sample_limit({vertices, faces}, settings, 0, level);
    CHECK(mesh.faces.size() == 20 * (Index{1} << (2 * level)));
    CHECK(mesh.vertices.rows() == 2 + mesh.faces.size() / 2);
    CHECK(count_folded_edges(mesh.vertices, Points(0, 3), mesh.faces) == 0);
    double longest = 0, shortest = INFINITY;
    for (Index f = 0; f < mesh.faces.size(); ++f)
      for (int k = 0; k < 3; ++k) {
        const double length = (mesh.vertices.row(mesh.faces[f][k]) - mesh.vertices.row(mesh.faces[f][(k + 1) % 3])).norm();
        longest = std::max(longest, length);
        shortest = std::min(shortest, length);
      }
    CHECK(longest < 1.5 * shortest);
  }
}

TEST_CASE("a limit mesh shares its vertices between faces and reproduces a plane", "[cage]") {
  const CubeCorner corner(4, 1, [](double x, double y) { return 0.3 * x - 0.2 * y; });
  for (int level : {1, 3}) {
    const Index steps = Index{1} << level;
    const LimitMesh mesh = sample_limit({corner.vertices, corner.whole}, {}, 0, level);
    CHECK(mesh.faces.size() == corner.whole.size() * steps * steps);
    // three grids of (4 steps)^2 cells with common axes: inside points, three half axes, the corner
    const Index side = 4 * steps;
    CHECK(mesh.vertices.rows() == 3 * side * side + 3 * side + 1);
    CHECK((mesh.vertices.col(2) - 0.3 * mesh.vertices.col(0) + 0.2 * mesh.vertices.col(1)).cwiseAbs().maxCoeff() < 1e-13);
  }
}
