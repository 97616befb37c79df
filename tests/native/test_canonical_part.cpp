#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "tripatch/math/canonical_start.h"
#include "tripatch/mesh/border_loops.h"
#include "tripatch/mesh/canonical_part.h"

using namespace tripatch;

namespace {

using IndexList = std::vector<Index>;

struct OwnMesh {
  Points vertices;
  Faces faces;
  operator Mesh() const { return {vertices, faces}; }  // NOLINT(google-explicit-constructor): as in the library
};

/// A grid of quads, some of them cut, with a hole in the middle. jitter: how far vertices are off, in edges.
OwnMesh grid_with_hole(double jitter) {
  constexpr Index n = 9;
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> off(-jitter, jitter);
  OwnMesh mesh;
  mesh.vertices.resize((n + 1) * (n + 1), 3);
  for (Index i = 0; i <= n; ++i)
    for (Index k = 0; k <= n; ++k)
      mesh.vertices.row(i * (n + 1) + k) << static_cast<double>(i) + off(random), static_cast<double>(k) + off(random),
          off(random);
  for (Index i = 0; i < n; ++i)
    for (Index k = 0; k < n; ++k) {
      const Index a = i * (n + 1) + k, b = a + n + 1;
      if (i >= 3 && i < 6 && k >= 3 && k < 6) continue;
      if ((i + 2 * k) % 3 == 0 && jitter > 0) {
        mesh.faces.add(IndexList{a, b, b + 1});
        mesh.faces.add(IndexList{a, b + 1, a + 1});
      } else {
        mesh.faces.add(IndexList{a, b, b + 1, a + 1});
      }
    }
  return mesh;
}

/// The same with other numbers; in a mirror its faces are turned.
OwnMesh written_otherwise(const OwnMesh& mesh, int seed, bool mirrored, IndexList& number) {
  std::mt19937_64 random(seed);
  number.resize(mesh.vertices.rows());
  std::iota(number.begin(), number.end(), 0);
  std::shuffle(number.begin(), number.end(), random);
  OwnMesh other;
  other.vertices.resize(mesh.vertices.rows(), 3);
  for (Index v = 0; v < mesh.vertices.rows(); ++v) other.vertices.row(number[v]) = mesh.vertices.row(v);
  if (mirrored) other.vertices.col(0) *= -1;
  IndexList order(mesh.faces.size());
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), random);
  for (Index f : order) {
    IndexList face;
    for (Index v : mesh.faces[f]) face.push_back(number[v]);
    std::rotate(face.begin(), face.begin() + static_cast<std::ptrdiff_t>(random() % face.size()), face.end());
    if (mirrored) std::reverse(face.begin(), face.end());
    other.faces.add(face);
  }
  return other;
}

IndexList all_faces(const OwnMesh& mesh) {
  IndexList all(mesh.faces.size());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

/// The inner border, from another vertex on.
IndexList hole_of_grid(const OwnMesh& mesh, int turn) {
  IndexList loop = border_loops(Connectivity(mesh))[0];
  std::rotate(loop.begin(), loop.begin() + turn, loop.end());
  return loop;
}

CanonicalPart part_of(const OwnMesh& mesh, const IndexList& rim) {
  return canonical_part(mesh, Connectivity(mesh), {rim}, all_faces(mesh));
}

Points polygon(const std::vector<double>& radius) {
  Points p(static_cast<Index>(radius.size()), 3);
  for (Index k = 0; k < p.rows(); ++k) {
    const double turn = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(p.rows());
    p.row(k) << radius[k] * std::cos(turn), radius[k] * std::sin(turn), 0;
  }
  return p;
}

}  // namespace

