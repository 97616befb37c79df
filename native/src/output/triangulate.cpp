// Two ways. Equal counts and a well-behaved patch: the regular grid. Otherwise: isotropic remeshing with a size field (Botsch and
// Kobbelt 2004, "A remeshing approach to multiresolution modeling"; size-weighted smoothing as in Dunyach et al. 2013, "Adaptive
// remeshing for real-time mesh deformation") that starts from the one triangle of the corners and works in the parameter triangle with
// lengths, angles and sizes measured in space.
// Every step (split, flip, collapse, move) keeps every triangle positively oriented in the parameter triangle, so the result is a
// triangulation of it, hence watertight and manifold, whatever the patch does in space.
#include "tripatch/output/triangulate.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "tripatch/math/canonical_start.h"
#include "tripatch/math/interruption.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/math/tolerant_compare.h"
#include "tripatch/math/triangular_grid.h"
#include "tripatch/output/domain_mesh.h"
#include "tripatch/output/regular_grid.h"

namespace tripatch {
namespace {

using Parameters = std::array<std::vector<double>, 3>;

constexpr Index largest_regular = count::quadratic;  // edges per side

void check(const Parameters& parameters) {
  for (const auto& t : parameters) {
    bool good = t.size() >= 2 && t.front() == 0 && t.back() == 1;
    for (std::size_t k = 1; good && k < t.size(); ++k) good = t[k] > t[k - 1];
    if (!good) throw InvalidArgument("the parameters of a side must increase from 0 to 1");
  }
}

/// Barycentric coordinates of the rim from corner 0 on.
Points rim_coordinates(const Parameters& parameters) {
  Index n = 0;
  for (const auto& t : parameters) n += static_cast<Index>(t.size()) - 1;
  Points b = Points::Zero(n, 3);
  Index row = 0;
  for (int side : {2, 0, 1})
    for (std::size_t k = 0; k + 1 < parameters[side].size(); ++k, ++row) {
      b(row, (side + 1) % 3) = 1 - parameters[side][k];
      b(row, (side + 2) % 3) = parameters[side][k];
    }
  return b;
}

class Remesher final : DomainMesh {
public:
  Remesher(const Parameters& parameters, const Points& rim, std::optional<int> resolution, const Surface& patch)
      : DomainMesh(static_cast<int>(rim.rows())), patch_(patch), parameters_(parameters), inner_(resolution != 1) {
    const Points x = patch.positions(rim);
    for (Index k = 0; k < rim.rows(); ++k) add_vertex(rim.row(k), x.row(k));
    set_lowest();
    int start = 0;
    for (int side : {2, 0, 1}) {
      corner_[(side + 1) % 3] = start;
      start += static_cast<int>(parameters[side].size()) - 1;
    }
    set_sizes(resolution);
    for (int k = 0; k < 3; ++k) triangle_of_[corner_[k]] = 0;
    if (rim_ > 3 || resolution.value_or(1) == 1) {
      triangles_.push_back({{corner_[0], corner_[1], corner_[2]}, {-1, -1, -1}});
      return;
    }
    // One triangle of three rim edges has no edge to split: begin with a triangle inside.
    std::vector<Vec3> inside(3, Vec3::Constant(1.0 / 5));
    for (int k = 0; k < 3; ++k) inside[k][k] = 3.0 / 5;
    const Points y = positions(inside);
    for (int k = 0; k < 3; ++k) add_vertex(inside[k], y.row(k));
    triangles_.push_back({{3, 4, 5}, {4, 6, 2}});
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      triangles_.push_back({{k, next, 3 + k}, {2 + 2 * k, 2 + 2 * ((k + 2) % 3), -1}});
      triangles_.push_back({{3 + k, next, 3 + next}, {1 + 2 * next, 0, 1 + 2 * k}});
      triangle_of_[k] = 1 + 2 * k;
      triangle_of_[3 + k] = 0;
    }
  }

