#include "tripatch/output/quad_layout.h"

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

namespace tripatch {
namespace {

/// A loop still to be filled: side k is the path of vertices from corner k + 1 to corner k + 2, both included.
struct Loop {
  std::array<std::vector<Index>, 3> side;
  std::array<bool, 3> on_rim = {false, false, false};
  Index count(int k) const { return static_cast<Index>(side[k].size()) - 1; }
};

using Path = std::vector<Index>;
Path part(const Path& v, Index from, Index to) { return {v.begin() + from, v.begin() + to + 1}; }
Path back(Path v) {
  std::reverse(v.begin(), v.end());
  return v;
}

class Builder {
public:
  explicit Builder(Index rim) : next_(rim) {}

  Faces faces;
  Index vertex_count() const { return next_; }

  void fill(Loop loop) {
    while (true) {
      int k = 0;
      for (int i = 1; i < 3; ++i)
        if (loop.count(i) > loop.count(k)) k = i;
      const Index n = loop.count(k), ni = loop.count((k + 1) % 3), nj = loop.count((k + 2) % 3), excess = n - ni - nj;
      if (excess < 0) return excess % 2 == 0 ? one_pole(loop) : one_triangle(loop);
      // A grid has a straight corner on its long side: right inside, and on the rim where nothing else is possible.
      if (excess == 0 && (!loop.on_rim[k] || n == 2)) return grid(loop, k);
      loop = excess % 2 == 0 && ni == 1 && nj == 1 && loop.on_rim[k] ? ring(loop) : strip_round(loop, k);
    }
  }

  /// A row of quads along the whole rim; returns the loop inside, of the same counts.
  Loop ring(const Loop& outer) {
    const std::array<Index, 3> corner = {add(), add(), add()};
    Loop inner;
    for (int k = 0; k < 3; ++k) {
      inner.side[k] = path(corner[(k + 1) % 3], corner[(k + 2) % 3], outer.count(k));
      row(outer.side[k], inner.side[k]);
    }
    return inner;
  }

private:
  Index add() { return next_++; }

  Path path(Index a, Index b, Index edges) {
    Path p = {a};
    for (Index k = 1; k < edges; ++k) p.push_back(add());
    p.push_back(b);
    return p;
  }

  /// Quads between two paths of the same length, `outer` traversed forwards.
  void row(const Path& outer, const Path& inner) {
    for (std::size_t k = 0; k + 1 < outer.size(); ++k)
      faces.add(std::array<Index, 4>{outer[k], outer[k + 1], inner[k + 1], inner[k]});
  }

  /// A grid from its four sides: bottom and top from left to right, left and right from bottom to top.
  void rectangle(const Path& bottom, const Path& right, const Path& top, const Path& left) {
    Path below = bottom;
    for (std::size_t j = 1; j < left.size(); ++j) {
      const Path above = j + 1 == left.size() ? top : path(left[j], right[j], static_cast<Index>(bottom.size()) - 1);
      row(below, above);
      below = above;
    }
  }

  /// From each side a spoke to the pole, s_i = (n_j + n_k - n_i) / 2 long, and a grid at each corner.
  void one_pole(const Loop& loop) {
    std::array<Index, 3> s;
    for (int i = 0; i < 3; ++i) s[i] = (loop.count((i + 1) % 3) + loop.count((i + 2) % 3) - loop.count(i)) / 2;
    const Index pole = add();
    std::array<Path, 3> spoke;
    for (int i = 0; i < 3; ++i) spoke[i] = path(loop.side[i][s[(i + 2) % 3]], pole, s[i]);
    for (int k = 0; k < 3; ++k) {
      const int in = (k + 1) % 3, out = (k + 2) % 3;  // the sides that end and start at corner k
      rectangle(part(loop.side[out], 0, s[in]), spoke[out], spoke[in], back(part(loop.side[in], s[k], loop.count(in))));
    }
  }

