#include "tripatch/mesh/decimated.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "tripatch/math/interruption.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/math/tolerant_compare.h"
#include "tripatch/mesh/border_loops.h"
#include "tripatch/mesh/triangles.h"

namespace tripatch {
namespace {

/// Of the angle by which a triangle may turn: below the 60 degrees from which on fills count as folded at neighbors.
constexpr double min_cosine = share::half;
constexpr Index min_loop = count::octet;  ///< vertices that a border loop keeps: a round island is still round
constexpr int max_levels = count::dozen;  ///< of lengths, each twice the one before
constexpr Index often = count::portion;   ///< vertices between two looks for an interruption

class Collapsing {
public:
  Collapsing(const Points& points, const std::vector<std::array<Index, 3>>& triangles, double length)
      : points_(points),
        triangles_(triangles),
        length_(length),
        first_(points.rows(), none),
        next_(3 * triangles.size(), none),
        loop_(points.rows(), -1),
        fixed_(points.rows(), 0),
        seen_(points.rows(), 0) {
    for (std::size_t t = triangles.size(); t-- > 0;)
      for (int k = 3; k-- > 0;) link(static_cast<int>(3 * t) + k);
    const Faces faces = faces_of(triangles);
    for (const std::vector<Index>& loop : border_loops(Connectivity(faces, points.rows()))) {
      for (Index v : loop) {
        if (loop_[v] >= 0) fixed_[v] = 1;  // where borders touch
        loop_[v] = static_cast<Index>(left_.size());
      }
      left_.push_back(static_cast<Index>(loop.size()));
    }
  }

  void run() {
    double shortest = length_;
    for (const std::array<Index, 3>& t : triangles_)
      for (int k = 0; k < 3; ++k) shortest = std::min(shortest, (points_.row(t[k]) - points_.row(t[(k + 1) % 3])).norm());
    int level = 0;
    while (level < max_levels && clearly_less(shortest, std::ldexp(length_, -level - 1))) ++level;
    for (; level > 0; --level) sweep(std::ldexp(length_, -level));
    while (sweep(length_)) continue;
  }

  CoarserMesh result() const {
    CoarserMesh out;
    std::vector<Index> place(first_.size(), -1);
    for (std::size_t v = 0; v < first_.size(); ++v) {
      if (first_[v] == none) continue;
      place[v] = static_cast<Index>(out.kept.size());
      out.kept.push_back(static_cast<Index>(v));
    }
    for (const std::array<Index, 3>& t : triangles_)
      if (t[0] >= 0) out.triangles.push_back({place[t[0]], place[t[1]], place[t[2]]});
    return out;
  }

private:
  static constexpr int none = -1;

  void link(int corner) {
    const Index v = triangles_[corner / 3][corner % 3];
    next_[corner] = first_[v];
    first_[v] = corner;
  }

  /// The triangles at v, those that are gone taken out of its list.
  const std::vector<Index>& around(Index v) {
    at_.clear();
    for (int* corner = &first_[v]; *corner != none;) {
      if (triangles_[*corner / 3][0] < 0) {
        *corner = next_[*corner];
        continue;
      }
      at_.push_back(*corner / 3);
      corner = &next_[*corner];
    }
    return at_;
  }

  static bool has(const std::array<Index, 3>& t, Index v) { return std::find(t.begin(), t.end(), v) != t.end(); }

  /// Marks v's neighbors with a number that no other vertex has.
  void mark(Index v) {
    ++mark_;
    for (Index t : around(v))
      for (Index w : triangles_[t]) seen_[w] = mark_;
    seen_[v] = 0;
  }

  /// Every vertex once: what is nearer to it than `length` is collapsed with it, the nearest first. Whether anything was.
  bool sweep(double length) {
    bool changed = false;
    for (Index v = 0; std::cmp_less(v, first_.size()); ++v) {
      if (v % often == 0) check_interruption();
      while (first_[v] != none && collapse_nearest(v, length)) changed = true;
    }
    return changed;
  }

  bool collapse_nearest(Index v, double length) {
    near_.clear();
    mark(v);
    for (Index t : at_)
      for (Index w : triangles_[t]) {
        if (seen_[w] != mark_) continue;
        seen_[w] = 0;
        if (const double far = (points_.row(v) - points_.row(w)).norm(); clearly_less(far, length))
          near_.push_back({coarse(far), w});
      }
    std::sort(near_.begin(), near_.end());
    for (const auto& [far, w] : near_)
      if (collapse(std::min(v, w), std::max(v, w)) || collapse(std::max(v, w), std::min(v, w))) return true;
    return false;
  }

  /// Whether `gone` can become `kept` and the mesh stays what it is: the vertices joined to both are those of the triangles at the edge.
  /// Leaves the triangles at `gone`.
  bool may_go(Index kept, Index gone) {
    if (fixed_[gone]) return false;
    if (loop_[gone] >= 0 && (loop_[kept] != loop_[gone] || left_[loop_[gone]] <= min_loop)) return false;
    mark(kept);
    Index shared = 0, common = 0;
    for (Index t : around(gone)) {
      shared += has(triangles_[t], kept);
      for (Index w : triangles_[t])
        if (seen_[w] == mark_ && w != gone) ++common, seen_[w] = 0;
    }
    return shared > 0 && common == shared && (loop_[gone] < 0 || shared == 1);
  }

  bool collapse(Index kept, Index gone) {
    if (!may_go(kept, gone)) return false;
    for (Index t : at_) {
      std::array<Index, 3> turned = triangles_[t];
      if (has(turned, kept)) continue;
      const Vec3 before = triangle_normal(points_, turned);
      std::replace(turned.begin(), turned.end(), gone, kept);
      const Vec3 after = triangle_normal(points_, turned);
      if (!(after.dot(before) > min_cosine * after.norm() * before.norm())) return false;
    }
    first_[gone] = none;
    for (Index t : at_) {
      std::array<Index, 3>& triangle = triangles_[t];
      if (has(triangle, kept)) {
        triangle = {-1, -1, -1};
        continue;
      }
      const auto corner = std::find(triangle.begin(), triangle.end(), gone);
      *corner = kept;
      link(static_cast<int>(3 * t + (corner - triangle.begin())));
    }
    if (loop_[gone] >= 0) --left_[loop_[gone]];
    return true;
  }

  const Points& points_;
  std::vector<std::array<Index, 3>> triangles_;  // -1: gone
  double length_;
  std::vector<int> first_,
      next_;  // a corner of each vertex, 3 times the triangle and its place there, and after each the next one
  std::vector<Index> loop_, left_;  // of each vertex, -1: none; vertices of each loop
  std::vector<char> fixed_;
  std::vector<Index> seen_;  // of each vertex the mark
  Index mark_ = 0;
  std::vector<Index> at_;
  std::vector<std::pair<double, Index>> near_;
};

}  // namespace

CoarserMesh decimated(const Points& points, const std::vector<std::array<Index, 3>>& triangles, double length) {
  Collapsing mesh(points, triangles, length);
  mesh.run();
  return mesh.result();
}

}  // namespace tripatch
