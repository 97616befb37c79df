#include "tripatch/estimate/stencils.h"

#include <Eigen/Dense>

#include "tripatch/math/smoothstep.h"
#include "tripatch/math/thresholds.h"

namespace tripatch {

namespace {

// Half and twice of these numbers were tried on 78 rims in meshes of balls, tori, saddles and fillets, of 1 to 16 edges a side, with noise
// of 0 to 2% of an edge. Two percentages tell by how much planes err more in the mean: with half, with twice of it.
constexpr int enough_points = 50;  ///< a stencil stops growing at this size: more than twice the terms; -6%, 0%
/// Beyond the rim: with fewer, those that do not lie in front of the side are used too; 3%, -5%.
constexpr int few_points = count::octet;
/// Cosine: vertices turned further count for nothing (14%, and with twice of it none is left).
constexpr double steep = share::half;
/// And fully from so much more on, where their heights are those of a graph; 5%, -8%.
constexpr double fully_from = share::three_tenths;
// Shares fade over a quarter of a rim edge, or of a ratio of distances, for a plane shall not jump when a vertex moves.
constexpr double beyond_end = 0.35;   ///< rim edges beyond the plane across a side's end where a share reaches 0; 1%, -4%
constexpr double nearer_other = 1.3;  ///< times as far from the side as from its neighbor: the share is 0; 31%, -6%
constexpr double fade_width = share::quarter;

/// What lies in front of a side, at one of its vertices: as far as the rings reach only the side's own vertices and at its ends those
/// of its neighbors are looked at. What lies elsewhere does not count, because curvature may jump at the corners (where a fillet ends).
class InFront {
public:
  /// Distances of vertices from the ends of a side and of its neighbors are asked for again and again, and kept in `distances`.
  InFront(const LocalMesh& w, const SideDraft& side, int k, SideDistances& distances)
      : w_(w), side_(side), distances_(distances), edges_(side.edges()) {
    nearest_ = std::max(k - max_rings, 0);
    farthest_ = std::min(k + max_rings, edges_);
    h_first_ = (w.position[side_.vertex[1]] - first()).norm();
    h_last_ = (w.position[side_.vertex[edges_ - 1]] - last()).norm();
    counts_all_ = nearest_ > 0 && farthest_ < edges_;
  }

  bool is_own(int v) const {
    const int n = static_cast<int>(w_.rim.size());  // the vertices of the rim are the first, in its order
    return v < n && (v - side_.vertex[nearest_] + n) % n <= farthest_ - nearest_;
  }

  /// From 0, not in front, to 1. between: also between the planes across the side's ends.
  double share(int v, bool between) const { return counts_all_ || is_own(v) ? 1.0 : share_at_end(v, between); }

private:
  double share_at_end(int v, bool between) const {
    const bool at_start = nearest_ == 0, at_end = farthest_ == edges_;
    const Vec3 q = w_.position[v];
    double share = 1;
    if (between && at_start) share *= fade((q - first()).dot(side_.tangent.front()) / h_first_ + beyond_end);
    if (between && at_end) share *= fade((last() - q).dot(side_.tangent.back()) / h_last_ + beyond_end);
    if (share <= 0) return share;
    const SideDistances::Of& d = distances_.of(v);
    const double mine = std::sqrt(at_start ? d.from_start[farthest_] : d.from_end[edges_ - nearest_]);
    const double other = std::sqrt(std::min(at_start ? d.before : INFINITY, at_end ? d.after : INFINITY));
    return share * fade(nearer_other - mine / std::max(other, tolerance::rounding * mine));
  }

  static double fade(double x) { return smoothstep(x / fade_width); }
  const Vec3& first() const { return w_.position[side_.vertex.front()]; }
  const Vec3& last() const { return w_.position[side_.vertex.back()]; }

  const LocalMesh& w_;
  const SideDraft& side_;
  SideDistances& distances_;
  int edges_, nearest_, farthest_;
  bool counts_all_;  // far from the ends
  double h_first_ = 0, h_last_ = 0;
};

/// Whether the faces at a vertex follow each other around it, each across a smooth edge of the one before.
bool follow_smoothly(const LocalMesh& w, int v) {
  const Submesh& part = w.part;
  const std::span<const int> faces = part.faces_at(v);
  std::size_t met = 1;
  for (const bool forth : {true, false})
    for (int f = faces[0]; met < faces.size(); ++met) {
      const int begin = part.offsets[f], end = part.offsets[f + 1];
      int c = begin;
      while (c < end && part.corners[c] != v) ++c;
      if (c == end) return false;
      f = w.across[forth ? c : c > begin ? c - 1 : end - 1];
      if (f == faces[0]) return false;
      if (f < 0) break;
    }
  return met == faces.size();
}

/// Grows the vertices of a stencil: rings around vertex k of a side, across smooth edges, on the sheet with normal e3.
class Growing {
public:
  Growing(const LocalMesh& w, const SideDraft& side, int k, const Vec3& e3, const InFront& in_front, SideSearch& search)
      : w_(w),
        side_(side),
        k_(k),
        e3_(e3),
        in_front_(in_front),
        search_(search),
        vertex_(search.vertex.data()),
        face_(search.face.data()),
        reached_(search.reached.data()) {}

