// docs/mathematics/surroundings.md has the formulas and what they reach.
#include "tripatch/boundary/mesh_sides.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "tripatch/boundary/plane_fit.h"
#include "tripatch/boundary/side_curves.h"
#include "tripatch/math/angle.h"
#include "tripatch/math/parallel.h"
#include "tripatch/math/smoothstep.h"

namespace tripatch {
namespace {

constexpr int enough_points = 50;       ///< a stencil stops growing at this size: more than twice the terms
constexpr int few_points = 8;           ///< beyond the rim: with fewer, those that do not lie in front of the side are used too
constexpr int samples_a_side = 6;       ///< about as many stencils a side tell the variance components
constexpr double flat_enough = 5e-4;    ///< slope over the guess of a plane: no second fit
constexpr double most_tilt = 0.2;       ///< slope that is handed on to the next vertex
constexpr double same_sheet = 0.5;      ///< cosine: faces turned further from the vertex's own are another sheet (a cube's edge)
constexpr double steep = 0.5;           ///< cosine: vertices turned further count for nothing,
constexpr double fully_from = 0.3;      ///< and fully from so much more on, where their heights are those of a graph
constexpr double never_nothing = 1e-6;  ///< but this, for a fit needs points
// Shares fade over a quarter of a rim edge, or of a ratio of distances, for a plane shall not jump when a vertex moves.
constexpr double beyond_end = 0.35;   ///< rim edges beyond the plane across a side's end where a share reaches 0
constexpr double nearer_other = 1.3;  ///< times as far from the side as from its neighbor: the share is 0
constexpr double fade_width = 0.25;
constexpr double never_one_plane = 60;  ///< degrees between the planes of two sides at their corner: each keeps its own;
constexpr double one_plane = 5;         ///< also from so many degrees on,
constexpr double apart = 5;             ///< where they are so many standard deviations apart
constexpr int pooled = 2;               ///< vertices to each side that are judged together
/// Logarithm of densities: what is near is predicted within a seventh. Less says nothing, for the first guess of a plane is made of the
/// nearest faces themselves: where the noise is 1% of the edges, one ring seems better by 1 to 1.6.
constexpr double by_far = 2;
constexpr double by_some = 0.5;      ///< without noise: a fifth; nothing where the other is as much less certain of its plane.
constexpr double coarse_turn = 0.3;  ///< Radians an edge: not where a side, or the faces across it, turn by more
/// Vertices to each side along the rim that a vertex is compared with.
constexpr int most_compared = 3, least_compared = 2;
/// Of the mean rim edge: a rim of a deviation of less has no noise; coarse meshes of 12 degrees an edge have 1e-3.
constexpr double noisy_rim = 3e-3;
/// Where there is none, a fit of r rings is known at best as well as noise like the rim's allows: its variance over the cube of r rows of
/// faces, times this, of 1 to 30 tried on ten surfaces with noise of 0.1 to 3% of the edges the one that left the smallest errors.
constexpr double known_by_ring = 10;
/// Nor better than this part of what the faces near it lean by, over the square of r: a row of them tells a plane, not how the surface
/// bends away.
constexpr double known_by_lean = 0.25;
constexpr double agrees = 5;  ///< standard deviations from a plane to facets that have nothing against them
/// By how much a plane is off along the rim where a side turns by x radians an edge: this times x^3, as the ends of a spline through an
/// arc are; 2.7 to 3.2 degrees on arcs of 70 to 120 degrees in two edges.
constexpr double off_by_turn = 7.5 * M_PI / 180;
constexpr int few_edges = 4;  ///< of a side; of more, fits see the turn themselves: less by the square of their number
constexpr double coplanar =
    1e-3;                   ///< degrees: what coordinates in single precision leave of faces in a plane, as files have them
constexpr double bent = 5;  ///< degrees that a side turns by at least, for its faces to tell their plane
constexpr double always_plausible =
    0.02;  ///< sine of the angle by which a plane may always lean against the faces beside it, 1 degree
constexpr double well_known =
    0.05 * M_PI / 180;          ///< deviation of a plane, less than which nobody sees: nothing else is looked at
constexpr Index long_rim = 60;  ///< edges, from which on threads are worth their start

/// What the plane at a rim vertex may be estimated from. Which one serves best differs from vertex to vertex: on a fair surface the more
/// the better, but beyond a smooth edge curvature may jump, as where a fillet ends, and no polynomial goes on there.
struct Neighborhood {
  int rings;
  bool widened;    ///< where little lies in front of the side, by what does not
  bool all_sides;  ///< the variances are those of all sides together, not of each
  bool
      scaled;  ///< lengths across the rim are in rows of faces: long strips bend little across, or their mesh would be finer there
};
constexpr std::array<Neighborhood, 5> neighborhoods = {{{most_rings, true, true, false},
                                                        {most_rings, false, false, false},
                                                        {most_rings, false, false, true},
                                                        {2, false, false, true},
                                                        {1, false, false, true}}};

/// The three sides with the curves through their vertices and the planes of the faces beside them.
std::array<SideDraft, 3> drafts_of(const LocalMesh& w, const Mesh& mesh, const Hole& hole) {
  const int n = static_cast<int>(w.rim.size());
  std::array<SideDraft, 3> drafts;
  for (int i = 0; i < 3; ++i) {
    SideDraft& side = drafts[i];
    const int from = static_cast<int>(hole.corners[(i + 1) % 3]), to = static_cast<int>(hole.corners[(i + 2) % 3]);
    const int edges = (to - from + n) % n;
    if (edges < 1) throw InvalidArgument("the three corners of a hole must be three places of its rim, in its order");
    std::vector<Vec3> face;  // area vectors beside the edges
    side.t = {0};
    for (int k = 0; k <= edges; ++k) {
      side.vertex.push_back(w.rim[(from + k) % n]);
      side.position.push_back(w.position[side.vertex.back()]);
      side.point.push_back(mesh.vertices.row(w.vertex(side.vertex.back())));
      if (k == 0) continue;
      side.length += (side.position[k] - side.position[k - 1]).norm();
      side.t.push_back(side.length);
      side.face.push_back(w.beside[(from + k - 1) % n]);
      face.push_back(w.area[side.face.back()]);
    }
    side.depth = 0;
    for (int k = 0; k < edges; ++k)  // twice the area over the edge: of triangles the depth, of quads twice the depth
      side.depth += face[k].norm() / (side.position[k + 1] - side.position[k]).squaredNorm() / edges /
                    (w.part[side.face[k]].size() > 3 ? 2 : 1);
    for (double& t : side.t) t /= side.length;
    side.t.back() = 1;
    const PiecewisePolynomial c = curve_through(side);
    for (int k = 0; k <= edges; ++k) {
      side.tangent.push_back(c.derivative_at(side.t[k]).stableNormalized());
      Vec3 sum = Vec3::Zero();
      for (int e = std::max(k - 2, 0); e < std::min(k + 2, edges); ++e) sum += face[e];
      sum -= side.tangent[k] * side.tangent[k].dot(sum);
      const Index v = w.vertex(side.vertex[k]);
      if (!(sum.norm() > 0)) throw Refusal("The faces beside vertex " + std::to_string(v) + " have no area", {v});
      side.guess.push_back(sum.normalized());
      side.faces.push_back(side.guess.back());
    }
  }
  return drafts;
}

/// How far vertices are from the vertices at the ends of a side and from those of its neighbors there, squared.
class SideDistances {
public:
  static constexpr int most = 2 * most_rings;  ///< edges of a side's end that are looked at together
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
    for (std::size_t k = 1; k < before_.size() && k <= most_rings; ++k)
      d.before = std::min(d.before, from(before_[before_.size() - 1 - k]));
    for (std::size_t k = 1; k < after_.size() && k <= most_rings; ++k) d.after = std::min(d.after, from(after_[k]));
    return d;
  }

private:
  const LocalMesh& w_;
  std::span<const int> own_, before_, after_;
  std::vector<char> known_;
  std::unique_ptr<Of[]> all_;
};

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

using Share = std::pair<int, double>;  ///< a vertex, and how much it counts

/// What the search for the stencils of a side keeps from one to the next.
struct SideSearch {
  SideDistances distances;
  std::vector<int> vertex, face;  ///< number of the last stencil that has reached it; minus it: the face is of another sheet
  int now = 0;                    ///< number of the stencil

