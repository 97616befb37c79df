#include <algorithm>
#include <catch2/catch.hpp>
#include <numeric>
#include <random>

#include "tripatch/mesh/border_loops.h"
#include "tripatch/mesh/connectivity.h"

using namespace tripatch;

namespace {

using Loop = std::vector<Index>;

Faces faces_of(const std::vector<Loop>& all) {
  Faces faces;
  for (const Loop& face : all) faces.add(face);
  return faces;
}

/// A grid of n x n cells; vertex i n + ... row by row, quads or two triangles each, counter-clockwise.
Faces grid(Index n, bool triangles) {
  Faces faces;
  for (Index i = 0; i < n; ++i)
    for (Index k = 0; k < n; ++k) {
      const Index a = i * (n + 1) + k, b = a + 1, c = a + n + 2, d = a + n + 1;
      if (triangles) {
        faces.add(Loop{a, b, c});
        faces.add(Loop{a, c, d});
      } else {
        faces.add(Loop{a, b, c, d});
      }
    }
  return faces;
}

Points places(Index n) {
  Points p((n + 1) * (n + 1), 3);
  for (Index v = 0; v < p.rows(); ++v) {
    const Index row = v / (n + 1), column = v % (n + 1);
    p.row(v) << static_cast<double>(column), static_cast<double>(row), 0;
  }
  return p;
}

Loop faces_at(const Connectivity& mesh, Index v) {
  Loop found;
  for (Connectivity::Corner c : mesh.at(v)) found.push_back(mesh.face(c));
  return found;
}

}  // namespace

TEST_CASE("faces at a vertex, and the corners before and after: as a search over all faces finds them") {
  Faces mixed = grid(4, true);
  mixed.add(Loop{0, 5, 30, 31, 32});
  mixed.add(Loop{31, 30, 33, 34});
  for (const Faces& faces : {grid(4, true), grid(4, false), mixed}) {
    const Connectivity mesh(faces);
    const Index n = *std::max_element(faces.corners.begin(), faces.corners.end()) + 1;
    CHECK(mesh.vertices() == n);
    for (Index v = 0; v < n; ++v) {
      Loop expected, next, previous, found_next, found_previous;
      for (Index f = 0; f < faces.size(); ++f) {
        const auto face = faces[f];
        for (std::size_t k = 0; k < face.size(); ++k)
          if (face[k] == v) {
            expected.push_back(f);
            next.push_back(face[(k + 1) % face.size()]);
            previous.push_back(face[(k + face.size() - 1) % face.size()]);
          }
      }
      for (Connectivity::Corner c : mesh.at(v)) {
        found_next.push_back(mesh.next(c));
        found_previous.push_back(mesh.previous(c));
        CHECK(faces[mesh.face(c)][mesh.place(c)] == v);
      }
      CHECK(faces_at(mesh, v) == expected);
      CHECK(found_next == next);
      CHECK(found_previous == previous);
    }
  }
}

TEST_CASE("edges know their faces, in one direction and in both") {
  const Faces faces = grid(2, false);  // 0 1 2 / 3 4 5 / 6 7 8
  const Connectivity mesh(faces);
  CHECK(mesh.face(*mesh.edge(1, 4)) == 0);
  CHECK(mesh.place(*mesh.edge(1, 4)) == 1);
  CHECK(mesh.face(*mesh.edge(4, 1)) == 1);
  CHECK(!mesh.edge(1, 0));
  CHECK(mesh.faces_at_edge(4, 1) == Loop{0, 1});
  CHECK(mesh.faces_at_edge(1, 0) == Loop{0});
  CHECK(mesh.faces_at_edge(0, 4).empty());
}

TEST_CASE("a one-ring runs around its vertex, from the border on where there is one") {
  const Faces faces = grid(2, true);
  const Connectivity mesh(faces);
  Loop ring = mesh.one_ring(4);
  std::rotate(ring.begin(), std::min_element(ring.begin(), ring.end()), ring.end());
  CHECK(ring == Loop{0, 1, 5, 8, 7, 3});
  CHECK(mesh.one_ring(0) == Loop{1, 4, 3});
  CHECK(mesh.one_ring(1) == Loop{2, 5, 4, 0});
  // two fans that touch, and faces that disagree
  const Faces touching = faces_of({{0, 1, 2}, {0, 3, 4}}), flipped = faces_of({{0, 1, 2}, {0, 3, 2}});
  CHECK(Connectivity(touching).one_ring(0).empty());
  CHECK(Connectivity(flipped).one_ring(0).empty());
  CHECK(Connectivity(touching, 6).one_ring(5).empty());
}

