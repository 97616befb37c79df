#include "tripatch/estimate/stencils.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "tripatch/math/smoothstep.h"

namespace tripatch {

namespace {

// Half and twice of these numbers were tried on 78 rims in meshes of balls, tori, saddles and fillets, of 1 to 16 edges a side, with noise
// of 0 to 2% of an edge. Two percentages tell by how much planes err more in the mean: with half, with twice of it.
constexpr int enough_points = 50;  ///< a stencil stops growing at this size: more than twice the terms; -6%, 0%
constexpr int few_points = 8;  ///< beyond the rim: with fewer, those that do not lie in front of the side are used too; 3%, -5%
constexpr double steep = 0.5;  ///< cosine: vertices turned further count for nothing (14%, and with twice of it none is left),
constexpr double fully_from = 0.3;      ///< and fully from so much more on, where their heights are those of a graph; 5%, -8%
constexpr double never_nothing = 1e-6;  ///< but this, for a fit needs points
// Shares fade over a quarter of a rim edge, or of a ratio of distances, for a plane shall not jump when a vertex moves.
constexpr double beyond_end = 0.35;   ///< rim edges beyond the plane across a side's end where a share reaches 0; 1%, -4%
constexpr double nearer_other = 1.3;  ///< times as far from the side as from its neighbor: the share is 0; 31%, -6%
constexpr double fade_width = 0.25;

/// What lies in front of a side, at one of its vertices: as far as the rings reach only the side's own vertices and at its ends those
/// of its neighbors are looked at. What lies elsewhere does not count, because curvature may jump at the corners (where a fillet ends).
class InFront {
public:
  /// Distances of vertices from the ends of a side and of its neighbors are asked for again and again, and kept in `distances`.
  InFront(const LocalMesh& w, const std::array<SideDraft, 3>& drafts, int i, int k, SideDistances& distances)
      : w_(w), side_(drafts[i]), distances_(distances), edges_(side_.edges()) {
    nearest_ = std::max(k - most_rings, 0);
    farthest_ = std::min(k + most_rings, edges_);
    h_first_ = (w.position[side_.vertex[1]] - first()).norm();
    h_last_ = (w.position[side_.vertex[edges_ - 1]] - last()).norm();
  }

  bool is_own(int v) const {
    const int n = static_cast<int>(w_.rim.size());  // the vertices of the rim are the first, in its order
    return v < n && (v - side_.vertex[nearest_] + n) % n <= farthest_ - nearest_;
  }

  /// From 0, not in front, to 1. between: also between the planes across the side's ends.
  double share(int v, bool between) const {
    const bool at_start = nearest_ == 0, at_end = farthest_ == edges_;
    if ((!at_start && !at_end) || is_own(v)) return 1.0;
    const Vec3 q = w_.position[v];
    double share = 1;
    if (between && at_start) share *= fade((q - first()).dot(side_.tangent.front()) / h_first_ + beyond_end);
    if (between && at_end) share *= fade((last() - q).dot(side_.tangent.back()) / h_last_ + beyond_end);
    if (share <= 0) return share;
    const SideDistances::Of& d = distances_.of(v);
    const double mine = std::sqrt(at_start ? d.from_start[farthest_] : d.from_end[edges_ - nearest_]);
    const double other = std::sqrt(std::min(at_start ? d.before : INFINITY, at_end ? d.after : INFINITY));
    return share * fade(nearer_other - mine / std::max(other, 1e-12 * mine));
  }

private:
  static double fade(double x) { return smoothstep(x / fade_width); }
  const Vec3& first() const { return w_.position[side_.vertex.front()]; }
  const Vec3& last() const { return w_.position[side_.vertex.back()]; }

