#include "tripatch/spline/disc.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "tripatch/math/thresholds.h"
#include "tripatch/math/tolerant_compare.h"
#include "tripatch/mesh/submesh.h"
#include "tripatch/triangulation/plane_triangles.h"

namespace tripatch {
namespace {

/// An outer border that is shorter than this share of the rim closes again behind the hole: no plane holds both without squeezing
/// one. At 0.7 half a ball keeps what lies next to its rim, and a limb without its end some of its length.
constexpr double min_border = share::most;
/// Rings that are taken whatever their border: their slope is what a fill has to continue.
constexpr int min_rings = count::pair;

class Growth {
public:
  Growth(const Mesh& mesh, const Connectivity& around, const std::vector<std::vector<Index>>& loops)
      : mesh_(mesh), around_(around), row_(mesh.vertices.rows()), taken_(mesh.faces.size()), seen_(mesh.vertices.rows()) {
    for (const std::vector<Index>& loop : loops)
      for (std::size_t k = 0; k < loop.size(); ++k) {
        add(loop[k], 0);
        rim_length_ += (point(loop[k]) - point(loop[(k + 1) % loop.size()])).norm();
      }
    disc_.rim = static_cast<Index>(disc_.vertices.size());
    front_ = disc_.vertices;
  }

  /// One ring more; false: there is none, or it is not wanted.
  bool grow() {
    std::vector<Index> faces;
    for (Index v : front_)
      for (Connectivity::Corner c : around_.at(v)) take(around_.face(c), faces);
    mend_pinches(faces);
    if (faces.empty()) return false;
    const std::size_t before = disc_.vertices.size();
    for (Index f : faces) {
      for (Index v : mesh_.faces[f]) {
        if (!point(v).allFinite()) return false;
        add(v, -1);
      }
    }
    const double border = border_length(faces);
    if (disc_.rings >= min_rings && clearly_less(border, min_border * rim_length_)) return false;
    for (Index f : faces) cut(mesh_.faces[f]);
    front_.assign(disc_.vertices.begin() + static_cast<std::ptrdiff_t>(before), disc_.vertices.end());
    measure(before);
    ++disc_.rings;
    return border > 0 && !front_.empty();
  }

  double reached() const {
    std::vector<double> all;
    for (Index v : front_) all.push_back(disc_.distance[row_.find(v)]);
    if (all.empty()) return 0;
    std::nth_element(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2), all.end());
    return all[all.size() / 2];
  }

  Disc finish() {
    // vertices of a ring that was not wanted have no triangle
    std::vector<Index> row(disc_.vertices.size(), -1);
    for (const std::array<Index, 3>& t : disc_.triangles)
      for (Index v : t) row[v] = 0;
    for (Index k = 0; k < disc_.rim; ++k) row[k] = 0;
    Disc out;
    out.rim = disc_.rim;
    out.rings = disc_.rings;
    for (std::size_t k = 0; k < row.size(); ++k) {
      if (row[k] < 0) continue;
      row[k] = static_cast<Index>(out.vertices.size());
      out.vertices.push_back(disc_.vertices[k]);
      out.distance.push_back(disc_.distance[k]);
      out.nearest.push_back(disc_.nearest[k]);
    }
    for (const std::array<Index, 3>& t : disc_.triangles) out.triangles.push_back({row[t[0]], row[t[1]], row[t[2]]});
    out.points.resize(static_cast<Index>(out.vertices.size()), 3);
    for (std::size_t k = 0; k < out.vertices.size(); ++k) out.points.row(static_cast<Index>(k)) = point(out.vertices[k]);
    out.faces = std::move(disc_.faces);
    for (Index& v : out.faces.corners) v = row[v];
    return out;
  }

  Index triangles() const { return static_cast<Index>(disc_.triangles.size()); }
  const Disc& disc() const { return disc_; }

private:
  Vec3 point(Index v) const { return mesh_.vertices.row(v); }

