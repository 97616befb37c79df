#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "tripatch/estimate/local_mesh.h"

using namespace tripatch;

namespace {

constexpr Index columns = 16;

Index at(Index i, Index k) { return i * (columns + 1) + k; }

struct Sheet {
  Points vertices;
  Faces faces;
  Hole hole;
  LocalMesh local() const { return local_mesh({vertices, faces}, Connectivity(faces, vertices.rows()), hole); }
};

/// A sheet of squares that is bent at some columns by degrees, with a hole of its middle row or rows and two columns.
Sheet sheet(Index rows, const std::vector<std::pair<Index, double>>& bends) {
  Sheet s;
  s.vertices.resize((rows + 1) * (columns + 1), 3);
  double x = 0, z = 0, angle = 0;
  for (Index k = 0; k <= columns; ++k) {
    for (Index i = 0; i <= rows; ++i) s.vertices.row(at(i, k)) << x, static_cast<double>(i), z;
    for (const auto& [column, degrees] : bends)
      if (column == k) angle += degrees * std::numbers::pi / 180;
    x += std::cos(angle);
    z += std::sin(angle);
  }
  const Index low = (rows - 1) / 2, high = rows / 2 + 1;
  for (Index i = 0; i < rows; ++i)
    for (Index k = 0; k < columns; ++k)
      if (i < low || i >= high || k < 7 || k > 8)
        s.faces.add(std::vector<Index>{at(i, k), at(i, k + 1), at(i + 1, k + 1), at(i + 1, k)});
  s.hole.rim = {at(low, 7), at(low, 8)};
  for (Index i = low; i < high; ++i) s.hole.rim.push_back(at(i, 9));
  s.hole.rim.push_back(at(high, 9));
  s.hole.rim.push_back(at(high, 8));
  for (Index i = high; i > low; --i) s.hole.rim.push_back(at(i, 7));
  s.hole.corners = {0, 2, 4};
  return s;
}

/// Whether the edge from row i to the next in column k is sharp: the local mesh knows no face beyond it.
bool is_sharp(const LocalMesh& w, Index i, Index k) {
  const int a = w.part.vertex.find(at(i, k)), b = w.part.vertex.find(at(i + 1, k));
  for (int f : w.part.faces_at(a))
    for (int c = w.part.offsets[f]; c < w.part.offsets[f + 1]; ++c) {
      const int next = w.part.corners[c + 1 < w.part.offsets[f + 1] ? c + 1 : w.part.offsets[f]];
      if (w.part.corners[c] == a && next == b) return w.across[c] < 0;
    }
  FAIL("no such edge");
  return false;
}

}  // namespace

TEST_CASE("an edge is sharp that bends by more than 8 degrees, in a plane sheet", "[thresholds]") {
  CHECK(!is_sharp(sheet(3, {{5, 7.9}}).local(), 1, 5));
  CHECK(is_sharp(sheet(3, {{5, 8.1}}).local(), 1, 5));
  CHECK(!is_sharp(sheet(3, {{5, 8.1}}).local(), 1, 4));
}

TEST_CASE("an edge is sharp that bends by 8 degrees and twice as much as those near it that run its way", "[thresholds]") {
  CHECK(is_sharp(sheet(3, {{4, 5.9}, {5, 20}, {6, 5.9}}).local(), 1, 5));
  CHECK(!is_sharp(sheet(3, {{4, 6.1}, {5, 20}, {6, 6.1}}).local(), 1, 5));
  // a cylinder bends everywhere
  std::vector<std::pair<Index, double>> all;
  for (Index k = 1; k < columns; ++k) all.emplace_back(k, 20);
  CHECK(!is_sharp(sheet(3, all).local(), 1, 5));
}