  TriangleMesh run() {
    remesh();
    if (take_lattices_out()) remesh();
    add_lattices();
    return result();
  }

private:
  void remesh() {
    int nearly_done = 0;
    for (int pass = 0; pass < 200; ++pass) {
      limit_sizes();
      const bool rim_done = rim_complete();
      const std::size_t splits = split();
      flip_all();
      if (inner_ && rim_done) {
        collapse_short();
        flip_all();
      }
      if (inner_) smooth(false);
      if (rim_done && splits == 0) break;
      if (rim_done && 30 * splits < triangles_.size() && ++nearly_done > 1) break;
    }
    if (inner_)
      for (int pass = 0; pass < 3; ++pass) {
        flip_all();
        smooth(true);
      }
    flip_all();
  }

  int add_vertex(const Vec3& b, const Vec3& x) override {
    side_.push_back(static_cast<std::uint8_t>((b[0] == 0) | (b[1] == 0) << 1 | (b[2] == 0) << 2));
    return DomainMesh::add_vertex(b, x);
  }
  /// Positively oriented beyond doubt: rim vertices of one side are exactly on one line; else above the rounding of the area.
  bool valid(int a, int b, int c) const override { return !(side_[a] & side_[b] & side_[c]) && positive(b_[a], b_[b], b_[c]); }

  // ---- sizes

  /// Length wanted for edges at b: what the sides have at the feet of the rays from the opposite corners, mixed geometrically
  /// with weights that keep each side's own on it.
  double wanted(const Vec3& b) const override {
    double sum = 0, weights = 0;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      const double w = b[j] * b[k];
      if (!(w > 0)) continue;
      const double t = b[k] / (b[j] + b[k]);
      const auto& breaks = parameters_[i];
      const auto at = std::clamp<std::ptrdiff_t>(std::upper_bound(breaks.begin(), breaks.end(), t) - breaks.begin(), 1,
                                                 static_cast<std::ptrdiff_t>(breaks.size()) - 1);
      const double f = (t - breaks[at - 1]) / (breaks[at] - breaks[at - 1]);
      sum += w * ((1 - f) * log_size_[i][at - 1] + f * log_size_[i][at]);
      weights += w;
    }
    return coarser_ * std::exp(sum / weights);
  }

  void set_sizes(std::optional<int> resolution) {
    std::vector<double> edge(rim_);
    for (int k = 0; k < rim_; ++k) edge[k] = length(k, (k + 1) % rim_);
    for (int k = 0; k < rim_; ++k) size_[k] = 0.5 * (edge[k] + edge[(k + rim_ - 1) % rim_]);
    for (int side = 0; side < 3; ++side) {
      const int start = corner_[(side + 1) % 3], n = static_cast<int>(parameters_[side].size()) - 1;
      const double all = std::accumulate(edge.begin() + start, edge.begin() + start + n, 0.0);
      for (int k = 0; k <= n; ++k) {
        const double before = edge[start + std::max(k - 1, 0)], after = edge[start + std::min(k, n - 1)];
        const double size = resolution ? all / *resolution : 0.5 * (before + after);
        log_size_[side].push_back(std::log(std::max(size, tolerance::tiny)));
      }
    }
    if (resolution) {  // a coarse rim must not use up the room that a finer inside needs
      const double room =
          std::accumulate(edge.begin(), edge.end(), 0.0) / (6 * std::sqrt(3.0));  // radius of an equal hole's incircle
      decline_ = std::max(decline_, 2 * *std::max_element(edge.begin(), edge.end()) / std::max(room, tolerance::tiny));
    }
    bound_triangles(triangles_wanted(), rim_, resolution);
  }

