// A mesh with fills of it, and arguments that a caller gets wrong.
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>

#include "tripatch/fill.h"
#include "tripatch/mesh/border_loops.h"
#include "tripatch/mesh/connectivity.h"

using namespace tripatch;

namespace {

/// A band of a sphere, of rows of n quads each: its two borders are round.
OwnMesh band(Index n, Index rows) {
  OwnMesh made;
  made.vertices.resize(n * (rows + 1), 3);
  for (Index r = 0; r <= rows; ++r)
    for (Index k = 0; k < n; ++k) {
      const double t = 0.4 + 2.0 * static_cast<double>(r) / static_cast<double>(rows);
      const double a = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n);
      made.vertices.row(r * n + k) << std::sin(t) * std::cos(a), std::sin(t) * std::sin(a), std::cos(t);
    }
  for (Index r = 0; r < rows; ++r)
    for (Index k = 0; k < n; ++k) {
      const Index a = r * n + k, b = r * n + (k + 1) % n;
      made.faces.add(std::array<Index, 4>{a, a + n, b + n, b});
    }
  return made;
}

/// Whether every edge is run through once in each direction.
bool is_closed(const FacesRef& faces) {
  std::map<std::array<Index, 2>, int> runs;
  for (Index f = 0; f < faces.size(); ++f)
    for (std::size_t k = 0; k < faces[f].size(); ++k) ++runs[{faces[f][k], faces[f][(k + 1) % faces[f].size()]}];
  return std::ranges::all_of(runs, [&](const auto& run) {
    const auto back = runs.find({run.first[1], run.first[0]});
    return run.second == 1 && back != runs.end();
  });
}

std::string code_of_argument(const std::function<void()>& act) {
  try {
    act();
  } catch (const CodedArgument& wrong) {
    return about(wrong.message().code).code;
  }
  return "";
}

}  // namespace

TEST_CASE("a mesh with fills of all its holes is closed, its split edges too", "[with_fills]") {
  const OwnMesh mesh = band(15, 8);
  FillOptions options;
  options.output = GENERATE(Output::triangles, Output::quads);
  const auto results = fill_all(mesh, border_loops(Connectivity(mesh)), options);
  REQUIRE(results.size() == 2);
  const Fill& one = std::get<Fill>(results[0]);
  CHECK(one.split_edges.empty() == (options.output == Output::triangles));
  const OwnMesh whole = with_fills(mesh, results);
  CHECK(is_closed(whole.faces));
  CHECK((whole.vertices.topRows(mesh.vertices.rows()) == mesh.vertices));
  CHECK(whole.vertices.rowwise().norm().minCoeff() > 0.99);
  CHECK_FALSE(is_closed(with_fill(mesh, one).faces));
}

TEST_CASE("a hole that comes with replaced faces is found without its boundary being named", "[with_fills]") {
  const OwnMesh open = band(12, 8);
  const OwnMesh mesh = with_fills(open, fill_all(open, border_loops(Connectivity(open))));
  FillOptions options;
  options.replaced = {50, 51};
  const Fill made = fill(mesh, options);
  CHECK(made.rim.size() == 6);
  CHECK(is_closed(with_fill(mesh, made, options.replaced).faces));
}

TEST_CASE("a fill that passes through the mesh is not what was asked for", "[with_fills]") {
  OwnMesh mesh = band(16, 8);
  const std::vector<Index> rim = border_loops(Connectivity(mesh))[0];
  FillOptions options;
  options.rim = rim;
  CHECK_FALSE(is_flawed(fill(mesh, options)));
  const double top = mesh.vertices(rim[0], 2) > 0 ? 1 : -1;
  const Index n = mesh.vertices.rows();
  mesh.vertices.conservativeResize(n + 3, 3);
  mesh.vertices.bottomRows(3) << 0.05, 0, 0.7 * top, -0.05, 0.02, 0.7 * top, 0, 0, 1.4 * top;
  mesh.faces.add(std::array<Index, 3>{n, n + 1, n + 2});
  options.continuity = BySide<SideContinuity>(SideContinuity::g1);
  CHECK(is_flawed(fill(mesh, options)));
}

TEST_CASE("arguments that a caller gets wrong have a code, and nothing is read beyond an array", "[with_fills]") {
  const OwnMesh good = band(12, 4);
  for (const auto& spoil : std::vector<std::function<void(std::vector<Index>&)>>{
           [](std::vector<Index>& offsets) { offsets.back() += 10; },
           [](std::vector<Index>& offsets) { offsets[3] = offsets[5] + 1; }, [](std::vector<Index>& offsets) { offsets[0] = -4; },
           [](std::vector<Index>& offsets) { offsets.clear(); }}) {
    OwnMesh bad = good;
    spoil(bad.faces.offsets);
    CHECK(code_of_argument([&] { fill(bad); }) == "offsets_not_in_order");
    CHECK(code_of_argument([&] { fill_all(bad, {{0, 1, 2}}); }) == "offsets_not_in_order");
    CHECK(code_of_argument([&] { choose_holes(bad); }) == "offsets_not_in_order");
  }
  CHECK(code_of_argument([&] { choose_holes(good, {.max_edges = -1}); }) == "out_of_range");
  const std::vector<std::vector<Index>> rims = border_loops(Connectivity(good));
  FillOptions options;
  options.rim = rims[0];
  CHECK(code_of_argument([&] { fill_all(good, rims, options); }) == "option_of_one_hole");
  CHECK(code_of_argument([&] { fill_all(good, {rims[0]}, {}, {{}, {}}); }) == "wrong_shape");
}

TEST_CASE("sides that lack a field are refused", "[with_fills]") {
  CHECK(code_of_argument([] { patch_from_sides({}, {}); }) == "wrong_shape");
  const std::array<Vec3, 3> corners = {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
  Sides sides;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 &a = corners[(i + 1) % 3], &b = corners[(i + 2) % 3];
    sides[i].c = PiecewisePolynomial::bezier(std::array{a[0], a[1], a[2], b[0], b[1], b[2]}, 3);
  }
  FillOptions options;
  try {
    patch_from_sides(sides, options);
    FAIL("made without planes");
  } catch (const CodedRefusal& refusal) {
    CHECK(refusal.message().code == Code::side_without_planes);
  }
  options.continuity = BySide<SideContinuity>(SideContinuity::g0);
  CHECK(patch_from_sides(sides, options).patch);
  sides[1].r = PiecewisePolynomial::linear(1, 1);
  CHECK(code_of_argument([&] { patch_from_sides(sides, options); }) == "wrong_shape");
}