  const LocalMesh& w_;
  const SideDraft& side_;
  SideDistances& distances_;
  int edges_, nearest_, farthest_;
  double h_first_ = 0, h_last_ = 0;
};

/// The vertices of a stencil: rings around vertex k of a side, across smooth edges, on the sheet with normal e3.
const std::vector<Share>& grow(const LocalMesh& w, const SideDraft& side, int k, const Vec3& e3, const InFront& in_front,
                               const Neighborhood& near, SideSearch& marks) {
  std::vector<Share>& used = marks.grown.used;
  if (marks.grown.is_of(k, near, e3)) return used;
  std::vector<int>&front = marks.front, &next = marks.next, &all = marks.all;
  used.clear();
  all.clear();
  next.clear();
  double margin = INFINITY;  // of the cosines to the faces
  const auto reach = [&](int v) {
    if (marks.vertex[v] == marks.now) return;
    marks.vertex[v] = marks.now;
    next.push_back(v);
    if (w.on_chord[v]) return;
    all.push_back(v);
    const double share = in_front.share(v, true);
    if (share > 0) used.emplace_back(v, share);
  };
  const auto take = [&](int f) {
    marks.face[f] = marks.now;
    for (int v : w.part[f]) reach(v);
  };
  const auto is_of_sheet = [&](int f) {
    const double along = w.area[f].dot(e3), least = same_sheet * w.twice_area[f];
    margin = std::min(margin, std::abs(along - least) / w.twice_area[f]);  // no number where there is no area: never of it
    return along > least;
  };
  // smooth edges connect it with a face that is taken
  const auto connected = [&](int f) {
    for (int c = w.part.offsets[f]; c < w.part.offsets[f + 1]; ++c)
      if (w.across[c] >= 0 && marks.face[w.across[c]] == marks.now) return true;
    return false;
  };
  ++marks.now;
  reach(side.vertex[k]);
  front.assign(1, side.vertex[k]);
  next.clear();
  take(side.face[std::max(k - 1, 0)]);
  take(side.face[std::min(k, side.edges() - 1)]);
  for (int ring = 0; ring < near.rings && static_cast<int>(used.size()) < enough_points && !front.empty(); ++ring) {
    for (bool more = true; more;) {  // until none is left that is connected: in whatever order they are looked at
      bool taken = false, left = false;
      for (int v : front)
        for (int f : w.part.faces_at(v)) {
          if (std::abs(marks.face[f]) == marks.now) continue;
          if (!is_of_sheet(f)) {
            marks.face[f] = -marks.now;
          } else if (connected(f)) {
            take(f);
            taken = true;
          } else {
            left = true;
          }
        }
      more = taken && left;
    }
    std::swap(front, next);
    next.clear();
  }
  // Where the rows lean over the end of the side, next to nothing may be left: then what is nearer to this side, then all.
  for (int attempt = 0; near.widened && attempt < 2; ++attempt) {
    const auto beyond_rim = std::count_if(used.begin(), used.end(), [&](const Share& u) { return !in_front.is_own(u.first); });
    if (beyond_rim >= few_points || used.size() == all.size()) break;
    used.clear();
    for (int v : all) {
      const double share = attempt == 0 ? in_front.share(v, false) : 1;
      if (share > 0) used.emplace_back(v, share);
    }
  }
  constexpr double rounding = 1e-9;
  marks.grown = {k, near, e3, margin * (1 - rounding) - rounding, std::move(used)};
  return marks.grown.used;
}

/// Places, heights and weights of the stencil's vertices about p.
void set_heights(const LocalMesh& w, const std::vector<Share>& used, const Vec3& p, Stencil& s) {
  s.points = static_cast<Index>(used.size());
  s.heights.resize((used.size() + 7) / 8);
  s.distances = 0;
  const double stretch = 1 / (s.depth * s.depth) - 1;
  for (std::size_t first = 0; first < used.size(); first += 8) {
    EightHeights& of = s.heights[first / 8];
    std::array<double, 8> x, y, z, squares;
    for (std::size_t k = 0; k < 8; ++k) {
      const bool is_there = first + k < used.size();
      const Vec3& at = is_there ? w.position[used[first + k].first] : p;
      x[k] = at[0] - p[0];
      y[k] = at[1] - p[1];
      z[k] = at[2] - p[2];
      of.share[k] = is_there ? used[first + k].second : 0;
    }
    for (int k = 0; k < 8; ++k) {
      of.x[k] = x[k] * s.e1[0] + y[k] * s.e1[1] + z[k] * s.e1[2];
      const double across = x[k] * s.e2[0] + y[k] * s.e2[1] + z[k] * s.e2[2];
      of.y[k] = across / s.depth;
      of.z[k] = x[k] * s.e3[0] + y[k] * s.e3[1] + z[k] * s.e3[2];
      const double square = x[k] * x[k] + y[k] * y[k] + z[k] * z[k] + across * across * stretch;
      of.g[k] = square * square * square * square * square * square;
      squares[k] = std::sqrt(square);
    }
    for (double distance : squares) s.distances += distance;
  }
}

/// What is known of the slopes at vertex k beside the heights: from the faces beside the rim, and from the curve through it.
void set_slopes(const LocalMesh& w, const SideDraft& side, int k, Stencil& s) {
  const int edges = side.edges();
  const auto chord = [&](int e) { return (side.position[e + 1] - side.position[e]).norm(); };
  double depth = 0;  // of the faces beside the rim
  for (int e : {std::max(k - 1, 0), std::min(k, edges - 1)}) depth += 0.5 * w.area[side.face[e]].norm() / chord(e);
  depth /= s.depth;
  s.faces = -side.faces[k].dot(s.e2) / side.faces[k].dot(s.e3) * s.depth;
  s.faces_noise = 1 / (depth * depth);
  // how well the interpolating curve knows its own direction here
  const bool end = k == 0 || k == edges;
  const double a = chord(std::max(k - 1, 0)), b = chord(std::min(k, edges - 1)), h = std::max(a, b), l = std::min(a, b);
  s.slope_noise = std::pow((end ? 3.8 : 1.1) / l, 2);
  s.slope_order = std::min(edges + 1, 4);
  s.slope_truncation = edges == 1 ? h / 2 : edges == 2 ? h * h / 3 : h * h * h / (end ? 4 : 24);
}

}  // namespace

void look(const LocalMesh& w, const std::array<SideDraft, 3>& drafts, int i, int k, const Neighborhood& near, SideSearch& search,
          Seen& seen) {
  Stencil& s = seen.stencil;
  const SideDraft& side = drafts[i];
  s.e1 = side.tangent[k];
  s.e3 = (side.guess[k] - s.e1 * s.e1.dot(side.guess[k])).normalized();
  s.e2 = s.e1.cross(s.e3);
  s.depth = near.scaled ? side.depth : 1;
  seen.used = grow(w, side, k, s.e3, InFront(w, drafts, i, k, search.distances), near, search);
  // Where the surface has turned far away, its height over this plane is no polynomial any more.
  for (auto& [v, share] : seen.used) {
    const Vec3& n = w.area_at[v];
    const double length = n.norm();
    if (length > 0) share *= std::max(smoothstep((n.dot(s.e3) / length - steep) / fully_from), never_nothing);
  }
}

void measure(const LocalMesh& w, const std::array<SideDraft, 3>& drafts, int i, int k, const Neighborhood& near,
             SideSearch& search, Seen& seen) {
  look(w, drafts, i, k, near, search, seen);
  set_heights(w, seen.used, drafts[i].position[k], seen.stencil);
  set_slopes(w, drafts[i], k, seen.stencil);
}

}  // namespace tripatch