  /// How many triangles of the wanted sizes cover the surface.
  double triangles_wanted() const {
    constexpr int rows = count::many_places;  // of a grid over the patch, a choice
    constexpr TriangularGrid grid = {rows};
    const Points b = grid.barycentric();
    const Points x = patch_.positions(b);
    double count = 0;
    for (int q = 0; q < rows; ++q)
      for (int p = 0; p + q < rows; ++p)
        for (int half = 0; half < (p + q + 1 < rows ? 2 : 1); ++half) {
          const Index i = half ? grid.at(p + 1, q + 1) : grid.at(p, q), j = grid.at(p + 1, q), k = grid.at(p, q + 1);
          const double twice = Vec3(x.row(j) - x.row(i)).cross(Vec3(x.row(k) - x.row(i))).norm();
          const double h = wanted((b.row(i) + b.row(j) + b.row(k)) / 3);
          count += twice / 2 / (area_of_triangle * h * h);
        }
    return count;
  }

  // ---- the rim

  int rim_vertices_between(int from, int to) const { return (to > from ? to : to + rim_) - from - 1; }
  bool rim_is_complete(int from, int to) const override { return rim_vertices_between(from, to) == 0; }
  bool rim_complete() const {
    for (const Triangle& f : triangles_)
      for (int k = 0; k < 3; ++k)
        if (f.v[0] >= 0 && f.n[k] == at_rim && rim_vertices_between(f.v[(k + 1) % 3], f.v[(k + 2) % 3])) return false;
    return true;
  }
  /// The rim vertex between two that is nearest to the middle of the chord's parameters.
  int middle_of_rim(int from, int to) const {
    const int last = to > from ? to : rim_;
    const Vec3 a = b_[from], e = b_[to] - a;
    int low = from + 1, high = last - 1;
    while (low < high) {
      const int mid = (low + high) / 2;
      if (clearly_less((b_[mid] - a).dot(e), 0.5 * e.squaredNorm()))
        low = mid + 1;
      else
        high = mid;
    }
    if (low > from + 1 && !clearly_less((b_[low] - a).dot(e) + (b_[low - 1] - a).dot(e), e.squaredNorm()))
      --low;  // the first of two
    return low;
  }

  /// One round of splits, no triangle twice, the longest for its size first: rim edges that still miss vertices, then inner edges.
  std::size_t split() {
    std::vector<Edge> edges;
    // Where the surface is torn or folds, edges stay too long however often they are split.
    double room = most_ - static_cast<double>(alive_triangles());
    const bool inner = inner_ && room > 0;
    for (int t = 0; t < static_cast<int>(triangles_.size()); ++t) {
      const Triangle& f = triangles_[t];
      if (f.v[0] < 0) continue;
      for (int k = 0; k < 3; ++k) {
        const int a = f.v[(k + 1) % 3], b = f.v[(k + 2) % 3];
        if (f.n[k] == at_rim) {
          const int between = rim_vertices_between(a, b);
          if (between) edges.push_back({t, k, coarse(between + 1)});
        } else if (inner && t < f.n[k]) {
          const double key = sorted_by(length(a, b) / (too_long * size_of_edge(a, b)));
          if (key > 1) edges.push_back({t, k, key});
        }
      }
    }
    std::stable_sort(edges.begin(), edges.end(), [](const Edge& p, const Edge& q) {
      check_interruption();
      return p.excess > q.excess;
    });
    std::vector<char> taken(triangles_.size(), 0);
    std::vector<Edge> chosen;
    std::vector<Vec3> middles;
    for (const Edge& e : edges) {
      const Triangle& f = triangles_[e.triangle];
      const int other = f.n[e.k];
      if (taken[e.triangle] || (other >= 0 && taken[other])) continue;
      const int a = f.v[(e.k + 1) % 3], b = f.v[(e.k + 2) % 3];
      if (other >= 0) {
        const Vec3 m = 0.5 * (b_[a] + b_[b]);
        if (room < 2 || !can_split(e.triangle, e.k, m)) continue;
        room -= 2;
        middles.push_back(m);
        taken[other] = 1;
      }
      taken[e.triangle] = 1;
      chosen.push_back(e);
    }
    const Points x = positions(middles);
    Index row = 0;
    for (const Edge& e : chosen) {
      const Triangle& f = triangles_[e.triangle];
      const int a = f.v[(e.k + 1) % 3], b = f.v[(e.k + 2) % 3];
      int m;
      if (f.n[e.k] < 0) {
        m = middle_of_rim(a, b);
      } else {
        m = add_vertex(middles[row], x.row(row));
        size_[m] = std::min(wanted(middles[row]), size_of_edge(a, b) + growth * length(a, b) / 2);
        ++row;
      }
      split_edge(e.triangle, e.k, m);
    }
    return chosen.size();
  }

