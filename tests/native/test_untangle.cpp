#include <catch2/catch.hpp>

#include "tripatch/mesh/triangles.h"
#include "tripatch/report/folded_triangles.h"
#include "tripatch/triangulation/untangle.h"

using namespace tripatch;

namespace {

/// A flat grid of n x n squares in two triangles each, the border's vertices first.
struct Sheet {
  Points points;
  std::vector<std::array<Index, 3>> triangles;
  Index border = 0;
  std::vector<Index> row;  ///< of place i * (n + 1) + j

  explicit Sheet(Index n) : points((n + 1) * (n + 1), 3), row((n + 1) * (n + 1)) {
    Index next = 0;
    for (const bool inside : {false, true})
      for (Index i = 0; i <= n; ++i)
        for (Index j = 0; j <= n; ++j) {
          if ((i > 0 && i < n && j > 0 && j < n) != inside) continue;
          if (!inside) ++border;
          points.row(next) << static_cast<double>(i), static_cast<double>(j), 0;
          row[i * (n + 1) + j] = next++;
        }
    for (Index i = 0; i < n; ++i)
      for (Index j = 0; j < n; ++j) {
        const Index a = i * (n + 1) + j, b = a + n + 1;
        triangles.push_back({row[a], row[b], row[b + 1]});
        triangles.push_back({row[a], row[b + 1], row[a + 1]});
      }
  }
  Index folds() const { return count_folded_edges(points, Points(0, 3), faces_of(triangles)); }
};

}  // namespace

TEST_CASE("a vertex that was pushed over its neighbor is put back between its neighbors") {
  Sheet sheet(8);
  const Points flat = sheet.points;
  const Index pushed = sheet.row[4 * 9 + 4];
  sheet.points.row(pushed) << 5.3, 5.3, 0;
  REQUIRE(sheet.folds() > 0);
  const Points before = sheet.points;
  CHECK(untangle(sheet.points, sheet.triangles, sheet.border, 0) == 0);
  CHECK(sheet.folds() == 0);
  CHECK(sheet.points.topRows(sheet.border) == before.topRows(sheet.border));
  CHECK((sheet.points.row(pushed) - flat.row(pushed)).norm() < 0.5);
  CHECK(sheet.points.row(sheet.row[9 + 1]) == flat.row(sheet.row[9 + 1]));  // far from the fold nothing moves
}

TEST_CASE("what does not fold, or may fold so much, stays as it is") {
  Sheet sheet(8);
  const Points flat = sheet.points;
  CHECK(untangle(sheet.points, sheet.triangles, sheet.border, 0) == 0);
  CHECK(sheet.points == flat);
  sheet.points.row(sheet.row[4 * 9 + 4]) << 5.3, 5.3, 0;
  const Points folded = sheet.points;
  const Index folds = sheet.folds();
  CHECK(untangle(sheet.points, sheet.triangles, sheet.border, folds) == folds);
  CHECK(sheet.points == folded);
}

TEST_CASE("folds of fixed vertices, and of a surface that folds all over, are left and counted") {
  Sheet sheet(8);
  const Points flat = sheet.points;
  sheet.points.row(sheet.row[4]) << 1.6, 5.3, 0;  // of the border
  const Index at_border = sheet.folds();
  REQUIRE(at_border > 0);
  const Points before = sheet.points;
  CHECK(untangle(sheet.points, sheet.triangles, sheet.points.rows(), 0) == at_border);
  CHECK(sheet.points == before);
  sheet.points = flat;
  for (Index i = 1; i < 8; i += 2)
    for (Index j = 1; j < 8; j += 2) sheet.points.row(sheet.row[i * 9 + j]) << static_cast<double>(i) + 1.3, j + 1.3, 0;
  const Index all_over = sheet.folds();
  const Points crumpled = sheet.points;
  CHECK(untangle(sheet.points, sheet.triangles, sheet.border, 0) == all_over);
  CHECK(sheet.points == crumpled);
}

TEST_CASE("a vertex that was pushed over the rim is put back: its triangle was folded over the face beyond") {
  Sheet sheet(8);
  const Index pushed = sheet.row[4 * 9 + 1], left = sheet.row[3 * 9], right = sheet.row[4 * 9], last = sheet.row[5 * 9];
  const Vec3 beyond = Vec3(sheet.points.row(sheet.row[10]) - sheet.points.row(sheet.row[0]))
                          .cross(Vec3(sheet.points.row(sheet.row[1]) - sheet.points.row(sheet.row[0])));
  sheet.points.row(pushed) << 4, -0.4, 0;
  const std::vector<AdjacentFace> faces = {{left, right, beyond}, {right, last, beyond}};
  const Faces triangles = faces_of(sheet.triangles);
  REQUIRE(count_folded_edges(sheet.points, Points(0, 3), triangles, faces) > sheet.folds());
  CHECK(untangle(sheet.points, sheet.triangles, sheet.border, 0, faces) == 0);
  CHECK(count_folded_edges(sheet.points, Points(0, 3), triangles, faces) == 0);
  CHECK(sheet.points(pushed, 1) > 0);
}

TEST_CASE("an ear at the rim that folds back over the face beyond is flipped away, none of which the mesh has") {
  // The rim turns away from the hole at 1: the ear 0-1-2 lies outside. Flipped, 0-1 belongs to the vertex 3 inside.
  Points points(4, 3);
  points << 0, 0, 0, 4, 0, 0, 5, -1, 0, 2, 3, 0;
  const std::vector<std::array<Index, 3>> folded = {{0, 1, 2}, {0, 2, 3}};
  const std::vector<AdjacentFace> beyond = {{0, 1, Vec3(0, 0, 1)}};
  std::vector<std::array<Index, 3>> triangles = folded;
  CHECK(flip_folded(points, triangles, std::vector<std::array<Index, 2>>{{1, 3}}, 0, beyond) > 0);
  CHECK(triangles == folded);
  CHECK(flip_folded(points, triangles, {}, 0, beyond) == 0);
  REQUIRE(triangles.size() == 2);
  CHECK(count_folded_edges(points, Points(0, 3), faces_of(triangles), beyond) == 0);
}