  /// By vertices: where all faces at one follow each other and are of the sheet, and one is taken, all are. False, and what is grown is nothing,
  /// where that does not hold.
  bool grow_smoothly(int rings) {
    return take_rings(rings, [&](int from, int to) {
      for (int j = from; j < to; ++j) {
        const SideSearch::Around& around = search_.around(w_, reached_[j]);
        const double over = w_.normal_at[reached_[j]].dot(e3_) - around.off - same_sheet;
        if (!(over > 0)) return false;
        margin_ = std::min(margin_, over);
        for (int u = around.begin; u < around.end; ++u) reach(search_.neighbors[u]);
      }
      return true;
    });
  }

  /// By faces, in any mesh.
  void grow(int rings) {
    take_rings(rings, [&](int from, int to) {
      for (bool more = true; more;) {  // until none is left that is connected: in whatever order they are looked at
        bool taken = false, left = false;
        for (int j = from; j < to; ++j)
          for (int f : w_.part.faces_at(reached_[j])) {
            if (std::abs(face_[f]) == now_) continue;
            if (!is_of_sheet(f)) {
              face_[f] = -now_;
            } else if (is_connected(f)) {
              take(f);
              taken = true;
            } else {
              left = true;
            }
          }
        more = taken && left;
      }
      return true;
    });
  }

  /// Where the rows lean over the end of the side, next to nothing may be left: then what is nearer to this side is used, then all.
  void widen() {
    const std::span<const int> all(reached_, reached_ + count_);
    const auto telling = std::count_if(all.begin(), all.end(), [&](int v) { return !w_.on_chord[v]; });
    for (const bool by_share : {true, false}) {
      const auto beyond_rim =
          std::count_if(used_.begin(), used_.end(), [&](const Share& u) { return !in_front_.is_own(u.first); });
      if (beyond_rim >= few_points || static_cast<std::ptrdiff_t>(used_.size()) == telling) return;
      used_.clear();
      use(0, [&](int v) { return by_share ? in_front_.share(v, false) : 1; });
    }
  }

  /// Of the cosines to the faces.
  double margin() const { return margin_; }

private:
  /// Ring after ring, the first around vertex k: of_ring(from, to) takes the faces at the vertices that are its front.
  template <class OfRing>
  bool take_rings(int rings, const OfRing& of_ring) {
    used_.clear();
    now_ = ++search_.now;
    margin_ = INFINITY;
    count_ = 0;
    reach(side_.vertex[k_]);
    take(side_.face[std::max(k_ - 1, 0)]);
    take(side_.face[std::min(k_, side_.edges() - 1)]);
    const auto in_front = [&](int v) { return in_front_.share(v, true); };
    use(0, in_front);
    for (int ring = 0, from = 0; ring < rings && static_cast<int>(used_.size()) < enough_points && from < count_; ++ring) {
      const int to = ring == 0 ? 1 : count_, before = count_;
      if (!of_ring(from, to)) return false;
      use(before, in_front);
      from = to;
    }
    return true;
  }

  /// Without a branch: it would often be guessed wrong.
  void reach(int v) {
    reached_[count_] = v;
    count_ += vertex_[v] != now_;
    vertex_[v] = now_;
  }
  /// Those reached from number `from` on.
  template <class ShareOf>
  void use(int from, const ShareOf& share_of) {
    for (int j = from; j < count_; ++j) {
      const int v = reached_[j];
      if (w_.on_chord[v]) continue;
      const double share = share_of(v);
      if (share > 0) used_.emplace_back(v, share);
    }
  }
  void take(int f) {
    face_[f] = now_;
    for (int v : w_.part[f]) reach(v);
  }
  bool is_of_sheet(int f) {
    const double along = w_.area[f].dot(e3_), off = along - same_sheet * w_.twice_area[f];
    if (std::abs(off) < margin_ * w_.twice_area[f]) margin_ = std::abs(off) / w_.twice_area[f];  // where there is no area, none
    return off > 0;
  }
  /// Whether a smooth edge connects it with a face that is taken.
  bool is_connected(int f) const {
    for (int c = w_.part.offsets[f]; c < w_.part.offsets[f + 1]; ++c)
      if (w_.across[c] >= 0 && face_[w_.across[c]] == now_) return true;
    return false;
  }