  /// Odd sum: a triangle in the middle, from each of its edges a strip one quad wide to the middle edge of a side, and a grid at
  /// each corner. Side i: s_{i+2} edges, the middle edge, s_{i+1} edges.
  void one_triangle(const Loop& loop) {
    std::array<Index, 3> s;
    for (int i = 0; i < 3; ++i) s[i] = (loop.count((i + 1) % 3) + loop.count((i + 2) % 3) - loop.count(i) - 1) / 2;
    const auto middle = [&](int i) { return s[(i + 2) % 3]; };
    std::array<Index, 3> tip = {-1, -1, -1};  // the triangle's corner nearest to corner k
    for (int i = 0; i < 3; ++i) {
      if (s[i] > 0) continue;  // a strip of length 0: the triangle lies on the rim
      tip[(i + 1) % 3] = loop.side[i][middle(i)];
      tip[(i + 2) % 3] = loop.side[i][middle(i) + 1];
    }
    for (Index& t : tip)
      if (t < 0) t = add();
    std::array<Path, 3> first, second;  // the two edges of the strip, from the side to the triangle
    for (int i = 0; i < 3; ++i) {
      const int before = (i + 2) % 3, after = (i + 1) % 3;
      // where the neighbor's strip has no length, the grid between has none either: its two long sides are one
      first[i] = s[before] == 0 ? back(part(loop.side[before], middle(before) + 1, loop.count(before)))
                 : s[i] == 0    ? Path{tip[after]}
                                : path(loop.side[i][middle(i)], tip[after], s[i]);
      second[i] = s[after] == 0 ? part(loop.side[after], 0, s[i])
                  : s[i] == 0   ? Path{tip[before]}
                                : path(loop.side[i][middle(i) + 1], tip[before], s[i]);
      row(second[i], first[i]);
    }
    faces.add(tip);
    for (int k = 0; k < 3; ++k) {
      const int in = (k + 1) % 3, out = (k + 2) % 3;
      if (s[in] == 0 || s[out] == 0) continue;
      rectangle(part(loop.side[out], 0, s[in]), first[out], second[in],
                back(part(loop.side[in], middle(in) + 1, loop.count(in))));
    }
  }

  /// n_k = n_i + n_j: a grid whose fourth corner lies on side k.
  void grid(const Loop& loop, int k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const Path& base = loop.side[k];
    rectangle(part(base, 0, loop.count(i)), part(base, loop.count(i), loop.count(k)), back(loop.side[i]), back(loop.side[j]));
  }

  /// A row along the two short sides, round the corner k between them; it takes an edge off each end of side k.
  Loop strip_round(const Loop& loop, int k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const Path& base = loop.side[k];
    const Index apex = add(), n = loop.count(k);
    Loop inner;
    inner.on_rim[k] = loop.on_rim[k];
    inner.side[k] = part(base, 1, n - 1);
    inner.side[i] = path(base[n - 1], apex, loop.count(i));
    inner.side[j] = path(apex, base[1], loop.count(j));
    row(loop.side[i], inner.side[i]);
    row(loop.side[j], inner.side[j]);
    return inner;
  }