  void add(Index v, double distance) {
    if (!row_.add(v)) return;
    disc_.vertices.push_back(v);
    disc_.distance.push_back(distance);
    disc_.nearest.push_back(distance < 0 ? -1 : static_cast<Index>(disc_.nearest.size()));
  }

  void take(Index face, std::vector<Index>& faces) {
    if (taken_.add(face)) faces.push_back(face);
  }

  bool is_taken(Index face) const { return taken_.find(face) >= 0; }

  /// Where the faces taken touch at a vertex only, those between them are taken too: a border that touches itself is none of a disc.
  void mend_pinches(std::vector<Index>& faces) {
    for (std::size_t k = 0; k < faces.size(); ++k)
      for (Index v : mesh_.faces[faces[k]]) {
        if (seen_.add(v)) taken_when_seen_.push_back(0);
        // so many are taken altogether
        const std::size_t now = taken_.size();
        if (std::exchange(taken_when_seen_[seen_.find(v)], now) == now) continue;  // nothing has changed since
        const int row = row_.find(v);
        if (row >= 0 && row < disc_.rim) continue;
        const auto at = around_.at(v);
        if (std::ranges::all_of(at, [&](Connectivity::Corner c) { return is_taken(around_.face(c)); })) continue;
        int starts = 0;
        for (Connectivity::Corner c : at) {
          if (!is_taken(around_.face(c))) continue;
          // the face across the edge from v to the vertex after it
          const std::optional<Connectivity::Corner> across = around_.edge(around_.next(c), v);
          starts += !across || !is_taken(around_.face(*across));
        }
        if (starts > 1)
          for (Connectivity::Corner c : around_.at(v)) take(around_.face(c), faces);
      }
  }

  /// Of the faces taken but for the rim; `added` are those that were taken since the last time.
  double border_length(const std::vector<Index>& added) {
    for (Index f : added) {
      const auto face = mesh_.faces[f];
      for (std::size_t k = 0; k < face.size(); ++k) border_.push_back({face[k], face[(k + 1) % face.size()]});
    }
    std::erase_if(border_, [&](const std::array<Index, 2>& edge) {
      const std::optional<Connectivity::Corner> across = around_.edge(edge[1], edge[0]);
      if (across) return is_taken(around_.face(*across));
      const int i = row_.find(edge[0]), j = row_.find(edge[1]);
      return i >= 0 && i < disc_.rim && j >= 0 && j < disc_.rim;
    });
    double length = 0;
    for (const auto& [a, b] : border_) length += (point(a) - point(b)).norm();
    return length;
  }

  void cut(const IndicesRef& face) {
    const std::size_t n = face.size();
    if (n < 3) return;
    if (n == 3) {
      disc_.triangles.push_back({row_.find(face[0]), row_.find(face[1]), row_.find(face[2])});
      disc_.faces.add(disc_.triangles.back());
      return;
    }
    Points corners(static_cast<Index>(n), 3);
    for (std::size_t k = 0; k < n; ++k) corners.row(static_cast<Index>(k)) = point(face[k]).transpose();
    const Triangles triangles = triangulate_face(corners);
    const Index first = triangles.front()[0];
    bool is_fan = true;
    for (const std::array<Index, 3>& t : triangles) {
      disc_.triangles.push_back({row_.find(face[t[0]]), row_.find(face[t[1]]), row_.find(face[t[2]])});
      is_fan = is_fan && t[0] == first;
    }
    if (is_fan) {
      face_.clear();
      for (std::size_t k = 0; k < n; ++k) face_.push_back(row_.find(face[(static_cast<std::size_t>(first) + k) % n]));
      disc_.faces.add(face_);
      return;
    }
    for (auto t = disc_.triangles.end() - static_cast<std::ptrdiff_t>(triangles.size()); t != disc_.triangles.end(); ++t)
      disc_.faces.add(*t);
  }

