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