TEST_CASE("whatever numbers a mesh has, what surrounds its hole is the same part, bit for bit, in a mirror too") {
  const OwnMesh mesh = grid_with_hole(0.2);
  const CanonicalPart part = part_of(mesh, hole_of_grid(mesh, 0));
  REQUIRE(part.vertices.rows() == mesh.vertices.rows() - 4);  // those in the hole are nobody's
  REQUIRE(part.faces.size() == mesh.faces.size());
  for (int seed = 1; seed <= 4; ++seed) {
    const bool mirrored = seed % 2 == 0;
    IndexList number;
    const OwnMesh other = written_otherwise(mesh, seed, mirrored, number);
    const CanonicalPart same = part_of(other, hole_of_grid(other, seed));
    CHECK(same.mirrored == (part.mirrored != mirrored));
    CHECK(same.vertices == part.vertices);
    CHECK(same.faces.corners == part.faces.corners);
    CHECK(same.faces.offsets == part.faces.offsets);
    CHECK(same.loops == part.loops);
    for (Index v = 0; v < part.vertices.rows(); ++v) CHECK(same.vertex[v] == number[part.vertex[v]]);
  }
}

TEST_CASE("a canonical part says what its numbers were, and its rim runs as new faces do") {
  const OwnMesh mesh = grid_with_hole(0.2);
  for (int turn : {0, 3}) {
    const IndexList rim = hole_of_grid(mesh, turn);
    const CanonicalPart part = part_of(mesh, rim);
    const Connectivity known(Mesh{part.vertices, part.faces});
    REQUIRE(part.loops.size() == 1);
    REQUIRE(part.row.size() == rim.size());
    for (std::size_t k = 0; k < rim.size(); ++k) {
      const Index v = part.loops[0][k], next = part.loops[0][(k + 1) % rim.size()];
      CHECK(part.vertex[v] == rim[part.row[k]]);
      CHECK(known.edge(next, v));
      CHECK_FALSE(known.edge(v, next));
    }
    for (Index v = 0; v < part.vertices.rows(); ++v) {
      CHECK(std::abs(part.vertices(v, 0)) == std::abs(mesh.vertices(part.vertex[v], 0)));
      CHECK(part.vertices.row(v).tail<2>() == mesh.vertices.row(part.vertex[v]).tail<2>());
    }
    for (Index f = 0; f < part.faces.size(); ++f) CHECK(part.faces[f].size() == mesh.faces[part.face[f]].size());
  }
}

TEST_CASE("where beginnings of a rim are alike it is begun at the lowest number, forwards") {
  const OwnMesh mesh = grid_with_hole(0);
  const IndexList rim = hole_of_grid(mesh, 5);
  const CanonicalPart part = part_of(mesh, rim);
  CHECK_FALSE(part.mirrored);
  const Index first = part.vertex[part.loops[0][0]];
  // the four corners are alike, and so are their mirror images
  IndexList corners;
  for (Index v : rim)
    if (std::abs(std::abs(mesh.vertices(v, 0) - 4.5) - std::abs(mesh.vertices(v, 1) - 4.5)) < 1e-12) corners.push_back(v);
  REQUIRE(corners.size() == 4);
  CanonicalStarts beginnings(mesh.vertices(rim, Eigen::all));
  beginnings.compare_along();
  REQUIRE(beginnings.left().size() == 8);
  Index lowest = rim[beginnings.left()[0].place];
  for (const CanonicalStart& b : beginnings.left())
    if (!b.backwards) lowest = std::min(lowest, rim[b.place]);
  CHECK(first == lowest);
}