  const LocalMesh& w_;
  const SideDraft& side_;
  int k_;
  Vec3 e3_;
  const InFront& in_front_;
  SideSearch& search_;
  int *vertex_, *face_, *reached_;
  std::vector<Share>& used_ = search_.grown.used;
  int now_ = 0, count_ = 0;  // of those reached
  double margin_ = INFINITY;
};

/// What is grown, or was last.
const std::vector<Share>& grow(const LocalMesh& w, const SideDraft& side, int k, const Vec3& e3, const Neighborhood& near,
                               SideSearch& search) {
  if (search.grown.is_of(k, near, e3)) return search.grown.used;
  const InFront in_front(w, side, k, search.distances);
  Growing growing(w, side, k, e3, in_front, search);
  if (!growing.grow_smoothly(near.rings)) growing.grow(near.rings);
  if (near.widened) growing.widen();
  constexpr double rounding = tolerance::solved;
  search.grown = {k, near, e3, growing.margin() * (1 - rounding) - rounding, std::move(search.grown.used)};
  return search.grown.used;
}

/// Places, heights and weights of the stencil's vertices about p.
void set_heights(const LocalMesh& w, const std::vector<Share>& used, const Vec3& p, Stencil& s) {
  const std::size_t size = used.size();
  s.points = static_cast<Index>(size);
  s.heights.resize((size + 7) / 8);
  if (size % 8 > 0) s.heights.back() = {};
  for (std::size_t k = 0; k < size; ++k) {
    SampleBlock& of = s.heights[k / 8];
    const Vec3& at = w.position[used[k].first];
    of.x[k % 8] = at[0] - p[0];
    of.y[k % 8] = at[1] - p[1];
    of.z[k % 8] = at[2] - p[2];
    of.share[k % 8] = used[k].second;
  }
  lay_over(s.e1, s.e2 / s.depth, s.e3, s.heights);
}

/// What is known of the slopes at vertex k next to the heights: from the faces next to the rim, and from the curve through it.
void set_slopes(const LocalMesh& w, const SideDraft& side, int k, Stencil& s) {
  const int edges = side.edges();
  const auto chord = [&](int e) { return (side.position[e + 1] - side.position[e]).norm(); };
  double depth = 0;  // of the faces next to the rim
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

void SideSearch::look_around(const LocalMesh& w, int v) {
  Around& all = around_[v];
  const Submesh& part = w.part;
  const std::span<const int> faces = part.faces_at(v);
  std::size_t most = 0;
  for (int f : faces) most += part[f].size();
  all.begin = all.end = static_cast<int>(neighbors.size());
  neighbors.resize(neighbors.size() + most);
  seen_from_[v] = v;
  double cosine = follow_smoothly(w, v) ? 1 : -INFINITY;
  for (int f : faces) {
    cosine = std::min(cosine, w.twice_area[f] > 0 ? w.area[f].dot(w.normal_at[v]) / w.twice_area[f] : -INFINITY);
    for (int u : part[f]) {
      neighbors[all.end] = u;
      all.end += seen_from_[u] != v;
      seen_from_[u] = v;
    }
  }
  neighbors.resize(all.end);
  constexpr double rounding = tolerance::rounding;
  all.off = std::sqrt(2 * (1 - cosine) + rounding);
}

void look(const LocalMesh& w, const SideDraft& side, int k, const Neighborhood& near, SideSearch& search, Seen& seen) {
  Stencil& s = seen.stencil;
  s.e1 = side.tangent[k];
  s.e3 = (side.guess[k] - s.e1 * s.e1.dot(side.guess[k])).normalized();
  s.e2 = s.e1.cross(s.e3);
  s.depth = near.scaled ? side.depth : 1;
  seen.used = grow(w, side, k, s.e3, near, search);
  // Where the surface has turned far away, its height over this plane is no polynomial any more.
  for (auto& [v, share] : seen.used) {
    const Vec3& n = w.normal_at[v];
    const double cosine = n.dot(s.e3);
    if (cosine >= steep + fully_from || n.isZero(0)) continue;
    share *= std::max(smoothstep((cosine - steep) / fully_from), tolerance::same);
  }
}

void measure(const LocalMesh& w, const SideDraft& side, int k, const Neighborhood& near, SideSearch& search, Seen& seen) {
  look(w, side, k, near, search, seen);
  set_heights(w, seen.used, side.position[k], seen.stencil);
  set_slopes(w, side, k, seen.stencil);
}

}  // namespace tripatch