  /// How good the two triangles of a quad (a, b, c, d) split along a-c are; negative where they fold over in space.
  double pair_quality(int a, int b, int c, int d) const {
    const Vec3 e = x_[c] - x_[a], u = x_[b] - x_[a], w = x_[d] - x_[a];
    if (face_away({u, e}, {e, w})) return u.cross(e).stableNormalized().dot(e.cross(w).stableNormalized());
    return std::min(shape_of(a, b, c), shape_of(a, c, d));
  }

  /// Flips make the worse of the two triangles better.
  bool wants_flip(int a, int b, int c, int d) const override { return pair_quality(c, a, d, b) > pair_quality(a, d, b, c) + tie; }

  /// Moves inner vertices to the size-weighted center of the triangles around, the move taken back to the parameter triangle by
  /// the local Jacobian. careful: only where the worst triangle around gets better.
  void smooth(bool careful) {
    std::vector<int> who;
    std::vector<Vec3> where;
    for (int v = rim_; v < static_cast<int>(b_.size()); ++v) {
      if (triangle_of_[v] < 0 || is_fixed(v)) continue;
      const std::optional<Way> way = way_of(v);
      if (!way) continue;
      Vec2 step = way->step;
      for (int attempt = 0; attempt < 4; ++attempt, step *= 0.5) {
        const Vec3 b = moved(b_[v], step);
        if (b.minCoeff() <= 0 || !star_is_valid(v, b)) continue;
        who.push_back(v);
        where.push_back(b);
        break;
      }
    }
    const Points x = positions(where);
    for (std::size_t i = 0; i < who.size(); ++i) {
      const int v = who[i];
      if (!star_is_valid(v, where[i])) continue;  // a neighbor has moved meanwhile
      const double before = star_quality(v, x_[v]), after = star_quality(v, x.row(i));
      if ((careful || after < good_enough) && !clearly_more(after, before)) continue;
      b_[v] = where[i];
      x_[v] = x.row(i);
    }
    look_at_all();
  }
  static Vec3 moved(const Vec3& b, const Vec2& step) {
    const double b1 = b[1] + step[0], b2 = b[2] + step[1];
    return {1 - b1 - b2, b1, b2};
  }

  Points positions(const std::vector<Vec3>& b) const override {
    if (b.empty()) return Points(0, 3);
    return patch_.positions(Eigen::Map<const Points>(b.front().data(), static_cast<Index>(b.size()), 3));
  }

  TriangleMesh result() const {
    TriangleMesh mesh;
    mesh.rim = rim_;
    std::vector<Index> number(b_.size(), -1);
    Index count = 0;
    for (std::size_t v = 0; v < b_.size(); ++v)
      if (static_cast<int>(v) < rim_ || triangle_of_[v] >= 0) number[v] = count++;
    mesh.barycentric.resize(count, 3);
    for (std::size_t v = 0; v < b_.size(); ++v)
      if (number[v] >= 0) mesh.barycentric.row(number[v]) = b_[v];
    for (const Triangle& f : triangles_)
      if (f.v[0] >= 0) mesh.triangles.push_back({number[f.v[0]], number[f.v[1]], number[f.v[2]]});
    return mesh;
  }

