// The vertices around a vertex of a rim that tell its plane: in front of its side, across smooth edges, on one sheet.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "tripatch/estimate/local_mesh.h"
#include "tripatch/estimate/plane_fit.h"
#include "tripatch/estimate/side_draft.h"
#include "tripatch/math/thresholds.h"

namespace tripatch {

constexpr double same_sheet =
    share::half;  ///< cosine: faces turned further from the vertex's own are another sheet (a cube's edge)
constexpr double coplanar =
    1e-3;  ///< degrees: what coordinates in single precision leave of faces in a plane, as files have them

/// What the plane at a rim vertex may be estimated from. Which one serves best differs from vertex to vertex: on a fair surface the more
/// the better, but beyond a smooth edge curvature may jump, as where a fillet ends, and no polynomial continues there.
struct Neighborhood {
  int rings;
  bool widened;    ///< where little lies in front of the side, by what does not
  bool all_sides;  ///< the variances are those of all sides together, not of each
  bool
      scaled;  ///< lengths across the rim are in rows of faces: long strips bend little across, or their mesh would be finer there
};
constexpr std::array<Neighborhood, 5> neighborhoods = {{{max_rings, true, true, false},
                                                        {max_rings, false, false, false},
                                                        {max_rings, false, false, true},
                                                        {2, false, false, true},
                                                        {1, false, false, true}}};

/// How far vertices are from the vertices at the ends of a side and from those of its neighbors there, squared.
class SideDistances {
public:
  static constexpr int most = max_rings * 2;  ///< edges of a side's end that are looked at together
  struct Of {
    std::array<double, most + 1> from_start, from_end;  ///< from the nearest of the first vertices, up to the one of each place
    double before, after;                               ///< from the ends of the neighbors
  };

  SideDistances(const LocalMesh& w, const std::array<SideDraft, 3>& drafts, int i)
      : w_(w),
        own_(drafts[i].vertex),
        before_(drafts[(i + 2) % 3].vertex),
        after_(drafts[(i + 1) % 3].vertex),
        known_(w.position.size(), 0),
        all_(std::make_unique_for_overwrite<Of[]>(w.position.size())) {}

  const Of& of(int v) {
    Of& d = all_[v];
    if (std::exchange(known_[v], 1)) return d;
    const auto from = [&](int to) { return (w_.position[to] - w_.position[v]).squaredNorm(); };
    const std::size_t places = std::min<std::size_t>(own_.size(), most + 1);
    double start = INFINITY, end = INFINITY;
    for (std::size_t k = 0; k < places; ++k) {
      d.from_start[k] = start = std::min(start, from(own_[k]));
      d.from_end[k] = end = std::min(end, from(own_[own_.size() - 1 - k]));
    }
    d.before = d.after = INFINITY;
    for (std::size_t k = 1; k < before_.size() && k <= max_rings; ++k)
      d.before = std::min(d.before, from(before_[before_.size() - 1 - k]));
    for (std::size_t k = 1; k < after_.size() && k <= max_rings; ++k) d.after = std::min(d.after, from(after_[k]));
    return d;
  }

private:
  const LocalMesh& w_;
  std::span<const int> own_, before_, after_;
  std::vector<char> known_;
  std::unique_ptr<Of[]> all_;
};

using Share = std::pair<int, double>;  ///< a vertex, and how much it counts

/// What the search for the stencils of a side keeps from one to the next.
struct SideSearch {
  SideDistances distances;
  std::vector<int> vertex, face;  ///< number of the last stencil that has reached it; minus it: the face is of another sheet
  int now = 0;                    ///< number of the stencil
  std::vector<int> reached;       ///< vertices, in their order
  std::vector<int> neighbors;     ///< of vertices, by their Around

  /// The stencil found last, at place `k`; the same is found about any normal that is nearer than `margin` to the one it was found about.
  struct Grown {
    int k = -1;
    Neighborhood near = {};
    Vec3 about;
    double margin = 0;
    std::vector<Share> used;
    bool is_of(int place, const Neighborhood& wanted, const Vec3& e3) const {
      return k == place && near.rings == wanted.rings && near.widened == wanted.widened && (e3 - about).norm() < margin;
    }
  } grown;

  /// The other vertices of the faces at a vertex, in `neighbors`, and how far the faces' unit normals are from its own at most: beyond all
  /// measure where the faces do not follow each other around it across smooth edges.
  struct Around {
    int begin = -1, end = 0;  // begin: none, nobody has asked
    double off = 0;
  };
  const Around& around(const LocalMesh& w, int v) {
    if (around_[v].begin < 0) look_around(w, v);
    return around_[v];
  }

  SideSearch(const LocalMesh& w, const std::array<SideDraft, 3>& drafts, int i)
      : distances(w, drafts, i),
        vertex(w.position.size(), 0),
        face(w.area.size(), 0),
        reached(w.position.size() + 1),
        around_(w.position.size()),
        seen_from_(w.position.size(), -1) {}

private:
  void look_around(const LocalMesh& w, int v);

  std::vector<Around> around_;
  std::vector<int> seen_from_;  ///< vertices: the last one that they were found to be next to
};

/// The heights at a rim vertex, and which vertices have them.
struct Seen {
  Stencil stencil;
  std::vector<Share> used;
};

/// One search a side.
using Searches = std::array<SideSearch, 3>;

/// The frame at vertex k of a side, over the plane guessed there, and the vertices seen from it.
void look(const LocalMesh& w, const SideDraft& side, int k, const Neighborhood& near, SideSearch& search, Seen& seen);

/// The same with the heights.
void measure(const LocalMesh& w, const SideDraft& side, int k, const Neighborhood& near, SideSearch& search, Seen& seen);

}  // namespace tripatch
