#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "bytes.h"

namespace tripatch::fuzz {
namespace {

OwnMesh wild(Bytes& bytes) {
  OwnMesh mesh;
  mesh.vertices.resize(bytes.byte() % 24, 3);
  for (Index v = 0; v < mesh.vertices.rows(); ++v) mesh.vertices.row(v) = bytes.point();
  const int count = bytes.byte() % 40;
  for (int f = 0; f < count; ++f) {
    // now and then a vertex that is not there: negative, or beyond the last
    std::vector<Index> face(bytes.seldom(20) ? 3 + bytes.byte() % 20 : 3 + bytes.byte() % 2);
    for (Index& v : face) v = bytes.seldom(250) ? bytes.whole(-2, 30) : bytes.byte() % std::max<Index>(1, mesh.vertices.rows());
    mesh.faces.add(face);
  }
  return mesh;
}

OwnMesh shape(Bytes& bytes) {
  const int kind = bytes.byte() % 5, n = 1 + bytes.byte() % 9, m = 1 + bytes.byte() % 9;
  if (kind < 2) return grid(n, m, kind == 1, false);
  if (kind < 4) return grid(n + 2, m + 2, kind == 3, true);
  return ball(n % 3 + 1);
}

/// A grid of quads in place of which a block is missing, as rows of quads need it; on a torus rows may come back to where they began.
OwnMesh around_block(Bytes& bytes) {
  const int n = bytes.whole(3, 14), m = bytes.whole(3, 14);
  OwnMesh mesh = grid(n, m, false, bytes.flag());
  const int low = bytes.byte() % n, left = bytes.byte() % m, high = low + 1 + bytes.byte() % 6,
            right = left + 1 + bytes.byte() % 6;
  Faces faces;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j)
      if (i < low || i >= high || j < left || j >= right) faces.add(mesh.faces[Index(i) * m + j]);
  mesh.faces = faces;
  return mesh;
}

}  // namespace

OwnMesh grid(int n, int m, bool cut, bool closed) {
  OwnMesh mesh;
  const int rows = closed ? n : n + 1, columns = closed ? m : m + 1;
  mesh.vertices.resize(Index(rows) * columns, 3);
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) {
      const double u = double(i) / n, v = double(j) / m, turn = 2 * std::numbers::pi;
      const double away = 1 + 0.4 * std::cos(turn * v);
      mesh.vertices.row(Index(i) * columns + j) =
          closed ? Vec3(away * std::cos(turn * u), away * std::sin(turn * u), 0.4 * std::sin(turn * v))
                 : Vec3(u, v, u * u - v * v);
    }
  const auto at = [&](int i, int j) { return Index(i % rows) * columns + j % columns; };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j) {
      const std::array<Index, 4> q = {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)};
      if (!cut) {
        mesh.faces.add(q);
      } else {
        mesh.faces.add(std::array{q[0], q[1], q[2]});
        mesh.faces.add(std::array{q[0], q[2], q[3]});
      }
    }
  return mesh;
}

OwnMesh ball(int times) {
  std::vector<Vec3> points = {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(-1, 0, 0), Vec3(0, -1, 0), Vec3(0, 0, -1)};
  std::vector<std::array<Index, 3>> triangles = {{0, 1, 2}, {1, 3, 2}, {3, 4, 2}, {4, 0, 2},
                                                 {1, 0, 5}, {3, 1, 5}, {4, 3, 5}, {0, 4, 5}};
  for (int k = 0; k < times; ++k) {
    std::map<std::pair<Index, Index>, Index> middle;
    const auto between = [&](Index a, Index b) {
      const auto [found, fresh] = middle.try_emplace(std::minmax(a, b), static_cast<Index>(points.size()));
      if (fresh) points.push_back((points[a] + points[b]).normalized());
      return found->second;
    };
    std::vector<std::array<Index, 3>> finer;
    for (const auto& [a, b, c] : triangles) {
      const Index ab = between(a, b), bc = between(b, c), ca = between(c, a);
      for (const auto& t : {std::array{a, ab, ca}, std::array{ab, b, bc}, std::array{ca, bc, c}, std::array{ab, bc, ca}})
        finer.push_back(t);
    }
    triangles = finer;
  }
  OwnMesh mesh;
  mesh.vertices.resize(static_cast<Index>(points.size()), 3);
  for (std::size_t k = 0; k < points.size(); ++k) mesh.vertices.row(static_cast<Index>(k)) = points[k];
  for (const auto& t : triangles) mesh.faces.add(t);
  return mesh;
}

OwnMesh take_mesh(Bytes& bytes) {
  if (bytes.seldom(4)) return wild(bytes);
  const bool block = bytes.seldom(3);
  OwnMesh mesh = block ? around_block(bytes) : shape(bytes);
  std::vector<char> gone(mesh.faces.size(), 0);
  for (Index f : bytes.indices(block ? 2 : 40, 255))
    if (mesh.faces.size() > 0) gone[f % mesh.faces.size()] = 1;
  Faces left;
  for (Index f = 0; f < mesh.faces.size(); ++f)
    if (!gone[f]) left.add(mesh.faces[f]);
  for (int k = bytes.byte() % 12; k > 0; --k) {
    const Index v = bytes.whole(0, 65535) % mesh.vertices.rows();
    const Vec3 by = bytes.point();
    mesh.vertices.row(v) += by;
  }
  if (bytes.seldom(8)) {  // a face more, somewhere
    std::vector<Index> face(3 + bytes.byte() % 3);
    for (Index& v : face) v = bytes.byte() % mesh.vertices.rows();
    left.add(face);
  }
  if (bytes.seldom(8)) mesh.vertices *= bytes.number();
  if (bytes.seldom(8)) mesh.vertices.rowwise() += bytes.point().transpose();
  mesh.faces = left;
  return mesh;
}

}  // namespace tripatch::fuzz
