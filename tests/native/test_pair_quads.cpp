#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "tripatch/mesh/triangles.h"
#include "tripatch/output/pair_quads.h"

using namespace tripatch;

namespace {

Points square_grid(int n) {
  Points x((n + 1) * (n + 1), 3);
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j) x.row(i * (n + 1) + j) << i, j, 0;
  return x;
}

Triangles halves(int n) {
  Triangles t;
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j) {
      const Index a = i * (n + 1) + j, b = a + n + 1;
      t.push_back({a, b, b + 1});
      t.push_back({a, b + 1, a + 1});
    }
  return t;
}

/// The border of the faces must be that of the triangles, with its direction, and nothing may be covered twice.
bool same_border(const Triangles& triangles, const Faces& faces) {
  std::map<std::pair<Index, Index>, int> before, after;
  for (const auto& t : triangles)
    for (int k = 0; k < 3; ++k) ++before[{t[k], t[(k + 1) % 3]}];
  for (Index f = 0; f < faces.size(); ++f)
    for (std::size_t k = 0; k < faces[f].size(); ++k) ++after[{faces[f][k], faces[f][(k + 1) % faces[f].size()]}];
  for (const auto& [edge, count] : before)
    if (!before.count({edge.second, edge.first}) && after[edge] != count) return false;
  for (const auto& [edge, count] : after)
    if (count > 1) return false;
  return true;
}

Index quads(const Faces& faces) {
  Index n = 0;
  for (Index f = 0; f < faces.size(); ++f) n += faces[f].size() == 4;
  return n;
}

}  // namespace

TEST_CASE("a halved grid of squares becomes that grid") {
  const Triangles t = halves(6);
  const Points x = square_grid(6);
  const Faces faces = pair_quads(x, t);
  CHECK(faces.size() == 36);
  CHECK(quads(faces) == 36);
  CHECK(same_border(t, faces));
  for (Index f = 0; f < faces.size(); ++f)
    for (int k = 0; k < 4; ++k) CHECK((x.row(faces[f][k]) - x.row(faces[f][(k + 1) % 4])).norm() == Approx(1));
}

TEST_CASE("quads stay within the thresholds, on both sides of them") {
  const auto quad = [](double corner, double fold) {  // a rhombus with that corner, folded over its diagonal 1-3 by that angle
    Points x(4, 3);
    const double a = corner * std::numbers::pi / 360, f = fold * std::numbers::pi / 180;
    x << std::cos(a), 0, 0, 0, std::sin(a), 0, -std::cos(a) * std::cos(f), 0, -std::cos(a) * std::sin(f), 0, -std::sin(a), 0;
    return x;
  };
  const Triangles t = {{0, 1, 3}, {2, 3, 1}};
  CHECK(quads(pair_quads(quad(90, 0), t)) == 1);
  CHECK(quads(pair_quads(quad(51, 0), t)) == 1);
  CHECK(quads(pair_quads(quad(49, 0), t)) == 0);
  CHECK(quads(pair_quads(quad(129, 0), t)) == 1);
  CHECK(quads(pair_quads(quad(131, 0), t)) == 0);
  CHECK(quads(pair_quads(quad(90, 39), t)) == 1);
  CHECK(quads(pair_quads(quad(90, 41), t)) == 0);
  CHECK(quads(pair_quads(quad(90, 41), t, {50, 40})) == 1);
  CHECK(quads(pair_quads(quad(90, 0), t, {}, {{3, 1}})) == 0);
  CHECK(pair_quads(quad(90, 41), t).corners == std::vector<Index>{0, 1, 3, 2, 3, 1});
  Points flat = quad(90, 0);
  flat.row(0) = (flat.row(1) + flat.row(3)) / 2;  // a triangle without area
  CHECK(quads(pair_quads(flat, t)) == 0);
}

TEST_CASE("triangles left over change partners where that makes a pair more") {
  Points x(6, 3);  // a strip of four triangles; the middle pair is a square, the outer two pairs are a little oblique
  x << -0.9, 1, 0, 0, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0, 1.9, 0, 0;
  const Triangles t = {{0, 1, 2}, {1, 3, 2}, {2, 3, 4}, {3, 5, 4}};
  const Faces faces = pair_quads(x, t, {40, 50});
  CHECK(faces.size() == 2);
  CHECK(quads(faces) == 2);
  CHECK(same_border(t, faces));
  CHECK(quads(pair_quads(x, t, {40, 30})) == 1);  // only the square is good enough
}

TEST_CASE("pairs of any triangulation cover what it covers") {
  std::mt19937 random(8);
  Points x = square_grid(15);
  for (Index k = 0; k < x.rows(); ++k)
    for (int c = 0; c < 3; ++c) x(k, c) += 0.5 * static_cast<double>(random() % 1000) / 1000;
  const Triangles t = halves(15);
  const Faces faces = pair_quads(x, t);
  CHECK(same_border(t, faces));
  CHECK(2 * quads(faces) + (faces.size() - quads(faces)) == static_cast<Index>(t.size()));
  CHECK(quads(faces) > 100);
  CHECK(quads(faces) < 225);
  CHECK(pair_quads(x, t).corners == faces.corners);
  CHECK(pair_quads(x, {}).size() == 0);
  CHECK_THROWS_AS(pair_quads(x, {{0, 1, 1000}}), InvalidArgument);
}

TEST_CASE("a quad begins where its triangles met, so that cut into a fan it is those triangles") {
  Points x(4, 3);
  x << 0, 0, 0, 1, 0, 0.1, 1, 1, 0, 0, 1, 0.1;
  const std::array<Index, 3> one = {0, 1, 2}, other = {0, 2, 3};
  const Faces faces = pair_quads(x, {one, other});
  REQUIRE(faces.size() == 1);
  CHECK((faces[0][0] == 0 || faces[0][0] == 2));
  CHECK((faces[0][2] == 0 || faces[0][2] == 2));
}

TEST_CASE("any number of pairs changes, and corners that will move may be flat where corners of the border may not") {
  Points x(
      10,
      3);  // a strip of eight triangles: pairs of all but the first and the last are squares, others have corners of 45 degrees
  Triangles t;
  for (Index k = 0; k < 5; ++k) {
    x.row(2 * k) << static_cast<double>(k), 0, 0;
    x.row(2 * k + 1) << static_cast<double>(k + 1), 1, 0;
  }
  for (Index k = 0; k < 8; k += 2) {
    t.push_back({k, k + 2, k + 1});
    t.push_back({k + 2, k + 3, k + 1});
  }
  CHECK(quads(pair_quads(x, t)) == 3);
  CHECK(quads(pair_quads(x, t, {40, 50})) == 4);
  Points flat(4, 3);  // a corner of 160 degrees between two edges of the border
  flat << 0, 0, 0, 1, 0, 0, 0.5, 1, 0, 0.5, -0.09, 0;
  CHECK(quads(pair_quads(flat, {{0, 1, 2}, {0, 3, 1}}, {40, 75, 90})) == 1);
  CHECK(quads(pair_quads(flat, {{0, 1, 2}, {0, 3, 1}}, {40, 65, 90})) == 0);
}
