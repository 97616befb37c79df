#include "tripatch/mesh/coarsened.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <queue>
#include <tuple>

#include "tripatch/math/ties.h"
#include "tripatch/mesh/border_loops.h"
#include "tripatch/mesh/triangles.h"

namespace tripatch {
namespace {

/// Of the angle by which a triangle may turn: below the 60 degrees from which on fills count as folded at neighbors.
constexpr double least_cosine = 0.5;
constexpr Index least_loop = 8;  ///< vertices that a border loop keeps: a round island is still round

class Collapsing {
public:
  Collapsing(const Points& points, const std::vector<std::array<Index, 3>>& triangles, double length)
      : points_(points),
        triangles_(triangles),
        length_(length),
        at_(points.rows()),
        loop_(points.rows(), -1),
        fixed_(points.rows(), 0) {
    for (std::size_t t = 0; t < triangles.size(); ++t)
      for (Index v : triangles[t]) at_[v].push_back(static_cast<Index>(t));
    const Faces faces = faces_of(triangles);
    for (const std::vector<Index>& loop : border_loops(Connectivity(faces, points.rows()))) {
      for (Index v : loop) {
        if (loop_[v] >= 0) fixed_[v] = 1;  // where borders touch
        loop_[v] = static_cast<Index>(left_.size());
      }
      left_.push_back(static_cast<Index>(loop.size()));
    }
    for (const std::array<Index, 3>& t : triangles)
      for (int k = 0; k < 3; ++k) push(t[k], t[(k + 1) % 3]);
  }

  void run() {
    while (!queue_.empty()) {
      const auto [length, a, b] = queue_.top();
      queue_.pop();
      if (at_[a].empty() || at_[b].empty()) continue;
      if (!collapse(a, b)) collapse(b, a);
    }
  }

  CoarserMesh result() const {
    CoarserMesh out;
    std::vector<Index> place(at_.size(), -1);
    for (std::size_t v = 0; v < at_.size(); ++v) {
      if (at_[v].empty()) continue;
      place[v] = static_cast<Index>(out.kept.size());
      out.kept.push_back(static_cast<Index>(v));
    }
    for (const std::array<Index, 3>& t : triangles_)
      if (t[0] >= 0) out.triangles.push_back({place[t[0]], place[t[1]], place[t[2]]});
    return out;
  }

private:
  using Entry = std::tuple<double, Index, Index>;

  void push(Index a, Index b) {
    const double length = (points_.row(a) - points_.row(b)).norm();
    if (clearly_less(length, length_)) queue_.push({coarse(length), std::min(a, b), std::max(a, b)});
  }

  static bool has(const std::array<Index, 3>& t, Index v) { return std::find(t.begin(), t.end(), v) != t.end(); }

  std::vector<Index> neighbors(Index v) const {
    std::vector<Index> all;
    for (Index t : at_[v])
      for (Index w : triangles_[t])
        if (w != v) all.push_back(w);
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
  }

  /// Whether `gone` can become `kept` and the mesh stays what it is: the vertices joined to both are those of the triangles at the edge.
  bool may_go(Index kept, Index gone) const {
    const Index shared = std::count_if(at_[gone].begin(), at_[gone].end(), [&](Index t) { return has(triangles_[t], kept); });
    if (shared == 0 || fixed_[gone]) return false;
    if (loop_[gone] >= 0 && (shared != 1 || loop_[kept] != loop_[gone] || left_[loop_[gone]] <= least_loop)) return false;
    const std::vector<Index> a = neighbors(kept), b = neighbors(gone);
    std::vector<Index> common;
    std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(common));
    return static_cast<Index>(common.size()) == shared;
  }

  Vec3 normal(const std::array<Index, 3>& t) const {
    const Vec3 p = points_.row(t[0]), q = points_.row(t[1]), r = points_.row(t[2]);
    return (q - p).cross(r - p);
  }

  bool collapse(Index kept, Index gone) {
    if (!may_go(kept, gone)) return false;
    for (Index t : at_[gone]) {
      std::array<Index, 3> turned = triangles_[t];
      if (has(turned, kept)) continue;
      const Vec3 before = normal(turned);
      std::replace(turned.begin(), turned.end(), gone, kept);
      const Vec3 after = normal(turned);
      if (!(after.dot(before) > least_cosine * after.norm() * before.norm())) return false;
    }
    for (Index t : at_[gone]) {
      if (has(triangles_[t], kept)) {
        for (Index v : triangles_[t])
          if (v != gone) std::erase(at_[v], t);
        triangles_[t] = {-1, -1, -1};
      } else {
        std::replace(triangles_[t].begin(), triangles_[t].end(), gone, kept);
        at_[kept].push_back(t);
      }
    }
    at_[gone].clear();
    if (loop_[gone] >= 0) --left_[loop_[gone]];
    for (Index v : neighbors(kept)) push(kept, v);
    return true;
  }

  const Points& points_;
  std::vector<std::array<Index, 3>> triangles_;  // -1: gone
  double length_;
  std::vector<std::vector<Index>> at_;  // triangles at each vertex; none: it is gone
  std::vector<Index> loop_, left_;      // of each vertex, -1: none; vertices of each loop
  std::vector<char> fixed_;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
};

}  // namespace

CoarserMesh coarsened(const Points& points, const std::vector<std::array<Index, 3>>& triangles, double length) {
  Collapsing mesh(points, triangles, length);
  mesh.run();
  return mesh.result();
}

}  // namespace tripatch