  /// Distances of the vertices from `first` on, from those before them and among each other.
  void measure(std::size_t first) {
    for (int round = 0; round < 2; ++round)
      for (std::size_t k = first; k < disc_.vertices.size(); ++k) {
        const Index v = disc_.vertices[k];
        double best = disc_.distance[k] < 0 ? std::numeric_limits<double>::infinity() : disc_.distance[k];
        for (Connectivity::Corner c : around_.at(v))
          for (Index w : {around_.next(c), around_.previous(c)}) {
            const int row = row_.find(w);
            const bool is_looked_at = round > 0 && std::cmp_less(row, first);  // those before are as they were
            if (row < 0 || is_looked_at || disc_.distance[row] < 0 || disc_.distance[row] >= best) continue;
            const double there = disc_.distance[row] + (point(v) - point(w)).norm();
            if (there < best) best = there, disc_.nearest[k] = disc_.nearest[row];
          }
        if (std::isfinite(best)) disc_.distance[k] = best;
      }
  }

  const Mesh& mesh_;
  const Connectivity& around_;
  Numbering row_, taken_, seen_;
  std::vector<std::size_t> taken_when_seen_;  // faces, by seen_
  std::vector<Index> front_;
  std::vector<std::array<Index, 2>> border_;  // from vertex to vertex as the faces taken go
  std::vector<Index> face_;                   // of the disc, the one that is being cut
  double rim_length_ = 0;
  Disc disc_;
};

/// Distances of a disc's vertices from the rim, and of its points on edges.
Eigen::VectorXd distances(const Disc& disc) {
  return with_points_on_edges(disc, Eigen::VectorXd(Eigen::VectorXd::Map(disc.distance.data(), disc.points.rows())));
}

}  // namespace

Disc disc_around(const Mesh& mesh, const Connectivity& around, const std::vector<std::vector<Index>>& loops, double reach,
                 int max_rings, Index max_triangles) {
  Growth growth(mesh, around, loops);
  while (growth.disc().rings < max_rings && growth.triangles() < max_triangles && growth.grow())
    if (growth.disc().rings >= min_rings && !clearly_less(growth.reached(), reach)) break;
  return growth.finish();
}

Disc disc_to_sample(const Mesh& mesh, const Connectivity& around, const std::vector<std::vector<Index>>& loops, double reach,
                    int max_rings) {
  Disc disc = disc_around(mesh, around, loops, reach, max_rings);
  disc.on_edges = points_on_long_edges(disc.points, disc.faces);
  return disc;
}

std::vector<Index> spread_samples(const Disc& disc, double edge, Index more, Index most) {
  const Points points = with_points_on_edges(disc, disc.points);
  const Eigen::VectorXd distance = distances(disc);
  const Index n = points.rows();
  const Index wanted = std::min(n, std::clamp(disc.rim + more, min_samples, most));
  std::vector<Index> taken;
  const Index of_rim = std::min(disc.rim, wanted / 2);
  for (Index k = 0; k < of_rim; ++k) taken.push_back(k * disc.rim / of_rim);
  const double none = -1;
  const bool leaves_no_others = disc.rim + more_than_rim > max_samples;
  const double spacing = leaves_no_others ? edge * static_cast<double>(disc.rim) / static_cast<double>(of_rim) : edge;
  const Eigen::ArrayXd far = (distance.array() + spacing).square();
  const Eigen::ArrayX3d at = points.array();
  Eigen::ArrayXd gap = Eigen::ArrayXd::Constant(n, std::numeric_limits<double>::infinity());  // squared; none where it is taken
  for (Index k : taken) gap[k] = none;
  for (std::size_t done = 0; std::cmp_less(taken.size(), wanted);) {
    for (; done < taken.size(); ++done) {
      const auto point = points.row(taken[done]);
      gap = gap.min((at.col(0) - point[0]).square() + (at.col(1) - point[1]).square() + (at.col(2) - point[2]).square());
    }
    const Eigen::ArrayXd value = gap / far;
    Index best = -1;
    double most = none;
    for (Index k = 0; k < n; ++k)
      if (gap[k] != none && value[k] > most + tolerance::close * std::abs(most)) most = value[k], best = k;
    if (best < 0) break;
    taken.push_back(best);
    gap[best] = none;
  }
  return taken;
}

}  // namespace tripatch