TEST_CASE("where a rim alone does not say where it begins two rings around it do, whatever lies beyond") {
  // a vertex of the grid is higher, one of the hole's four corners and one direction are nearest to it
  const auto begun = [](const std::vector<std::pair<Index, double>>& higher) {
    OwnMesh mesh = grid_with_hole(0);
    for (const auto& [v, height] : higher) mesh.vertices(v, 2) += height;
    const CanonicalPart part = part_of(mesh, hole_of_grid(mesh, 5));
    return std::pair(part.vertex[part.loops[0][0]], part.vertex[part.loops[0][1]]);
  };
  const auto at = [](Index i, Index k) { return i * 10 + k; };
  const Index first_ring = at(2, 4), second_ring = at(1, 4), third_ring = at(0, 4), elsewhere = at(9, 8);
  const auto beyond = begun({{elsewhere, 5}});
  for (const Index v : {first_ring, second_ring}) {
    REQUIRE(begun({{v, 0.5}}) != beyond);
    CHECK(begun({{v, 0.5}, {elsewhere, 5}}) == begun({{v, 0.5}}));
  }
  REQUIRE(begun({{third_ring, 0.5}}) != beyond);
  CHECK(begun({{third_ring, 0.5}, {elsewhere, 5}}) == beyond);
}

TEST_CASE("islands are begun by their geometry, and come by their length") {
  const OwnMesh mesh = grid_with_hole(0.2);
  const std::vector<IndexList> loops = border_loops(Connectivity(mesh));
  REQUIRE(loops.size() == 2);
  for (bool mirrored : {false, true}) {
    IndexList number;
    const OwnMesh other = written_otherwise(mesh, 7, mirrored, number);
    std::vector<IndexList> there = border_loops(Connectivity(other));
    const CanonicalPart one = canonical_part(mesh, Connectivity(mesh), loops, all_faces(mesh));
    const CanonicalPart same = canonical_part(other, Connectivity(other), there, all_faces(other));
    CHECK(same.vertices == one.vertices);
    CHECK(same.loops == one.loops);
  }
}

TEST_CASE("a polygon is begun at the same vertex however it is given, and walked the same way") {
  std::vector<double> radius = {1, 1.2, 0.9, 1.05, 1.3, 0.8, 1.1};
  const Index n = static_cast<Index>(radius.size());
  const Points p = polygon(radius);
  CanonicalStarts beginnings(p);
  beginnings.compare_along();
  REQUIRE(beginnings.decided());
  const CanonicalStart first = beginnings.left()[0];
  for (Index turn = 0; turn < n; ++turn)
    for (const bool reversed : {false, true}) {
      Points given(n, 3);
      for (Index k = 0; k < n; ++k) given.row(k) = p.row((reversed ? 2 * n - k + turn : k + turn) % n);
      CanonicalStarts again(given);
      again.compare_along();
      REQUIRE(again.decided());
      CHECK(given.row(again.left()[0].place) == p.row(first.place));
      CHECK(again.left()[0].backwards == (first.backwards != reversed));
    }
}

TEST_CASE("beginnings that are alike are all left, and points beside them tell them apart") {
  const Points p = polygon(std::vector<double>(6, 1.0));
  CanonicalStarts beginnings(p);
  beginnings.compare_along();
  CHECK(beginnings.left().size() == 12);
  Points chiral(6, 3);  // next to each edge, nearer to its beginning
  for (Index k = 0; k < 6; ++k) chiral.row(k) = 1.2 * (0.7 * p.row(k) + 0.3 * p.row((k + 1) % 6));
  beginnings.compare_with(chiral);
  REQUIRE(beginnings.left().size() == 6);
  for (const CanonicalStart& b : beginnings.left()) CHECK_FALSE(b.backwards);
  Points one = chiral.topRows(3);
  one.row(1) *= NAN;  // what is no place does not count
  one.row(2) *= INFINITY;
  beginnings.compare_with(one);
  CHECK(beginnings.decided());
}

TEST_CASE("a polygon is begun where it may be, in the direction that is given") {
  CanonicalStarts any(polygon({1, 1.2, 0.9, 1.05, 1.3, 0.8, 1.1}), true, {2, 5});
  for (const CanonicalStart& b : any.left()) CHECK(b.backwards);
  any.compare_along();
  REQUIRE(any.decided());
  CHECK((any.left()[0].place == 2 || any.left()[0].place == 5));
}