  Index next_;
};

/// Inside vertices at the mean of their neighbors (Tutte 1963): in a convex triangle no face is turned over.
void embed(const std::vector<std::vector<Index>>& neighbors, Index rim, const std::vector<Index>& held, Points& barycentric) {
  const Index n = barycentric.rows();
  std::vector<Index> unknown(n, -1);
  Index unknowns = 0;
  for (Index v = rim; v < n; ++v)
    if (std::find(held.begin(), held.end(), v) == held.end()) unknown[v] = unknowns++;
  if (unknowns == 0) return;
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(unknowns, 3);
  for (Index v = rim; v < n; ++v) {
    if (unknown[v] < 0) continue;
    entries.emplace_back(unknown[v], unknown[v], static_cast<double>(neighbors[v].size()));
    for (Index w : neighbors[v]) {
      if (unknown[w] >= 0) {
        entries.emplace_back(unknown[v], unknown[w], -1.0);
      } else {
        right.row(unknown[v]) += barycentric.row(w);
      }
    }
  }
  Eigen::SparseMatrix<double> laplacian(unknowns, unknowns);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(laplacian);
  const Eigen::MatrixXd solution = solver.solve(right);
  for (Index v = rim; v < n; ++v)
    if (unknown[v] >= 0) barycentric.row(v) = solution.row(unknown[v]) / solution.row(unknown[v]).sum();
}

/// The smallest corner of the faces, as twice the signed area in barycentric coordinates.
double smallest_corner(const Faces& faces, const Points& b) {
  double smallest = 1;
  for (Index f = 0; f < faces.size(); ++f) {
    const auto face = faces[f];
    const std::size_t m = face.size();
    for (std::size_t k = 0; k < m; ++k) {
      const Vec3 p = b.row(face[k]), e = b.row(face[(k + 1) % m]).transpose() - p,
                 g = b.row(face[(k + m - 1) % m]).transpose() - p;
      smallest = std::min(smallest, e[0] * g[1] - e[1] * g[0]);
    }
  }
  return smallest;
}

}  // namespace

QuadLayout quad_layout(const std::array<std::vector<double>, 3>& parameters, int rows, const std::array<double, 2>& pole_offset) {
  QuadLayout layout;
  std::vector<Vec3> rim;
  Loop loop;
  loop.on_rim = {true, true, true};
  for (int i : {2, 0, 1}) {
    for (std::size_t k = 0; k < parameters[i].size(); ++k) {
      loop.side[i].push_back(static_cast<Index>(rim.size()));
      if (k + 1 == parameters[i].size()) break;  // the next side's first
      Vec3 b = Vec3::Zero();
      b[(i + 1) % 3] = 1 - parameters[i][k];
      b[(i + 2) % 3] = parameters[i][k];
      rim.push_back(b);
    }
  }
  loop.side[1].back() = 0;
  layout.rim = static_cast<Index>(rim.size());

  Builder builder(layout.rim);
  for (int r = 0; r < rows; ++r) loop = builder.ring(loop);
  builder.fill(loop);
  layout.faces = builder.faces;

  const Index n = builder.vertex_count();
  std::vector<std::vector<Index>> neighbors(n);
  for (Index f = 0; f < layout.faces.size(); ++f) {
    const auto face = layout.faces[f];
    for (std::size_t k = 0; k < face.size(); ++k) {
      const Index a = face[k], b = face[(k + 1) % face.size()];
      neighbors[a].push_back(b);
      neighbors[b].push_back(a);
    }
  }
  for (Index v = 0; v < n; ++v) {
    std::sort(neighbors[v].begin(), neighbors[v].end());
    neighbors[v].erase(std::unique(neighbors[v].begin(), neighbors[v].end()), neighbors[v].end());
    if (v >= layout.rim && neighbors[v].size() != 4) layout.poles.push_back(v);
  }
  layout.barycentric = Points::Zero(n, 3);
  for (Index v = 0; v < layout.rim; ++v) layout.barycentric.row(v) = rim[v];
  embed(neighbors, layout.rim, {}, layout.barycentric);

  // The poles move together, as far as no face turns over.
  Vec3 shift(-pole_offset[0] - pole_offset[1] / std::sqrt(3.0), pole_offset[0] - pole_offset[1] / std::sqrt(3.0),
             2 * pole_offset[1] / std::sqrt(3.0));
  for (int attempt = 0; attempt < 8 && shift.norm() > 0 && !layout.poles.empty(); ++attempt, shift *= 0.5) {
    Points moved = layout.barycentric;
    for (Index v : layout.poles) moved.row(v) += shift;
    embed(neighbors, layout.rim, layout.poles, moved);
    if (moved.minCoeff() >= 0 && smallest_corner(layout.faces, moved) > 0) {
      layout.barycentric = moved;
      break;
    }
  }
  return layout;
}

}  // namespace tripatch