  const Surface& patch_;
  const Parameters& parameters_;
  bool inner_;  // vertices inside are wanted
  std::array<int, 3> corner_{};
  std::array<std::vector<double>, 3> log_size_;  // wanted at the rim, by side
  std::vector<std::uint8_t> side_;               // bit i: on side i
};

/// The corners of a triangle in another order, that of its geometry: what is chosen among equals does not hang on which is the first.
class CornerOrder {
public:
  CornerOrder(const Parameters& parameters, const Points& rim, const Surface& patch) : n_(rim.rows()) {
    std::vector<Index> corner = {0};
    for (int side : {2, 0}) corner.push_back(corner.back() + static_cast<Index>(parameters[side].size()) - 1);
    CanonicalStarts beginnings(patch.positions(rim), {}, corner);
    beginnings.compare_along();
    if (!beginnings.decided())
      beginnings.compare_with(patch.positions((Points(4, 3) << 3, 1, 1, 1, 3, 1, 1, 1, 3, 2, 1.5, 1.5).finished() / 5));
    first_ = beginnings.left()[0];
    const Index start = std::find(corner.begin(), corner.end(), first_.place) - corner.begin();
    for (int i = 0; i < 3; ++i) {
      corner_[i] = static_cast<int>(CanonicalStart{start, first_.backwards}.at(i, 3));
      parameters_[i] = parameters[corner_[i]];
      if (!first_.backwards) continue;
      std::reverse(parameters_[i].begin(), parameters_[i].end());
      for (double& t : parameters_[i]) t = 1 - t;
    }
  }

  const Parameters& parameters() const { return parameters_; }
  /// From places in this order to those in the given one.
  Points given(const PointsRef& b) const {
    Points out(b.rows(), 3);
    for (int i = 0; i < 3; ++i) out.col(corner_[i]) = b.col(i);
    return out;
  }
  /// The same of a mesh; rim: the coordinates of its rim in the given order.
  TriangleMesh given(TriangleMesh mesh, const Points& rim) const {
    mesh.barycentric = given(mesh.barycentric);
    mesh.barycentric.topRows(n_) = rim;
    for (std::array<Index, 3>& t : mesh.triangles) {
      for (Index& v : t)
        if (v < n_) v = first_.at(v, n_);
      if (first_.backwards) std::swap(t[1], t[2]);
    }
    return mesh;
  }

private:
  Index n_;
  CanonicalStart first_;
  std::array<int, 3> corner_{};  // that is given, of each in this order
  Parameters parameters_;
};

/// A patch whose corners are taken in another order. Positions only.
class Reordered final : public Surface {
public:
  Reordered(const Surface& patch, const CornerOrder& order) : patch_(patch), order_(order) {}
  void evaluate(const double* b, Index n, int, double* out) const override {
    const Points there = order_.given(Eigen::Map<const Points>(b, n, 3));
    patch_.evaluate(there.data(), n, 0, out);
  }

private:
  const Surface& patch_;
  const CornerOrder& order_;
};

}  // namespace

TriangleMesh triangulate(const Parameters& parameters, std::optional<int> resolution, const Surface& patch) {
  check(parameters);
  if (resolution && *resolution < 1) throw InvalidArgument("resolution must be 1 or more");
  const Points rim = rim_coordinates(parameters);
  const Index n = static_cast<Index>(parameters[0].size()) - 1;
  const bool equal = parameters[1].size() == parameters[0].size() && parameters[2].size() == parameters[0].size();
  if (equal && n <= largest_regular && (!resolution || *resolution == n)) {
    if (auto mesh = regular_grid(parameters, rim, patch)) return *std::move(mesh);
  }
  const CornerOrder order(parameters, rim, patch);
  const Reordered reordered(patch, order);
  return order.given(Remesher(order.parameters(), rim_coordinates(order.parameters()), resolution, reordered).run(), rim);
}

}  // namespace tripatch
