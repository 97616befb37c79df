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

}  // namespace

TEST_CASE("a vertex put on an edge says nothing of the surface, as long as it is straight between the edge's ends", "") {
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
