// All holes of a mesh with what belongs to each, on plane lattices: islands, borders that lie on each other, and what is no hole.
#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <functional>
#include <set>
#include <utility>

#include "tripatch/fill.h"

using namespace tripatch;

namespace {

/// Unit squares from (0, bottom) on, 12 a row, without those for which `gone` holds (by column and row).
void add_lattice(OwnMesh& mesh, int bottom, int rows, double shift, const std::function<bool(int, int)>& gone) {
  constexpr int n = 12;
  const Index first = mesh.vertices.rows();
  mesh.vertices.conservativeResize(first + (n + 1) * (rows + 1), 3);
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= n; ++i) mesh.vertices.row(first + j * (n + 1) + i) = Vec3(i + shift, bottom + j, 0);
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < n; ++i)
      if (!gone(i, bottom + j)) {
        const Index a = first + j * (n + 1) + i, b = a + n + 1;
        mesh.faces.add(std::array<Index, 4>{a, a + 1, b + 1, b});
      }
}

bool within(int i, int j, int first, int size) { return i >= first && i < first + size && j >= first && j < first + size; }

double area(const OwnMesh& mesh) {
  double sum = 0;
  for (Index f = 0; f < mesh.faces.size(); ++f) {
    const auto face = mesh.faces[f];
    for (std::size_t k = 2; k < face.size(); ++k) {
      const Vec3 p = mesh.vertices.row(face[0]), q = mesh.vertices.row(face[k - 1]), r = mesh.vertices.row(face[k]);
      sum += 0.5 * (q - p).cross(r - p).norm();
    }
  }
  return sum;
}

}  // namespace

TEST_CASE("a piece that floats in a hole is joined to it") {
  OwnMesh mesh{Points(0, 3), {}};
  add_lattice(mesh, 0, 12, 0, [](int i, int j) { return within(i, j, 2, 8) && !within(i, j, 5, 2); });
  const Holes holes = find_all_holes(mesh);
  REQUIRE(holes.rims.size() == 1);
  CHECK(holes.rims[0].size() == 32);
  REQUIRE(holes.islands[0].size() == 1);
  CHECK(holes.islands[0][0].size() == 8);
  CHECK(holes.outer.size() == 1);
  CHECK(holes.borders.size() == 3);
  std::size_t last = 0;
  const auto results = fill_all(mesh, holes, {}, {}, [&](std::size_t done) { last = done; });
  CHECK(last == 1);
  REQUIRE(std::holds_alternative<Fill>(results[0]));
  CHECK(area(with_fills(mesh, results)) == Approx(144));  // a fill that covered the piece would add 4

  const Holes apart = find_all_holes(mesh, {}, false);
  CHECK(apart.islands[0].empty());
  CHECK(apart.outer.size() == 2);
}

TEST_CASE("a hole across a seam of doubled vertices is one, and its fill takes those of the faces next to it") {
  OwnMesh mesh{Points(0, 3), {}};
  const auto gone = [](int i, int j) { return within(i, j, 4, 4); };
  add_lattice(mesh, 0, 6, 0, gone);
  add_lattice(mesh, 6, 6, 0, gone);
  const Holes holes = find_all_holes(mesh);
  REQUIRE(holes.rims.size() == 1);
  CHECK(holes.rims[0].size() == 16);
  CHECK(holes.outer.size() == 1);
  const auto results = fill_all(mesh, holes);
  REQUIRE(std::holds_alternative<Fill>(results[0]));
  const OwnMesh whole = with_fills(mesh, results);
  std::set<std::pair<Index, Index>> edges;
  for (Index f = 0; f < whole.faces.size(); ++f)
    for (std::size_t k = 0; k < whole.faces[f].size(); ++k)
      edges.emplace(whole.faces[f][k], whole.faces[f][(k + 1) % whole.faces[f].size()]);
  int open = 0;
  for (Index f = 0; f < mesh.faces.size(); ++f)
    for (std::size_t k = 0; k < 4; ++k) {
      const Index a = mesh.faces[f][k], b = mesh.faces[f][(k + 1) % 4];
      const Vec3 p = mesh.vertices.row(a), q = mesh.vertices.row(b);
      const bool inside = p.x() > 3 && p.x() < 9 && p.y() > 3 && p.y() < 9, on_seam = p.y() == 6 && q.y() == 6;
      open += inside && !on_seam && !edges.contains({b, a}) ? 1 : 0;
    }
  CHECK(open == 0);
  CHECK(area(whole) == Approx(144));
}

TEST_CASE("borders that lie on each other with other vertices are refused with the place") {
  OwnMesh mesh{Points(0, 3), {}};
  add_lattice(mesh, 0, 6, 0, [](int, int) { return false; });
  add_lattice(mesh, 6, 6, 0.5, [](int, int) { return false; });
  const Holes holes = find_all_holes(mesh);
  REQUIRE(holes.rims.size() == 2);
  const auto results = fill_all(mesh, holes);
  for (std::size_t k = 0; k < 2; ++k) {
    const auto* const refused = std::get_if<Refused>(&results[k]);
    REQUIRE(refused);
    CHECK(refused->message.code == Code::edges_on_borders);
    CHECK(refused->message.where == holes.rims[k]);
  }
}