  SideSearch(const LocalMesh& w, const std::array<SideDraft, 3>& drafts, int i)
      : distances(w, drafts, i), vertex(w.position.size(), 0), face(w.area.size(), 0) {}
};

/// The vertices of a stencil: rings around vertex k of a side, across smooth edges, on the sheet with normal e3.
std::vector<Share> grow(const LocalMesh& w, const SideDraft& side, int k, const Vec3& e3, const InFront& in_front,
                        const Neighborhood& near, SideSearch& marks) {
  std::vector<Share> used;
  std::vector<int> front, next, all;
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
  // smooth edges connect it with a face that is taken
  const auto connected = [&](int f) {
    for (int c = w.part.offsets[f]; c < w.part.offsets[f + 1]; ++c)
      if (w.across[c] >= 0 && marks.face[w.across[c]] == marks.now) return true;
    return false;
  };
  ++marks.now;
  reach(side.vertex[k]);
  front = {side.vertex[k]};
  next.clear();
  take(side.face[std::max(k - 1, 0)]);
  take(side.face[std::min(k, side.edges() - 1)]);
  for (int ring = 0; ring < near.rings && static_cast<int>(used.size()) < enough_points && !front.empty(); ++ring) {
    for (int v : front)
      for (bool more = true; more;) {
        more = false;
        for (int f : w.part.faces_at(v)) {
          if (std::abs(marks.face[f]) == marks.now) continue;
          if (!(w.area[f].dot(e3) > same_sheet * w.twice_area[f])) {
            marks.face[f] = -marks.now;
            continue;
          }
          if (!connected(f)) continue;
          take(f);
          more = true;
        }
      }
    front = std::move(next);
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
  return used;
}

/// Places, heights and weights of the stencil's vertices about p.
void set_rows(const LocalMesh& w, const std::vector<Share>& used, const Vec3& p, Stencil& s) {
  const Index size = static_cast<Index>(used.size());
  s.rows.setZero(size, 24);
  s.share.resize(size);
  s.g.resize(size);
  for (Index j = 0; j < size; ++j) {
    const Vec3 d = w.position[used[j].first] - p;
    const double y = d.dot(s.e2);
    s.set({d.dot(s.e1), y / s.depth, d.dot(s.e3)}, j);
    s.share[j] = used[j].second;
    const double square = s.depth == 1 ? d.squaredNorm() : d.squaredNorm() + y * y * (1 / (s.depth * s.depth) - 1);
    s.g[j] = square * square * square * square * square * square;
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

/// The heights at a rim vertex, and which vertices have them.
struct Seen {
  Stencil stencil;
  std::vector<Share> used;
};

/// The frame at vertex k of side i, over the plane guessed there, and the vertices seen from it.
Seen look(const LocalMesh& w, const std::array<SideDraft, 3>& drafts, int i, int k, const Neighborhood& near,
          SideSearch& search) {
  Seen seen;
  Stencil& s = seen.stencil;
  const SideDraft& side = drafts[i];
  s.e1 = side.tangent[k];
  s.e3 = (side.guess[k] - s.e1 * s.e1.dot(side.guess[k])).normalized();
  s.e2 = s.e1.cross(s.e3);
  if (near.scaled) s.depth = side.depth;
  seen.used = grow(w, side, k, s.e3, InFront(w, drafts, i, k, search.distances), near, search);
  // Where the surface has turned far away, its height over this plane is no polynomial any more.
  for (auto& [v, share] : seen.used) {
    const Vec3& n = w.area_at[v];
    const double length = n.norm();
    if (length > 0) share *= std::max(smoothstep((n.dot(s.e3) / length - steep) / fully_from), never_nothing);
  }
  return seen;
}

/// The same with the heights.
Seen measure(const LocalMesh& w, const std::array<SideDraft, 3>& drafts, int i, int k, const Neighborhood& near,
             SideSearch& search) {
  Seen seen = look(w, drafts, i, k, near, search);
  set_rows(w, seen.used, drafts[i].position[k], seen.stencil);
  set_slopes(w, drafts[i], k, seen.stencil);
  return seen;
}

/// One search a side.
using Searches = std::array<SideSearch, 3>;

VarianceComponents components_of(const LocalMesh& w, const std::array<SideDraft, 3>& drafts, const Neighborhood& near, int only,
                                 Searches& searches) {
  std::array<std::vector<Stencil>, 3> samples;
  for (int i = 0; i < 3; ++i) {
    if (only >= 0 && i != only) continue;
    const int n = static_cast<int>(drafts[i].vertex.size()), step = std::max(1, n / ((only < 0 ? 1 : 3) * samples_a_side));
    for (int k = 0; k < n; k += step) samples[i].push_back(measure(w, drafts, i, k, near, searches[i]).stencil);
  }
  double radius = 0, points = 0;
  for (const std::vector<Stencil>& side : samples)
    for (const Stencil& s : side) {
      radius += s.g.array().pow(1.0 / (2 * fit_degree + 2)).sum();
      points += static_cast<double>(s.g.size());
    }
  // the squared curvature that the faces beside the rim show, to start with
  double bend = 0;
  const int n = static_cast<int>(w.rim.size());
  for (int k = 0; k < n; ++k) {
    const Vec3 a = w.area[w.beside[k]].normalized(), b = w.area[w.beside[(k + 1) % n]].normalized();
    bend += (a - b).squaredNorm() / n;
  }
  return estimate_components(samples, radius / points, bend);
}

/// The plane at a rim vertex.
struct VertexFit {
  Vec3 normal;
  Eigen::Matrix3d second;       ///< fundamental form
  Eigen::Matrix3d information;  ///< of the normal
  double slope_variances;       ///< their sum
  double bend_variance;         ///< of the second derivative across
  std::vector<double> density;  ///< logarithms, of what is predicted for each of the vertices nearest to it without itself
};

/// The heights nearest to a rim vertex, which every neighborhood has to explain.
std::vector<double> densities(const LocalMesh& w, const SideDraft& side, int k, const std::vector<Share>& nearest,
                              const Seen& seen, const PlaneFit& fit, const VarianceComponents& components) {
  std::vector<double> all;
  const Stencil& s = seen.stencil;
  for (const auto& [v, counts] : nearest) {
    if (v == side.vertex[k]) continue;
    const Vec3 d = w.position[v] - side.position[k];
    const auto place = std::find_if(seen.used.begin(), seen.used.end(), [v = v](const Share& u) { return u.first == v; });
    all.push_back(counts * predicted_density(fit, components, {d.dot(s.e1), d.dot(s.e2) / s.depth, d.dot(s.e3)},
                                             place == seen.used.end() ? 0 : place->second));
  }
  return all;
}

/// The planes and second fundamental forms of side i, as one neighborhood has them.
std::vector<VertexFit> fit_side(const LocalMesh& w, const VarianceComponents& components, std::array<SideDraft, 3> drafts, int i,
                                const Neighborhood& near, const std::vector<std::vector<Share>>& nearest, SideSearch& search) {
  SideDraft& side = drafts[i];
  std::vector<VertexFit> result;
  const int edges = side.edges();
  double tilt = 0;  // of the plane found last against the faces beside the rim: most likely that of the next one too
  for (int k = 0; k <= edges; ++k) {
    const Vec3 faces = side.guess[k], outward = side.tangent[k].cross(faces);
    side.guess[k] -= tilt * outward;
    Seen seen = measure(w, drafts, i, k, near, search);
    PlaneFit fit = fit_plane(seen.stencil, components);
    if (std::abs(fit.mean[2]) > flat_enough * seen.stencil.depth) {  // once more over the plane just found
      side.guess[k] = seen.stencil.e3 - fit.mean[2] / seen.stencil.depth * seen.stencil.e2;
      seen = measure(w, drafts, i, k, near, search);
      fit = fit_plane(seen.stencil, components);
    }
    const Stencil& s = seen.stencil;
    const Eigen::Vector2d over(1, 1 / s.depth);  // by what derivatives along and across are multiplied
    const double fx = fit.mean[1], fy = fit.mean[2] / s.depth;
    VertexFit at;
    at.normal = (s.e3 - fx * s.e1 - fy * s.e2).normalized();
    tilt = std::clamp(-at.normal.dot(outward) / at.normal.dot(faces), -most_tilt, most_tilt);
    Eigen::Matrix<double, 3, 2> frame;
    frame << s.e1, s.e2;
    Eigen::Matrix2d hessian;
    hessian << fit.mean[3], fit.mean[4], fit.mean[4], fit.mean[5];
    hessian = over.asDiagonal() * hessian * over.asDiagonal();
    at.second = frame * (hessian / std::sqrt(1 + fx * fx + fy * fy)) * frame.transpose();
    Eigen::Matrix<double, fit_terms, 3> columns;  // of the covariance: the two slopes, the second derivative across
    columns << PlaneFit::Column::Unit(1), PlaneFit::Column::Unit(2), PlaneFit::Column::Unit(5);
    fit.lower.triangularView<Eigen::Lower>().solveInPlace(columns);
    fit.lower.triangularView<Eigen::Lower>().transpose().solveInPlace(columns);
    const Eigen::Matrix2d covariance = over.asDiagonal() * columns.block<2, 2>(1, 0) * over.asDiagonal();
    at.slope_variances = covariance.trace();
    at.bend_variance = columns(5, 2) * std::pow(over[1], 4);
    at.information = frame * covariance.inverse() * frame.transpose();
    at.density = densities(w, side, k, nearest[k], seen, fit, components);
    result.push_back(std::move(at));
  }
  return result;
}

/// The vertices of side i that are nearest to each: in the faces at it, in front of the side.
std::vector<std::vector<Share>> nearest_of(const LocalMesh& w, const std::array<SideDraft, 3>& drafts, int i,
                                           SideSearch& search) {
  std::vector<std::vector<Share>> nearest;
  for (int k = 0; k <= drafts[i].edges(); ++k) nearest.push_back(look(w, drafts, i, k, {1, false, false, false}, search).used);
  return nearest;
}

/// What one side's fits tell besides its planes.
struct SideFit {
  std::array<VertexFit, 2> ends;
  double slope_variances = 0;  ///< their sum
  double bend_variance = 0;    ///< of the second derivative across, mean over the side
};

/// By how much the logarithm of the density of what is near vertex k of a side is higher by one fit than by another, for a vertex. Along
/// the side neighbors are judged together, for a single vertex says little.
double lead_of(const std::vector<VertexFit>& fit, const std::vector<VertexFit>& other, int k) {
  double sum = 0, count = 0;
  const int last = static_cast<int>(fit.size()) - 1;
  for (int j = std::max(k - pooled, 0); j <= std::min(k + pooled, last); ++j)
    for (std::size_t p = 0; p < fit[j].density.size(); ++p, ++count) sum += fit[j].density[p] - other[j].density[p];
  return count > 0 ? sum / count : 0;
}

/// Whether nothing is to be won by looking at less.
bool are_known(const std::vector<VertexFit>& fits) {
  return std::all_of(fits.begin(), fits.end(), [](const VertexFit& f) { return f.slope_variances < well_known * well_known; });
}

/// Whether the faces beside a side lie in one plane, in which the side bends: then they are that plane, whatever lies behind them. Beside
/// a straight side they may be a strip of any surface.
bool lies_in_plane(const LocalMesh& w, const SideDraft& side) {
  const Vec3 n = w.area[side.face[0]];
  for (int f : side.face)
    if (degrees_between(w.area[f], n) > coplanar) return false;
  double turned = 0;
  for (const Vec3& t : side.tangent) turned = std::max(turned, degrees_between(t, side.tangent[0]));
  return turned > bent;
}

/// The plane of such faces.
VertexFit plane_of(const LocalMesh& w, const SideDraft& side) {
  VertexFit fit;
  fit.normal = w.area[side.face[0]].normalized();
  fit.second.setZero();
  fit.slope_variances = std::pow(coplanar * M_PI / 180, 2);
  fit.bend_variance = 0;
  fit.information = Eigen::Matrix3d::Identity() / fit.slope_variances;
  return fit;
}

/// Sine of the angle by which a normal leans over a side's vertex, outwards or inwards, against the faces beside it.
double lean(const SideDraft& side, int k, const Vec3& normal) {
  return std::abs(normal.dot(side.tangent[k].cross(side.faces[k]))) / normal.norm();
}

/// By how much a plane at vertex k of a side may lean: twice as much as the faces beside the rim there and those within two steps from
/// them do. Where rings of faces see nothing but what lies far off, as in a plane that is meshed with long triangles, fits may lean
/// by anything.
double most_lean(const LocalMesh& w, const SideDraft& side, int k) {
  std::vector<int> near;
  for (int e = std::max(k - pooled, 0); e < std::min(k + pooled, side.edges()); ++e) near.push_back(side.face[e]);
  for (std::size_t at = 0, step = 0, end = near.size(); step < 2; ++step, end = near.size())
    for (; at < end; ++at)
      for (int c = w.part.offsets[near[at]]; c < w.part.offsets[near[at] + 1]; ++c)
        if (w.across[c] >= 0 && std::find(near.begin(), near.end(), w.across[c]) == near.end()) near.push_back(w.across[c]);
  double most = 0;
  for (int f : near)
    if (w.area[f].dot(side.faces[k]) > same_sheet * w.area[f].norm()) most = std::max(most, lean(side, k, w.area[f]));
  return always_plausible + 2 * most;
}

/// Variance of a side's vertices, by what each differs from its next neighbors along the side, up to three to each side of it,
/// interpolated. It is that of noise: what a smooth curve of edges that turn by x leaves is an edge times x^3 to x^5. Nothing where the
/// side is too short to tell.
std::optional<double> roughness(const SideDraft& side) {
  const int last = side.edges(), reach = std::min(last / 2, most_compared);
  if (reach < least_compared) return {};
  double sum = 0;
  for (int k = reach; k <= last - reach; ++k) {
    Vec3 off = side.position[k];
    double squares = 1;
    for (int j = k - reach; j <= k + reach; ++j) {
      if (j == k) continue;
      double weight = 1;  // Lagrange's
      for (int i = k - reach; i <= k + reach; ++i)
        if (i != j && i != k) weight *= (side.t[k] - side.t[i]) / (side.t[j] - side.t[i]);
      off -= weight * side.position[j];
      squares += weight * weight;
    }
    off -= side.tangent[k] * side.tangent[k].dot(off);
    sum += off.squaredNorm() / (2 * squares);
  }
  return sum / (last - 2 * reach + 1);
}

/// That of the smoothest side, for a mesh has one noise, but corners may lie within a side: 0 where all are short.
double roughness(const std::array<SideDraft, 3>& drafts) {
  std::optional<double> least;
  for (const SideDraft& side : drafts)
    if (const std::optional<double> own = roughness(side)) least = std::min(*own, least.value_or(*own));
  return least.value_or(0);
}

/// The mean of the normals of the faces at vertex k of a side, by their angles there.
Vec3 mean_of_facets(const LocalMesh& w, const SideDraft& side, int k) {
  const int v = side.vertex[k];
  Vec3 sum = Vec3::Zero();
  for (int f : w.part.faces_at(v)) {
    const std::span<const int> face = w.part[f];
    const std::size_t size = face.size(), c = std::find(face.begin(), face.end(), v) - face.begin();
    const Vec3 a = w.position[face[(c + 1) % size]] - w.position[v], b = w.position[face[(c + size - 1) % size]] - w.position[v];
    if (w.area[f].norm() > 0) sum += angle_between(a, b) * w.area[f].normalized();
  }
  return sum;
}

/// Radians by which a side turns about an inner vertex, out of its faces.
double turn_at(const SideDraft& side, int k) {
  const Vec3 before = (side.position[k] - side.position[k - 1]).normalized(),
             after = (side.position[k + 1] - side.position[k]).normalized();
  return std::abs((after - before).dot(side.faces[k]));
}

/// Whether a side turns by so much that polynomials of its heights say little.
bool turns_coarsely(const SideDraft& side) {
  double squares = 0;
  for (int k = 1; k < side.edges(); ++k) squares += std::pow(turn_at(side, k), 2);
  return squares > coarse_turn * coarse_turn * (side.edges() - 1);
}

/// The variance of a side's planes that is due to how far it turns from edge to edge, which no fit sees: few points on an arc look like
/// those of a parabola. A side of one edge tells nothing of how it bends: what its planes differ by from the facets' mean.
double turn_variance(const LocalMesh& w, const SideDraft& side) {
  const int edges = side.edges();
  double sum = 0;
  if (edges == 1) {
    for (int k : {0, 1}) {
      const double differs = angle_between(mean_of_facets(w, side, k), side.normal[k]);
      sum += differs * differs / 2;
    }
    return sum;
  }
  for (int k = 1; k < edges; ++k) sum += std::pow(turn_at(side, k), 6) / (edges - 1);
  return sum * std::pow(off_by_turn * std::min(1.0, std::pow(double(few_edges) / edges, 2)), 2);
}

/// The facets' means at the inner vertices of a side, if each is as near to the plane taken there as that is known: then there is
/// nothing against them, and beside strips of equal facets, as of cylinders and fillets, they are exact.
std::vector<Vec3> facets_that_agree(const LocalMesh& w, const SideDraft& side, const std::vector<double>& variance) {
  std::vector<Vec3> means;
  for (int k = 1; k < side.edges(); ++k) {
    const Vec3 mean = mean_of_facets(w, side, k).stableNormalized();
    const double differs = (mean - side.normal[k]).norm();
    if (!(differs <= always_plausible && differs <= agrees * std::sqrt(variance[k]))) return {};
    means.push_back(mean);
  }
  return means;
}

/// The fits at each vertex of a side that are taken, of those by neighborhood, largest first: a smaller one where it predicts what is near
/// better, the more so the less certain it is of its plane, or where the larger one is not plausible. rough: variance of the rim's vertices.
SideFit choose(const LocalMesh& w, const std::vector<std::vector<VertexFit>>& fits, SideDraft& side, double rough) {
  SideFit result;
  const int edges = side.edges();
  const bool is_plane = fits.size() > 1 && lies_in_plane(w, side);  // a single fit knows it by itself
  const std::optional<VertexFit> plane = is_plane ? std::optional(plane_of(w, side)) : std::nullopt;
  const bool noisy = rough > noisy_rim * noisy_rim, coarse = turns_coarsely(side);
  std::vector<double> variances;  // of the planes taken
  for (int k = 0; k <= edges; ++k) {
    std::size_t best = 0;
    const double most = most_lean(w, side, k);
    const bool doubtful = noisy || coarse || most > 2 * coarse_turn;
    const auto variance = [&](std::size_t f) {
      const double by_noise = known_by_ring * rough / (side.depth * side.depth * std::pow(neighborhoods[f].rings, 3));
      return std::max(fits[f][k].slope_variances, by_noise);
    };
    const auto doubt = [&](std::size_t f) {
      const double by_lean = known_by_lean * 0.5 * (most - always_plausible) / std::pow(neighborhoods[f].rings, 2);
      return std::max(variance(f), by_lean * by_lean);
    };
    const auto leans = [&](std::size_t f) {  // or may
      return std::max(lean(side, k, fits[f][k].normal), std::sqrt(fits[f][k].slope_variances));
    };
    for (std::size_t f = 1; f < fits.size(); ++f) {
      if (leans(best) > most && leans(f) < leans(best)) {
        best = f;
        continue;
      }
      if (leans(f) > most) continue;
      const double less_certain = std::max(0.5 * std::log(doubt(f) / doubt(best)), doubtful ? 0 : -by_some);
      if (lead_of(fits[f], fits[best], k) > (doubtful ? by_far : by_some) + less_certain) best = f;
    }
    const VertexFit& fit = plane ? *plane : fits[best][k];
    side.normal.push_back(fit.normal);
    side.second.push_back(fit.second);
    variances.push_back(plane ? fit.slope_variances : variance(best));
    result.slope_variances += variances.back();
    result.bend_variance += fit.bend_variance / (edges + 1);
    if (k == 0 || k == edges) result.ends[k == 0 ? 0 : 1] = fit;
  }
  if (!plane) {
    const double turned = turn_variance(w, side);
    for (double& variance : variances) variance += turned;
    result.slope_variances += static_cast<double>(variances.size()) * turned;
  }
  if (!noisy && !plane) {
    const std::vector<Vec3> means = facets_that_agree(w, side, variances);
    std::copy(means.begin(), means.end(), side.normal.begin() + 1);
  }
  return result;
}

/// Corners: one plane, the average weighted by information, unless the two are far apart, also by what they know of themselves (a
/// cube), or one of the sides is not continued.
void settle_corners(const std::array<SideFit, 3>& fits, const std::array<bool, 3>& alone, std::array<SideDraft, 3>& drafts) {
  for (int corner = 0; corner < 3; ++corner) {
    const int in = (corner + 1) % 3, out = (corner + 2) % 3;
    if (alone[in] || alone[out]) continue;
    const VertexFit &a = fits[in].ends[1], &b = fits[out].ends[0];
    const double degrees = degrees_between(a.normal, b.normal);
    if (degrees > never_one_plane) continue;
    const Vec3 mean = (a.normal + b.normal).normalized();
    Eigen::Matrix<double, 3, 2> across;
    across.col(0) = mean.unitOrthogonal();
    across.col(1) = mean.cross(across.col(0));
    const Eigen::Matrix2d ia = across.transpose() * a.information * across, ib = across.transpose() * b.information * across;
    const Eigen::Vector2d x = across.transpose() * a.normal, y = across.transpose() * b.normal, d = x - y;
    const Eigen::Matrix2d weight = (ia + ib).inverse();
    const double deviations = std::sqrt(d.dot(ia * weight * ib * d));  // of x - y, whose variance is ia^-1 + ib^-1
    if (degrees > one_plane && deviations > apart) continue;
    const Vec3 n = (mean + across * (weight * (ia * x + ib * y))).normalized();
    drafts[in].normal.back() = n;
    drafts[out].normal.front() = n;
  }
}

}  // namespace

MeshSides mesh_sides(const Mesh& mesh, const Connectivity& around, const Hole& hole) {
  const LocalMesh w = local_mesh(mesh, around, hole);
  const Index rim_size = static_cast<Index>(w.rim.size());
  std::array<SideDraft, 3> drafts = drafts_of(w, mesh, hole);
  Searches searches = {SideSearch(w, drafts, 0), SideSearch(w, drafts, 1), SideSearch(w, drafts, 2)};
  const VarianceComponents components = components_of(w, drafts, neighborhoods[0], -1, searches);
  const std::array<SideDraft, 3> guessed = drafts;  // what all threads read, while each completes its own side of the drafts
  std::array<SideFit, 3> fits;
  const double rough = roughness(guessed);
  parallel_for(0, 3, rim_size < long_rim ? 3 : 1, [&](Index from, Index to) {
    for (Index i = from; i < to; ++i) {
      const std::vector<std::vector<Share>> nearest = nearest_of(w, guessed, static_cast<int>(i), searches[i]);
      std::vector<std::vector<VertexFit>> by_neighborhood;
      for (const Neighborhood& near : neighborhoods) {
        if (!by_neighborhood.empty() && are_known(by_neighborhood[0])) break;
        const VarianceComponents own =
            near.all_sides ? components : components_of(w, guessed, near, static_cast<int>(i), searches);
        by_neighborhood.push_back(fit_side(w, own, guessed, static_cast<int>(i), near, nearest, searches[i]));
      }
      fits[i] = choose(w, by_neighborhood, drafts[i], rough);
    }
  });
  MeshSides result;
  const auto error = [](double variances, double vertices) {
    return vertices > 0 ? std::atan(std::sqrt(variances / vertices)) * 180 / M_PI : 0;
  };
  double variances = 0, vertices = 0;
  for (int i = 0; i < 3; ++i) {
    if (hole.alone[i]) continue;
    variances += fits[i].slope_variances;
    vertices += static_cast<double>(drafts[i].vertex.size());
    result.side_error[i] = error(fits[i].slope_variances, static_cast<double>(drafts[i].vertex.size()));
  }
  result.surroundings_error = error(variances, vertices);
  settle_corners(fits, hole.alone, drafts);
  result.sides = side_curves(drafts, w.scale, components.noise);
  for (int i = 0; i < 3; ++i) {
    result.sides[i].curvature_error = std::sqrt(fits[i].bend_variance) / w.scale;
    result.parameters[i] = drafts[i].t;
  }
  return result;
}

MeshSides mesh_sides(const Mesh& mesh, const Hole& hole, const std::vector<Index>& replaced) {
  return mesh_sides(mesh, Connectivity::around(mesh, hole.rim, most_rings, replaced), hole);
}

}  // namespace tripatch
