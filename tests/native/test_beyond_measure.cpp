// Coordinates so large that what is computed of them overflows: a fill is finite, or refused in a sentence about them.
#include <catch2/catch.hpp>
#include <cmath>

#include "tripatch/fill.h"

using namespace tripatch;

namespace {

using Loop = std::vector<Index>;

/// A wave over 8 x 8 quads, cut in two triangles each where asked for, in the middle of which 2 x 2 are missing.
struct Wave {
  Points points = Points(81, 3);
  Faces faces;
  Loop rim = {30, 31, 32, 41, 50, 49, 48, 39};

  explicit Wave(bool cut) {
    for (Index i = 0; i < 9; ++i)
      for (Index j = 0; j < 9; ++j) {
        const double u = 0.1 * static_cast<double>(i), v = 0.1 * static_cast<double>(j);
        points.row(9 * i + j) << u, v, 0.3 * std::sin(u) * std::cos(1.3 * v);
      }
    for (Index i = 0; i < 8; ++i)
      for (Index j = 0; j < 8; ++j) {
        if ((i == 3 || i == 4) && (j == 3 || j == 4)) continue;
        const Index a = 9 * i + j, b = a + 9;
        if (cut) {
          faces.add(std::array<Index, 3>{a, b, b + 1});
          faces.add(std::array<Index, 3>{a, b + 1, a + 1});
        } else {
          faces.add(std::array<Index, 4>{a, b, b + 1, a + 1});
        }
      }
  }
};

/// Of all ways to fill it.
void check_all(const Mesh& mesh, const Loop& rim) {
  for (const Output output : {Output::triangles, Output::quads, Output::cage})
    for (const SurroundingsFrom from : {SurroundingsFrom::mesh, SurroundingsFrom::limit})
      for (const std::optional<Loop>& corners : {std::optional<Loop>(), std::optional<Loop>({rim[0], rim[2], rim[4]}),
                                                 std::optional<Loop>({rim[0], rim[2], rim[4], rim[6]})})
        for (const char* method : {automatic_method, spline_method}) {
          if (method == spline_method && (output == Output::cage || from == SurroundingsFrom::limit || corners)) continue;
          if (corners && corners->size() > 3 && from == SurroundingsFrom::limit) continue;
          FillOptions options;
          options.rim = rim;
          options.corners = corners;
          options.output = output;
          options.surroundings = from;
          options.method = method;
          const auto results = fill_all(mesh, {rim}, options, {corners});
          if (const Fill* fill = std::get_if<Fill>(&results[0])) {
            CHECK(is_finite(*fill));
          } else {
            INFO(std::get<Refused>(results[0]).reason);
            CHECK(std::get<Refused>(results[0]).reason.size() > 20);
          }
          try {
            const Fill alone = fill(mesh, options);
            CHECK(is_finite(alone));
          } catch (const Refusal&) {
          }
        }
}

}  // namespace

TEST_CASE("beside a vertex beyond all measure fills are finite, or refused") {
  for (const bool cut : {false, true})
    for (const double far : {1e60, 1e100, 1e150, -1e200, 1e300, -1e308})
      for (const Index v : {30, 31, 21, 22, 13, 3}) {  // of the rim, one ring away, two, and three
        CAPTURE(cut, far, v);
        Wave wave(cut);
        wave.points(v, 2) = far;
        check_all({wave.points, wave.faces}, wave.rim);
      }
}

TEST_CASE("a fill without finite normals is refused") {
  Wave wave(false);
  wave.points.row(31) << 3.5e300, -3e226, -15;
  FillOptions options;
  options.rim = wave.rim;
  options.method = spline_method;
  CHECK_THROWS_AS(fill({wave.points, wave.faces}, options), Refusal);
}

TEST_CASE("what a cage is refused for names vertices of the mesh only") {
  // faces that pass a vertex twice cannot be subdivided, with the fill, whose vertices inside have numbers that nobody knows
  Points points(11, 3);
  points << 2.19, 0.19, -0.72, 3.55, -3.31, 5.25, 2.56, 7.62, 4.31, 3.69, 2.31, -3.91, 2.5, -6.94, -2.5, 2.33, 4.37, -6.5, 4.88,
      -7.31, -6.19, -7.19, -5.88, -1, 5.64, 6.31, 6.69, 3.06, -2.88, 4.21, -3.9e15, 9.1e196, -0.75;
  Faces faces;
  for (const Loop& face : {Loop{7, 4, 3, 9, 1, 3}, Loop{10, 1, 9}, Loop{6, 8, 3, 4}, Loop{1, 5, 5}}) faces.add(face);
  FillOptions options;
  options.output = Output::cage;
  options.cage_rim = CageRim::move;
  const auto results = fill_all({points, faces}, {{3, 8, 6, 4, 7}}, options);
  const Refused* refused = std::get_if<Refused>(&results[0]);
  REQUIRE(refused);
  CHECK(refused->reason.find("cannot be subdivided") != std::string::npos);
  for (Index v : refused->where) CHECK(v < points.rows());
}

TEST_CASE("a cage in a mesh whose squares of lengths are none is refused as too small") {
  Wave wave(false);
  wave.points *= 1e-244;
  FillOptions options;
  options.output = Output::cage;
  options.rim = wave.rim;
  for (const bool corners : {false, true}) {
    if (corners) options.corners = {30, 32, 50, 48};
    try {
      const Fill made = fill({wave.points, wave.faces}, options);
      CHECK(is_finite(made));
    } catch (const Refusal& refusal) {
      CHECK(std::string(refusal.what()).find("Vertex 8") == std::string::npos);
      for (Index v : refusal.where()) CHECK(v < wave.points.rows());
    }
  }
}