TEST_CASE("replaced faces are not there; the wrong ones are named") {
  const Faces faces = grid(2, false);
  const Connectivity mesh(faces, {}, Loop{0, 3});
  CHECK(faces_at(mesh, 4) == Loop{1, 2});
  CHECK(faces_at(mesh, 0).empty());
  CHECK(border_loops(mesh).size() == 2);
  CHECK_THROWS_WITH(Connectivity(faces, {}, Loop{4}), "replaced names face 4; the mesh has 4 faces");
  CHECK_THROWS_WITH(Connectivity(faces, 8), "faces[3] names vertex 8; the mesh has 8 vertices");
  CHECK_THROWS_WITH(Connectivity(faces_of({{0, 1, 2}, {1, -2, 3}})), Catch::Contains("faces[1] names vertex -2"));
}

TEST_CASE("every edge has one number") {
  const Faces faces = faces_of({{0, 1, 2}, {2, 1, 3}, {1, 2, 4}, {3, 1, 0, 5}});  // three faces at the edge 1 2
  const Connectivity mesh(faces);
  const Edges edges = edges_of(mesh);
  CHECK(edges.vertices ==
        std::vector<std::array<Index, 2>>{{0, 1}, {1, 2}, {0, 2}, {1, 3}, {2, 3}, {2, 4}, {1, 4}, {0, 5}, {3, 5}});
  for (Index f = 0; f < faces.size(); ++f)
    for (Index c = faces.offsets[f]; c < faces.offsets[f + 1]; ++c) {
      const auto corner = static_cast<Connectivity::Corner>(c);
      const Index a = faces.corners[c], b = mesh.next(corner);
      CHECK(edges.vertices[edges.from_corner[c]] == std::array<Index, 2>{std::min(a, b), std::max(a, b)});
    }
  CHECK(edges_of(Connectivity(grid(5, true))).vertices.size() == 2 * 5 * 6 + 25);
}

TEST_CASE("components hang together by edges, not by vertices") {
  const Faces faces = faces_of({{0, 1, 2}, {5, 6, 7}, {2, 3, 4}, {2, 1, 8}, {7, 6, 9, 10}});
  CHECK(components_of(Connectivity(faces)) == Loop{0, 1, 2, 0, 1});
}

TEST_CASE("the mesh around some vertices is as all of it, there") {
  const Index n = 60, middle = 30 * 61 + 30;
  const Faces faces = grid(n, true);
  const Points vertices = places(n);
  const Mesh mesh = {vertices, faces};
  const Connectivity all(mesh, Loop{50}), part = Connectivity::around(mesh, Loop{middle, middle + 1}, 3, Loop{50});
  Index known = 0;
  for (Index v = 0; v < part.vertices(); ++v) {
    const Index rings = std::max(std::abs(v % 61 - 30), std::abs(v / 61 - 30));
    if (rings <= 3) CHECK(part.knows(v));
    known += part.knows(v);
    if (part.knows(v)) CHECK(faces_at(part, v) == faces_at(all, v));
  }
  CHECK(known < 400);
  // long faces reach out of the box around the vertices: then it is the whole mesh
  Points far = vertices;
  for (Index v = 0; v < far.rows(); ++v)
    if (std::abs(v % 61 - 30) > 1 || std::abs(v / 61 - 30) > 1) far.row(v) *= 1000;
  const Connectivity whole = Connectivity::around({far, faces}, Loop{middle, middle + 1}, 3);
  CHECK(whole.knows(0));
  Points broken = vertices;
  broken(middle, 1) = NAN;
  CHECK(Connectivity::around({broken, faces}, Loop{middle}, 3).knows(0));
}

TEST_CASE("border loops do not depend on the order of the faces, and every border edge is in one") {
  std::mt19937 random(7);
  const Faces all = grid(12, true);
  Faces holey;
  for (Index f = 0; f < all.size(); ++f)
    if (random() % 5 != 0) holey.add(all[f]);
  const auto loops = border_loops(Connectivity(holey));
  std::size_t edges = 0, single = 0;
  for (const Loop& loop : loops) {
    edges += loop.size();
    for (std::size_t k = 0; k < loop.size(); ++k)
      CHECK(Connectivity(holey).faces_at_edge(loop[k], loop[(k + 1) % loop.size()]).size() == 1);
  }
  const Connectivity mesh(holey);
  for (const auto& [a, b] : edges_of(mesh).vertices) single += mesh.faces_at_edge(a, b).size() == 1;
  CHECK(edges == single);
  std::vector<Index> order(holey.size());
  std::iota(order.begin(), order.end(), Index{0});
  std::shuffle(order.begin(), order.end(), random);
  Faces shuffled;
  for (Index f : order) shuffled.add(holey[f]);
  CHECK(border_loops(Connectivity(shuffled)) == loops);
}
