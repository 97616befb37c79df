// Coordinates so large that what is computed of them overflows: a fill is finite, or refused in a sentence about them.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "test_refusals.h"
#include "tripatch/fill.h"
#include "tripatch/output/doubled_edges.h"

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
          options.output = output;
          options.surroundings = from;
          options.method = method;
          const auto results = fill_all(mesh, {rim}, options, {corners});
          if (const Fill* fill = std::get_if<Fill>(&results[0])) {
            CHECK(is_finite(*fill));
          } else {
            INFO(std::get<Refused>(results[0]).text());
            CHECK(std::get<Refused>(results[0]).text().size() > 20);
          }
          options.rim = rim;
          options.corners = corners;
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

TEST_CASE("a rim that is closed with plain triangles gets the same in a mirror") {
  for (const double turned : {1.0, -1.0}) {
    Wave wave(false);
    wave.points.col(0) *= turned;
    wave.points(wave.rim[0], 2) = 1e16;
    Faces faces;
    for (Index f = 0; f < wave.faces.size(); ++f) {
      Loop face(wave.faces[f].begin(), wave.faces[f].end());
      if (turned < 0) std::reverse(face.begin(), face.end());
      faces.add(face);
    }
    FillOptions options;
    options.rim = wave.rim;
    const Fill filled = fill({wave.points, faces}, options);
    CHECK(filled.vertices.rows() == 0);
    CHECK(filled.faces.size() == static_cast<Index>(wave.rim.size()) - 2);
    CHECK(filled.report.warnings.back().code == Code::tiny_edges_plain_triangles);
  }
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
  CHECK(refused->message.code == Code::face_passes_twice);
  CHECK(refused->message.where == std::vector<Index>{3});
  for (Index v : refused->message.where) CHECK(v < points.rows());
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
    } catch (const CodedRefusal& refusal) {
      CHECK(std::string(refusal.what()).find("Vertex 8") == std::string::npos);
      for (Index v : refusal.where()) CHECK(v < wave.points.rows());
    }
  }
}

TEST_CASE("a cage that would join vertices of the rim where the mesh does is refused") {
  // among others around three triangles in a row: an edge of the mesh is a diagonal of its rim
  Points points(21, 3);
  points << 0, 0, 0, 0, 0.5, -0.25, 0, 1, -1, 0.166666667, 0, 0.0277777778, 0.166666667, 0.5, -0.222222222, 0.166666667, 1,
      -0.972222222, 8.83333333, -10.5625, -3.01388889, 0.333333333, 0.5, -0.138888889, 7.45833333, 6.2043457, -5.20138889,
      -4.5625, -6.5, -5.50927734, 0.5, 0.5, 0, -4, -0.5625, 5.75, 0.666666667, 0, 0.444444444, 0.666666667, 0.5, 0.194444444,
      0.666666667, 1, -0.555555556, 0.833333333, 0, 0.694444444, 0.833333333, 0.5, 0.444444444, 0.833333333, 1, -0.305555556,
      -6.1875, -1.14892578, 1.8125, 1, 0.5, 0.75, 1, 1, 0;
  Faces faces;
  for (const Loop& face : {Loop{1, 4, 5}, Loop{3, 6, 7}, Loop{6, 10, 7}, Loop{9, 12, 13}, Loop{9, 13, 10}, Loop{12, 16, 13},
                           Loop{15, 18, 19}, Loop{16, 19, 20}, Loop{16, 20, 17}})
    faces.add(face);
  FillOptions options;
  options.output = Output::cage;
  const std::vector<Loop> rims = {{1, 5, 4}, {15, 19, 18}, {3, 7, 10, 6}, {16, 17, 20, 19}, {9, 10, 13, 16, 12}};
  const auto results = fill_all({points, faces}, rims, options);
  for (std::size_t k = 0; k < rims.size(); ++k)
    if (const Fill* fill = std::get_if<Fill>(&results[k]))
      CHECK_FALSE(doubles_edges_of_mesh(Connectivity(Mesh{points, faces}), rims[k], fill->faces));
}

TEST_CASE("surroundings beyond all measure are no mistake of the caller where a second model of them is made") {
  // a ring of triangles and quads around an edge, one vertex of which lies at 7e148
  Points points(39, 3);
  points << 1.4, 0, 0, 0.8, 0, 0.346410162, 0.8, 0, -0.346410162, 1.23963844, 0.650612441, 0, 0.708364821, 0.371778538,
      0.346410162, 1e+09, 0.0592785376, -1.03391016, 1e+150, -3.20841829, -3.3125, 0.454451797, 0.658387093, 0.346410162,
      0.454451797, 0.658387093, -0.346410162, 0.168751352, 1.38979242, 0, 0.0964293442, 0.794167099, 0.346410162, 0.0964293442,
      0.794167099, -0.346410162, -0.496446842, 1.30902274, 0, -0.28368391, 0.748012994, 0.346410162, -0.28368391, 0.748012994,
      -0.346410162, -1.04791505, 0.928371722, 0, 6.0261914, -1.34450187, 5.22141016, -3.0363086, 5.65549813, -2.03708399,
      3.66607208, -3.35245807, 3.875, -0.776753454, 0.191452531, 0.346410162, -0.776753454, 0.191452531, -0.346410162,
      -1.35931854, -0.33504193, 0, -0.776753454, -0.191452531, 0.346410162, -1.27675345, 1.99604747, -5.59641016, -1.04791505,
      -0.928371722, 0, -0.598808599, -0.530498127, 0.346410162, -0.598808599, -0.530498127, -0.346410162, -0.496446842,
      -1.30902274, 0, -0.28368391, -0.748012994, 0.346410162, -0.28368391, -0.748012994, -0.346410162, 0.168751352, -1.38979242,
      0, 0.0964293442, -0.794167099, 0.346410162, 0.0964293442, -0.794167099, -0.346410162, 0.795290645, -1.15217741, 0,
      0.454451797, -0.658387093, 0.346410162, -2.9830482, 4.59161291, -2.34641016, 1.05213844, 7.51695326e+148, -5.56274414,
      0.708364821, -0.371778538, 0.346410162, 0.940298414, -3.18427854, -7.90158594;
  Faces faces;
  for (const Loop& face :
       {Loop{0, 3, 4, 1},     Loop{2, 5, 3, 0},     Loop{3, 6, 7, 4},     Loop{4, 7, 8, 5},     Loop{5, 8, 6, 3},
        Loop{6, 9, 10, 7},    Loop{9, 12, 13, 10},  Loop{12, 15, 16, 13}, Loop{15, 18, 19, 16}, Loop{18, 21, 22, 19},
        Loop{21, 24, 25, 22}, Loop{24, 27, 28, 25}, Loop{25, 28, 29, 26}, Loop{26, 29, 27, 24}, Loop{27, 30, 31, 28},
        Loop{28, 31, 32, 29}, Loop{29, 32, 30, 27}, Loop{30, 33, 34, 31}, Loop{31, 34, 35, 32}, Loop{32, 35, 33, 30},
        Loop{33, 36, 37, 34}, Loop{34, 37, 38, 35}, Loop{35, 38, 36, 33}, Loop{36, 0, 1, 37},   Loop{37, 1, 2, 38},
        Loop{38, 2, 0, 36}})
    faces.add(face);
  FillOptions options;
  options.output = Output::quads;
  const auto results = fill_all({points, faces}, {{6, 8, 7, 10, 13, 16, 19, 22, 25, 26, 24, 21, 18, 15, 12, 9}}, options);
  if (const Fill* fill = std::get_if<Fill>(&results[0])) CHECK(is_finite(*fill));
}
