// Many holes on all cores. scripts/sanitize runs what is tagged [parallel] under the thread sanitizer too.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>

#include "tripatch/fill.h"
#include "tripatch/mesh/border_loops.h"
#include "tripatch/mesh/connectivity.h"

using namespace tripatch;

namespace {

/// A wave over n x n quads in two triangles each, with holes of so many quads a side at every eighth quad.
struct Sieve {
  Points points;
  Faces faces;
  std::vector<std::vector<Index>> rims;

  explicit Sieve(Index n, Index hole) : points((n + 1) * (n + 1), 3) {
    for (Index i = 0; i <= n; ++i)
      for (Index j = 0; j <= n; ++j) {
        const double u = 0.1 * static_cast<double>(i), v = 0.1 * static_cast<double>(j);
        points.row(i * (n + 1) + j) << u, v, 0.3 * std::sin(u) * std::cos(1.3 * v);
      }
    for (Index i = 0; i < n; ++i)
      for (Index j = 0; j < n; ++j) {
        if (i % 8 >= 3 && i % 8 < 3 + hole && j % 8 >= 3 && j % 8 < 3 + hole) continue;
        const Index a = i * (n + 1) + j, b = a + n + 1;
        faces.add(std::array<Index, 3>{a, b, b + 1});
        faces.add(std::array<Index, 3>{a, b + 1, a + 1});
      }
    for (std::vector<Index>& loop : border_loops(Connectivity(Mesh{points, faces})))
      if (loop.size() < static_cast<std::size_t>(2 * n)) rims.push_back(std::move(loop));
  }
};

}  // namespace

TEST_CASE("holes filled together on all cores are those filled one by one", "[parallel]") {
  const Sieve sieve(24, 2);
  const Mesh mesh{sieve.points, sieve.faces};
  REQUIRE(sieve.rims.size() == 9);
  for (const std::optional<std::vector<Index>>& corners :
       {std::optional<std::vector<Index>>(), std::optional<std::vector<Index>>(std::vector<Index>{0, 1, 2})}) {
    // as they come, and between three corners: the exact patch, whose sides are estimated at the same time
    std::vector<std::optional<std::vector<Index>>> of_each(sieve.rims.size());
    for (std::size_t k = 0; corners && k < of_each.size(); ++k) {
      of_each[k].emplace();
      for (Index c : *corners) of_each[k]->push_back(sieve.rims[k][3 * static_cast<std::size_t>(c)]);
    }
    std::size_t told = 0;
    const auto together = fill_all(mesh, sieve.rims, {}, of_each, [&](std::size_t done) { told = std::max(told, done); });
    CHECK(told == sieve.rims.size());
    for (std::size_t k = 0; k < sieve.rims.size(); ++k) {
      FillOptions one;
      one.rim = sieve.rims[k];
      one.corners = of_each[k];
      const Fill alone = fill(mesh, one);
      const Fill* const same = std::get_if<Fill>(&together[k]);
      REQUIRE(same);
      CHECK(same->vertices == alone.vertices);
      CHECK(same->faces.corners == alone.faces.corners);
    }
  }
}

TEST_CASE("the sides of a long rim, estimated at the same time, and many triangles are the same every time", "[parallel]") {
  // 30 vertices and more are worth threads, and so are thousands of triangles
  const Index n = 40, low = 12, high = 28;
  Sieve whole(n, 0);
  Faces left;
  for (Index f = 0; f < whole.faces.size(); ++f) {
    const Index quad = f / 2, i = quad / n, j = quad % n;
    if (i >= low && i < high && j >= low && j < high) continue;
    left.add(std::array<Index, 3>{whole.faces[f][0], whole.faces[f][1], whole.faces[f][2]});
  }
  FillOptions options;
  options.method = "side_vertex";
  options.corners = std::vector<Index>{low * (n + 1) + low, high * (n + 1) + low, low * (n + 1) + high};
  const Mesh mesh{whole.points, left};
  for (const std::optional<int> resolution : {std::optional<int>(), std::optional<int>(150)}) {
    options.resolution = resolution;
    const Fill first = fill(mesh, options), second = fill(mesh, options);
    CHECK(first.rim.size() == 64);
    CHECK(first.vertices == second.vertices);
    CHECK(first.normals == second.normals);
    CHECK(first.report.seam_angle_max == second.report.seam_angle_max);
  }
}

TEST_CASE("corners of faces may have 32 bits") {
  const Sieve sieve(16, 3);
  const std::vector<std::int32_t> few(sieve.faces.corners.begin(), sieve.faces.corners.end());
  const FillOptions options;
  const auto wide = fill_all({sieve.points, sieve.faces}, sieve.rims, options);
  const auto narrow = fill_all({sieve.points, {sieve.faces.offsets, few}}, sieve.rims, options);
  REQUIRE(wide.size() == narrow.size());
  for (std::size_t k = 0; k < wide.size(); ++k) {
    CHECK(std::get<Fill>(wide[k]).vertices == std::get<Fill>(narrow[k]).vertices);
    CHECK(std::get<Fill>(wide[k]).faces.corners == std::get<Fill>(narrow[k]).faces.corners);
  }
}

TEST_CASE("a hole that cannot be filled does not stop the others", "[parallel]") {
  Sieve sieve(24, 2);
  sieve.points(sieve.rims[4][0], 1) = NAN;
  const auto results = fill_all(Mesh{sieve.points, sieve.faces}, sieve.rims, {}, {}, {});
  for (std::size_t k = 0; k < results.size(); ++k) CHECK(std::holds_alternative<Refused>(results[k]) == (k == 4));
}

TEST_CASE("what names vertices that are not there is a mistake of the caller, never a refusal that names them") {
  // found by fuzzing: a rim too short, or corners too many, were refused first
  const Points points = (Points(5, 3) << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0.5, 0.5, 1).finished();
  Faces faces;
  for (const auto& f : {std::array<Index, 3>{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}}) faces.add(f);
  const Mesh mesh = {points, faces};
  FillOptions options;
  options.rim = {0, 5};
  CHECK_THROWS_AS(fill(mesh, options), InvalidArgument);
  options.rim = {3, 2, 1, 0};
  options.corners = {0, 1, 2, 7};
  for (const char* method : {"side_vertex", "auto", "gregory"}) {
    options.method = method;
    CHECK_THROWS_WITH(fill(mesh, options), "corners names vertex 7; the mesh has 5 vertices");
    CHECK_THROWS_AS(fill_all(mesh, {*options.rim}, {}, {options.corners}), InvalidArgument);
  }
  options.corners.reset();
  options.islands = {{1, 2, -1}};
  CHECK_THROWS_AS(fill(mesh, options), InvalidArgument);
}