TEST_CASE("a vertex put on an edge says nothing of the surface, as long as it is straight between the edge's ends",
          "[thresholds]") {
  // the edge from (4, 5) to (4, 6) carries one more
  for (const double off : {0.8e-4, 1.2e-4}) {
    Sheet s = sheet(16, {});
    const Index added = s.vertices.rows();
    Faces faces;
    for (Index f = 0; f < s.faces.size(); ++f) {
      std::vector<Index> face(s.faces[f].begin(), s.faces[f].end());
      for (std::size_t k = 0; k < face.size(); ++k) {
        const Index a = face[k], b = face[(k + 1) % face.size()];
        if (std::minmax(a, b) == std::minmax(at(4, 5), at(4, 6))) {
          face.insert(face.begin() + static_cast<Index>(k) + 1, added);
          break;
        }
      }
      faces.add(face);
    }
    s.faces = faces;
    s.vertices.conservativeResize(added + 1, 3);
    // the sine of the angle between the two halves of the edge is four times the height over its length
    s.vertices.row(added) = 0.5 * (s.vertices.row(at(4, 5)) + s.vertices.row(at(4, 6))) + Eigen::RowVector3d(0, 0, off / 4);
    const LocalMesh w = s.local();
    CHECK((w.on_chord[w.part.vertex.find(added)] != 0) == (off < 1e-4));
    CHECK(w.on_chord[w.part.vertex.find(at(4, 4))] == 0);
  }
}

TEST_CASE("edges run the same way within 45 degrees", "[thresholds]") {
  // faces bent by 20 degrees along a column and by 7 along rows that cross it at such an angle: 8 and twice 7 are more than 20
  for (const double cosine : {0.69, 0.71}) {
    const double sine = std::sqrt(1 - cosine * cosine), bend = 7 * std::numbers::pi / 180;
    Sheet s = sheet(3, {{5, std::atan(sine * std::tan(20 * std::numbers::pi / 180)) * 180 / std::numbers::pi}});
    Vec3 way = Vec3::Zero();
    for (Index i = 0; i <= 3; ++i) {
      for (Index k = 0; k <= columns; ++k)
        s.vertices.row(at(i, k)) += way.transpose() - Eigen::RowVector3d(0, static_cast<double>(i), 0);
      way += i == 0 ? Vec3(cosine, sine, 0) : Vec3(cosine, sine * std::cos(bend), sine * std::sin(bend));
    }
    CHECK(is_sharp(s.local(), 1, 5) == (cosine < 0.7));
  }
}

TEST_CASE(
    "a rim edge has a length from a million-millionth of the rim's extent on, a face an area from that part of its square on",
    "[thresholds]") {
  for (const double part : {0.9e-12, 1.1e-12}) {
    Sheet s = sheet(3, {});  // a hole of two squares
    s.vertices(at(1, 8), 0) = 7 + part * std::sqrt(5.0);
    if (part < 1e-12) {
      CHECK_THROWS_WITH(s.local(), Catch::Contains("has no length"));
    } else {
      CHECK_NOTHROW(s.local());
    }
    s = sheet(3, {});
    for (const Index k : {3, 4}) s.vertices(at(3, k), 1) = 2 + part / 2;
    const LocalMesh w = s.local();
    int none = 0;
    for (const double area : w.twice_area) none += area == 0;
    CHECK(none == (part < 1e-12 ? 1 : 0));
  }
}

TEST_CASE("a local mesh is as large as the rings around its hole, not as the mesh") {
  const LocalMesh w = sheet(16, {}).local();
  // seven rings around a hole of 2 x 2 cells
  CHECK(w.part.face.size() == 16 * 16 - 4);
  Sheet large = sheet(16, {});
  const Index n = large.vertices.rows();
  large.vertices.conservativeResize(3 * n, 3);
  large.vertices.bottomRows(2 * n).setRandom();
  const Index m = large.faces.size();
  for (Index f = 0; f < m; ++f) {
    std::vector<Index> face(large.faces[f].begin(), large.faces[f].end());
    for (Index& v : face) v += n;
    large.faces.add(face);
  }
  CHECK(large.local().part.face == w.part.face);
}
