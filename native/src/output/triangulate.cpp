// Two ways. Equal counts and a well-behaved patch: the regular grid, its inner points moved by a transfinite blend of the rim's
// parameters. Otherwise: isotropic remeshing with a size field (Botsch and Kobbelt 2004, "A remeshing approach to multiresolution
// modeling"; size-weighted smoothing as in Dunyach et al. 2013, "Adaptive remeshing for real-time mesh deformation") that starts
// from the one triangle of the corners and works in the parameter triangle with lengths, angles and sizes measured in space.
// Every step (split, flip, collapse, move) keeps every triangle positively oriented in the parameter triangle, so the result is a
// triangulation of it, hence watertight and manifold, whatever the patch does in space.
#include "tripatch/output/triangulate.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace tripatch {
namespace {

using Parameters = std::array<std::vector<double>, 3>;
using Position = std::function<Points(const PointsRef&)>;
using Vec2 = Eigen::Vector2d;

constexpr Index largest_regular = 1000;    // edges per side
constexpr double most_triangles = 50'000;  // wanted of a fill that follows its rim and is not regular; grading adds to it
constexpr double most_over = 8;            // times as many triangles as the sizes say: no more are made (5 where a rim is uneven)
constexpr double growth = 0.4;             // of the size per distance, where the rim is finer than the inside
constexpr double too_long = 4.0 / 3, too_short = 0.75;  // times the size: where edges are split and collapsed

/// 1 for an equilateral triangle, 0 for one without area.
double shape(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 u = b - a, v = c - a, w = c - b;
  const double squares = u.squaredNorm() + v.squaredNorm() + w.squaredNorm();
  return squares > 0 ? 2 * std::sqrt(3.0) * u.cross(v).norm() / squares : 0;
}

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

// ---------------------------------------------------------------------------------------------- the regular grid

/// Vertex of the grid p steps towards corner 1 and q steps towards corner 2, rim first.
Index grid_vertex(Index n, Index p, Index q) {
  if (q == 0) return p;
  if (p + q == n) return n + q;
  if (p == 0) return 3 * n - q;
  return 3 * n + (q - 1) * (n - 1) - q * (q - 1) / 2 + p - 1;
}

std::optional<TriangleMesh> regular_grid(const Parameters& parameters, const Points& rim, const Position& position) {
  const Index n = static_cast<Index>(parameters[0].size()) - 1;
  TriangleMesh mesh;
  mesh.rim = 3 * n;
  mesh.barycentric.resize((n + 1) * (n + 2) / 2, 3);
  mesh.barycentric.topRows(3 * n) = rim;
  std::array<std::vector<double>, 3> shift;  // of the parameter against the even one
  for (int i = 0; i < 3; ++i)
    for (Index k = 0; k <= n; ++k) shift[i].push_back(parameters[i][k] - static_cast<double>(k) / static_cast<double>(n));
  for (Index q = 1; q < n; ++q)
    for (Index p = 1; p + q < n; ++p) {
      const std::array<Index, 3> step = {n - p - q, p, q};
      std::array<double, 3> b;
      for (int i = 0; i < 3; ++i) b[i] = static_cast<double>(step[i]) / static_cast<double>(n);
      for (int i = 0; i < 3; ++i) {  // seen from corner i, the shift of the opposite side fades like the square of the distance
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const double share = static_cast<double>(step[j] + step[k]) / static_cast<double>(n);
        const double at = static_cast<double>(step[k]) / share;
        const Index first = std::min(static_cast<Index>(at), n - 1);
        const double e = shift[i][first] + (at - static_cast<double>(first)) * (shift[i][first + 1] - shift[i][first]);
        b[j] -= share * share * e;
        b[k] += share * share * e;
      }
      mesh.barycentric.row(grid_vertex(n, p, q)) << b[0], b[1], 1 - b[0] - b[1];
    }
  mesh.triangles.reserve(n * n);
  for (Index q = 0; q < n; ++q)
    for (Index p = 0; p + q < n; ++p) {
      mesh.triangles.push_back({grid_vertex(n, p, q), grid_vertex(n, p + 1, q), grid_vertex(n, p, q + 1)});
      if (p + q + 1 < n)
        mesh.triangles.push_back({grid_vertex(n, p + 1, q), grid_vertex(n, p + 1, q + 1), grid_vertex(n, p, q + 1)});
    }

  // Fit for use? In the domain: no triangle turned over or squeezed (shape measured in the equilateral triangle).
  for (const auto& t : mesh.triangles) {
    std::array<Vec3, 3> x;
    for (int k = 0; k < 3; ++k) x[k] = mesh.barycentric.row(t[k]);
    const Vec3 u = x[1] - x[0], v = x[2] - x[0];
    if (!(u[1] * v[2] - u[2] * v[1] > 0) || shape(x[0], x[1], x[2]) < 0.1) return std::nullopt;
  }
  // In space: on a part of the grid, corners left out.
  const Index stride = (n + 11) / 12, rows = n / stride;
  Points b((rows + 1) * (rows + 2) / 2, 3);
  auto place = [&](Index p, Index q) { return q * (rows + 1) - q * (q - 1) / 2 + p; };
  for (Index q = 0; q <= rows; ++q)
    for (Index p = 0; p + q <= rows; ++p) b.row(place(p, q)) = mesh.barycentric.row(grid_vertex(n, stride * p, stride * q));
  const Points x = position(b);
  auto squeezed = [&](Index a, Index c, Index d) { return shape(x.row(a), x.row(c), x.row(d)) < 0.2; };
  for (Index q = 0; q < rows; ++q)
    for (Index p = 0; p + q < rows; ++p) {
      const bool corner = p + q == 0 || p + 1 == rows || q + 1 == rows;
      if (!corner && squeezed(place(p, q), place(p + 1, q), place(p, q + 1))) return std::nullopt;
      if (p + q + 1 < rows && squeezed(place(p + 1, q), place(p + 1, q + 1), place(p, q + 1))) return std::nullopt;
    }
  // Where the rim goes straight on at a corner, the one triangle there has no area: turn its inner edge towards the corner.
  for (int corner = 0; corner < 3 && n > 1; ++corner) {
    const Index c = corner * n, after = c + 1, before = (c + 3 * n - 1) % (3 * n);
    std::array<Index, 3>*tip = nullptr, *next = nullptr;
    for (auto& t : mesh.triangles) {
      int both = 0, tips = 0;
      for (Index v : t) both += v == after || v == before, tips += v == c;
      if (both == 2) (tips ? tip : next) = &t;
    }
    if (!tip || !next) continue;  // n == 2: another corner has taken the middle triangle
    Index across = 0;
    for (Index v : *next)
      if (v != after && v != before) across = v;
    Points q(4, 3);
    int row = 0;
    for (Index v : {c, after, across, before}) q.row(row++) = mesh.barycentric.row(v);
    q = position(q);
    const double now = std::min(shape(q.row(0), q.row(1), q.row(3)), shape(q.row(1), q.row(2), q.row(3)));
    const double then = std::min(shape(q.row(0), q.row(1), q.row(2)), shape(q.row(0), q.row(2), q.row(3)));
    if (then > now) *tip = {c, after, across}, *next = {c, across, before};
  }
  return mesh;
}

// ---------------------------------------------------------------------------------------------- remeshing

class Remesher {
public:
  Remesher(const Parameters& parameters, const Points& rim, std::optional<int> resolution, const Position& position)
      : position_(position), parameters_(parameters), rim_(static_cast<int>(rim.rows())), inner_(resolution != 1) {
    const Points x = position(rim);
    for (Index k = 0; k < rim.rows(); ++k) add_vertex(rim.row(k), x.row(k));
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
    std::vector<Vec3> inside(3, Vec3::Constant(0.2));
    for (int k = 0; k < 3; ++k) inside[k][k] = 0.6;
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
    return result();
  }

private:
  struct Triangle {
    std::array<int, 3> v;  // v[0] < 0: removed
    std::array<int, 3> n;  // n[k]: the triangle across the edge opposite v[k], -1 at the rim
  };
  struct Edge {
    int triangle, k;
    double excess;
  };

  int add_vertex(const Vec3& b, const Vec3& x) {
    b_.push_back(b);
    x_.push_back(x);
    side_.push_back(static_cast<std::uint8_t>((b[0] == 0) | (b[1] == 0) << 1 | (b[2] == 0) << 2));
    size_.push_back(0);
    triangle_of_.push_back(-1);
    return static_cast<int>(b_.size()) - 1;
  }
  bool on_rim(int v) const { return v < rim_; }
  bool alive(int t) const { return triangles_[t].v[0] >= 0; }
  std::size_t alive_triangles() const {
    return static_cast<std::size_t>(
        std::count_if(triangles_.begin(), triangles_.end(), [](const Triangle& f) { return f.v[0] >= 0; }));
  }
  double length(int a, int b) const { return (x_[a] - x_[b]).norm(); }
  double shape_of(int a, int b, int c) const { return shape(x_[a], x_[b], x_[c]); }

  /// Positively oriented beyond doubt: rim vertices of one side are exactly on one line; else above the rounding of the area.
  bool valid(int a, int b, int c) const {
    if (side_[a] & side_[b] & side_[c]) return false;
    return positive(b_[a], b_[b], b_[c]);
  }
  static bool positive(const Vec3& a, const Vec3& b, const Vec3& c) {
    const double ux = b[1] - a[1], uy = b[2] - a[2], vx = c[1] - a[1], vy = c[2] - a[2];
    const double longest = std::max(std::max(std::abs(ux), std::abs(uy)), std::max(std::abs(vx), std::abs(vy)));
    return ux * vy - vx * uy > 1e-15 * longest;
  }

  // ---- sizes

  /// Length wanted for edges at b: what the sides have at the feet of the rays from the opposite corners, mixed geometrically
  /// with weights that keep each side's own on it.
  double wanted(const Vec3& b) const {
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
        log_size_[side].push_back(std::log(std::max(size, 1e-300)));
      }
    }
    if (resolution) {  // a coarse rim must not use up the room that a finer inside needs
      const double room =
          std::accumulate(edge.begin(), edge.end(), 0.0) / (6 * std::sqrt(3.0));  // radius of an equal hole's incircle
      decline_ = std::max(decline_, 2 * *std::max_element(edge.begin(), edge.end()) / std::max(room, 1e-300));
      most_ = most_over * (triangles_wanted() + rim_);
      return;
    }
    const double count = triangles_wanted();
    if (count > most_triangles) coarser_ = std::sqrt(count / most_triangles);  // the inside is coarser than the rim
    most_ = most_over * (std::min(count, most_triangles) + rim_);
  }

  /// How many triangles of the wanted sizes cover the surface.
  double triangles_wanted() const {
    constexpr int rows = 48;
    Points b((rows + 1) * (rows + 2) / 2, 3);
    auto place = [&](int p, int q) { return q * (rows + 1) - q * (q - 1) / 2 + p; };
    for (int q = 0; q <= rows; ++q)
      for (int p = 0; p + q <= rows; ++p) b.row(place(p, q)) << rows - p - q, p, q;
    b /= rows;
    const Points x = position_(b);
    double count = 0;
    for (int q = 0; q < rows; ++q)
      for (int p = 0; p + q < rows; ++p)
        for (int half = 0; half < (p + q + 1 < rows ? 2 : 1); ++half) {
          const int i = half ? place(p + 1, q + 1) : place(p, q), j = place(p + 1, q), k = place(p, q + 1);
          const double twice = Vec3(x.row(j) - x.row(i)).cross(Vec3(x.row(k) - x.row(i))).norm();
          const double h = wanted((b.row(i) + b.row(j) + b.row(k)) / 3);
          count += twice / 2 / (0.43 * h * h);
        }
    return count;
  }

  /// Sizes of inner vertices: what is wanted; more near longer rim edges; not more than what shorter neighbours allow; and, next to
  /// a rim edge, what lets its triangle be tall enough.
  void limit_sizes() {
    for (int v = rim_; v < static_cast<int>(b_.size()); ++v)
      if (triangle_of_[v] >= 0) size_[v] = wanted(b_[v]);
    raise_beside_rim(decline_);
    const int count = static_cast<int>(triangles_.size());
    auto relax = [&](int t, auto&& rule) {
      const Triangle& f = triangles_[t];
      if (f.v[0] < 0) return;
      for (int k = 0; k < 3; ++k) rule(f.v[k], f.v[(k + 1) % 3]);
    };
    auto raise = [&](int a, int b) {
      if (on_rim(a) || on_rim(b)) return;
      const double fall = decline_ * length(a, b);
      size_[a] = std::max(size_[a], size_[b] - fall);
      size_[b] = std::max(size_[b], size_[a] - fall);
    };
    auto lower = [&](int a, int b) {
      const double allowed = growth * length(a, b);
      if (!on_rim(a)) size_[a] = std::min(size_[a], size_[b] + allowed);
      if (!on_rim(b)) size_[b] = std::min(size_[b], size_[a] + allowed);
    };
    for (int t = 0; t < count; ++t) relax(t, raise);
    for (int t = count; t-- > 0;) relax(t, raise);
    for (int sweep = 0; sweep < 2; ++sweep) {
      for (int t = 0; t < count; ++t) relax(t, lower);
      for (int t = count; t-- > 0;) relax(t, lower);
    }
    raise_beside_rim(2 * decline_);
  }
  void raise_beside_rim(double fall) {
    for (const Triangle& f : triangles_)
      for (int k = 0; k < 3 && f.v[0] >= 0; ++k) {
        const int a = f.v[(k + 1) % 3], b = f.v[(k + 2) % 3], apex = f.v[k];
        if (f.n[k] >= 0 || on_rim(apex) || rim_vertices_between(a, b)) continue;
        const Vec3 e = x_[b] - x_[a];
        const double height = e.cross(x_[apex] - x_[a]).norm() / std::max(e.norm(), 1e-300);
        size_[apex] = std::max(size_[apex], e.norm() - fall * height);
      }
  }
  double size_of_edge(int a, int b) const { return 0.5 * (size_[a] + size_[b]); }

  // ---- the rim

  int rim_vertices_between(int from, int to) const { return (to > from ? to : to + rim_) - from - 1; }
  bool rim_complete() const {
    for (const Triangle& f : triangles_)
      for (int k = 0; k < 3; ++k)
        if (f.v[0] >= 0 && f.n[k] < 0 && rim_vertices_between(f.v[(k + 1) % 3], f.v[(k + 2) % 3])) return false;
    return true;
  }
  /// The rim vertex between two that is nearest to the middle of the chord's parameters.
  int middle_of_rim(int from, int to) const {
    const int last = to > from ? to : rim_;
    const Vec3 a = b_[from], e = b_[to] - a;
    int low = from + 1, high = last - 1;
    while (low < high) {
      const int mid = (low + high) / 2;
      if ((b_[mid] - a).dot(e) < 0.5 * e.squaredNorm())
        low = mid + 1;
      else
        high = mid;
    }
    if (low > from + 1 && (b_[low] - a).dot(e) + (b_[low - 1] - a).dot(e) > e.squaredNorm()) --low;
    return low;
  }

  // ---- changes of the triangulation

  void link(int t, int old_neighbour, int new_neighbour) {
    if (t < 0) return;
    for (int& n : triangles_[t].n)
      if (n == old_neighbour) {
        n = new_neighbour;
        return;
      }
  }
  int slot(int t, int neighbour) const {
    const auto& n = triangles_[t].n;
    return n[0] == neighbour ? 0 : n[1] == neighbour ? 1 : 2;
  }

  /// Puts vertex m on the edge opposite v[k] of triangle t, on both sides of it.
  void split_edge(int t, int k, int m) {
    const int other = triangles_[t].n[k];
    auto halve = [&](int f, int j) {  // f keeps (apex, first, m); the new one is (apex, m, second)
      const int made = static_cast<int>(triangles_.size());
      Triangle& old = triangles_[f];
      const int apex = old.v[j], second = old.v[(j + 2) % 3], beyond = old.n[(j + 1) % 3];
      old.v[(j + 2) % 3] = m;
      old.n[(j + 1) % 3] = made;
      triangles_.push_back({{apex, m, second}, {-1, beyond, f}});
      link(beyond, f, made);
      triangle_of_[second] = made;
      triangle_of_[apex] = made;
      for (int a = 0; a < 3; ++a) dirty_.push_back({f, a}), dirty_.push_back({made, a});
      return made;
    };
    const int j = other >= 0 ? slot(other, t) : -1;
    const int made = halve(t, k);
    triangle_of_[m] = t;
    if (other < 0) return;
    // t keeps (first, m), so across it lies the half of `other` with (m, first): the one that is made
    const int mirrored = halve(other, j);
    triangles_[t].n[k] = mirrored;
    triangles_[mirrored].n[0] = t;
    triangles_[other].n[j] = made;
    triangles_[made].n[0] = other;
  }

  /// One round of splits, no triangle twice, the longest for its size first: rim edges that still miss vertices, then inner edges.
  std::size_t split() {
    std::vector<Edge> edges;
    // Where the surface is torn or folds, edges stay too long however often they are split.
    const bool inner = inner_ && static_cast<double>(alive_triangles()) < most_;
    for (int t = 0; t < static_cast<int>(triangles_.size()); ++t) {
      const Triangle& f = triangles_[t];
      if (f.v[0] < 0) continue;
      for (int k = 0; k < 3; ++k) {
        const int a = f.v[(k + 1) % 3], b = f.v[(k + 2) % 3];
        if (f.n[k] < 0) {
          const int between = rim_vertices_between(a, b);
          if (between) edges.push_back({t, k, static_cast<double>(between + 1)});
        } else if (inner && t < f.n[k]) {
          const double excess = length(a, b) / (too_long * size_of_edge(a, b));
          if (excess > 1) edges.push_back({t, k, excess});
        }
      }
    }
    std::stable_sort(edges.begin(), edges.end(), [](const Edge& p, const Edge& q) { return p.excess > q.excess; });
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
        const int c = f.v[e.k], d = triangles_[other].v[slot(other, e.triangle)];
        if (!positive(b_[c], b_[a], m) || !positive(b_[c], m, b_[b]) || !positive(b_[d], b_[b], m) || !positive(b_[d], m, b_[a]))
          continue;
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
    const Vec3 n1 = u.cross(e), n2 = e.cross(w);
    const double cosine = n1.dot(n2), scale = std::sqrt(n1.squaredNorm() * n2.squaredNorm());
    if (cosine < 0) return cosine / scale;
    return std::min(shape_of(a, b, c), shape_of(a, c, d));
  }

  void look_at_all() {
    for (int t = 0; t < static_cast<int>(triangles_.size()); ++t)
      for (int k = 0; k < 3; ++k)
        if (alive(t) && t < triangles_[t].n[k]) dirty_.push_back({t, k});
  }

  /// Flips edges while that makes the worse of the two triangles better.
  void flip_all() {
    std::size_t budget = 40 * alive_triangles() + 1000;  // where the surface folds over itself there may be no end
    while (!dirty_.empty() && budget-- > 0) {
      const auto [t, k] = dirty_.back();
      dirty_.pop_back();
      const int o = alive(t) ? triangles_[t].n[k] : -1;
      if (o < 0) continue;
      Triangle &f = triangles_[t], &g = triangles_[o];
      const int j = slot(o, t);
      const int c = f.v[k], a = f.v[(k + 1) % 3], b = f.v[(k + 2) % 3], d = g.v[j];
      if (!valid(c, a, d) || !valid(c, d, b)) continue;
      if (!(pair_quality(c, a, d, b) > pair_quality(a, d, b, c) + 1e-9)) continue;
      const int f_b = f.n[(k + 2) % 3], f_a = f.n[(k + 1) % 3];  // across c-a and across b-c
      const int g_a = g.n[(j + 2) % 3], g_b = g.n[(j + 1) % 3];  // across d-b and across a-d
      // g is (d, b, a): its slot j + 1 holds b, so n[j + 1] is across a-d and n[j + 2] across d-b
      f = {{c, a, d}, {g_b, o, f_b}};
      g = {{c, d, b}, {g_a, f_a, t}};
      link(g_b, o, t);
      link(f_a, t, o);
      triangle_of_[c] = t, triangle_of_[a] = t, triangle_of_[d] = o, triangle_of_[b] = o;
      for (int i = 0; i < 3; ++i)
        if (i != 1) dirty_.push_back({t, i});
      for (int i = 0; i < 2; ++i) dirty_.push_back({o, i});
    }
    dirty_.clear();
  }

  /// Triangles around an inner vertex, in order.
  const std::vector<int>& around(int v) {
    ring_.clear();
    int t = triangle_of_[v];
    do {
      ring_.push_back(t);
      const Triangle& f = triangles_[t];
      const int k = f.v[0] == v ? 0 : f.v[1] == v ? 1 : 2;
      t = f.n[(k + 1) % 3];
    } while (t != ring_.front());
    return ring_;
  }

  /// Takes inner vertices away where edges are too short, by pulling them onto a neighbour.
  void collapse_short() {
    std::vector<Edge> edges;  // triangle: the vertex that goes, k: where to
    for (int v = rim_; v < static_cast<int>(b_.size()); ++v) {
      if (triangle_of_[v] < 0) continue;
      for (int t : around(v)) {
        const Triangle& f = triangles_[t];
        const int k = f.v[0] == v ? 0 : f.v[1] == v ? 1 : 2, w = f.v[(k + 1) % 3];
        const double ratio = length(v, w) / (too_short * std::min(size_[v], size_[w]));
        if (ratio < 1) edges.push_back({v, w, ratio});
      }
    }
    std::stable_sort(edges.begin(), edges.end(), [](const Edge& p, const Edge& q) { return p.excess < q.excess; });
    for (const Edge& e : edges) collapse(e.triangle, e.k);
  }

  bool collapse(int v, int w) {
    if (triangle_of_[v] < 0 || (!on_rim(w) && triangle_of_[w] < 0)) return false;
    const std::vector<int> ring = around(v);
    std::vector<int> link_of_v, link_triangles;  // neighbours in order; ring[i] spans link_of_v[i], link_of_v[i + 1]
    for (int t : ring) {
      const Triangle& f = triangles_[t];
      const int k = f.v[0] == v ? 0 : f.v[1] == v ? 1 : 2;
      link_of_v.push_back(f.v[(k + 1) % 3]);
      link_triangles.push_back(f.n[k]);
    }
    const int n = static_cast<int>(ring.size());
    const int at = static_cast<int>(std::find(link_of_v.begin(), link_of_v.end(), w) - link_of_v.begin());
    if (at == n) return false;
    double before = 1, after = 1;
    for (int i = 0; i < n; ++i) {
      const int p = link_of_v[i], q = link_of_v[(i + 1) % n];
      before = std::min(before, shape_of(v, p, q));
      if (p == w || q == w) continue;
      if (!valid(w, p, q)) return false;
      after = std::min(after, shape_of(w, p, q));
      if (p != link_of_v[(at + 1) % n] && length(w, p) > too_long * size_of_edge(w, p)) return false;
    }
    if (after < std::min(0.4, before)) return false;
    // ring[at] = (v, w, next) and ring[at - 1] = (v, previous, w) go
    const int gone = ring[at], gone2 = ring[(at + n - 1) % n];
    const int next = link_of_v[(at + 1) % n], previous = link_of_v[(at + n - 1) % n];
    const int inside = ring[(at + 1) % n], inside2 = ring[(at + n - 2) % n];
    const int outside = link_triangles[at], outside2 = link_triangles[(at + n - 1) % n];
    link(inside, gone, outside);
    link(outside, gone, inside);
    link(inside2, gone2, outside2);
    link(outside2, gone2, inside2);
    for (int i = 2; i < n; ++i) {
      const int t = ring[(at + i - 1) % n];
      for (int& corner : triangles_[t].v)
        if (corner == v) corner = w;
      for (int k = 0; k < 3; ++k) dirty_.push_back({t, k});
    }
    triangles_[gone].v[0] = triangles_[gone2].v[0] = -1;
    triangle_of_[w] = triangle_of_[next] = inside;
    triangle_of_[previous] = inside2;
    triangle_of_[v] = -1;
    return true;
  }

  /// Moves inner vertices to the size-weighted centre of the triangles around, the move taken back to the parameter triangle by
  /// the local Jacobian. careful: only where the worst triangle around gets better.
  void smooth(bool careful) {
    std::vector<int> who;
    std::vector<Vec3> where;
    for (int v = rim_; v < static_cast<int>(b_.size()); ++v) {
      if (triangle_of_[v] < 0) continue;
      Vec3 centre = Vec3::Zero();
      double weights = 0;
      Eigen::Matrix2d uu = Eigen::Matrix2d::Zero();
      Eigen::Matrix<double, 3, 2> xu = Eigen::Matrix<double, 3, 2>::Zero();
      for (int t : around(v)) {
        const Triangle& f = triangles_[t];
        const int k = f.v[0] == v ? 0 : f.v[1] == v ? 1 : 2, p = f.v[(k + 1) % 3], q = f.v[(k + 2) % 3];
        const double size = (size_[v] + size_[p] + size_[q]) / 3;
        const Vec3 u = x_[p] - x_[v];
        const double w = u.cross(x_[q] - x_[v]).norm() / (size * size);
        centre += w * (x_[p] + x_[q] - 2 * x_[v]) / 3;
        weights += w;
        const Vec2 du = (b_[p] - b_[v]).tail<2>();
        const double near = 1 / std::max(u.squaredNorm(), 1e-300);
        uu += near * du * du.transpose();
        xu += near * u * du.transpose();
      }
      if (!(weights > 0)) continue;
      const double det = uu.determinant();
      if (!(det > 0)) continue;
      const Eigen::Matrix<double, 3, 2> jacobian = xu * uu.inverse();
      const Eigen::Matrix2d metric = jacobian.transpose() * jacobian;
      if (!(metric.determinant() > 1e-12 * metric.squaredNorm())) continue;
      Vec2 step = metric.inverse() * (jacobian.transpose() * (centre / weights));
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
      if (!star_is_valid(v, where[i])) continue;  // a neighbour has moved meanwhile
      const double before = star_quality(v, x_[v]), after = star_quality(v, x.row(i));
      if (careful ? after < before : after < std::min(before, 0.3)) continue;
      b_[v] = where[i];
      x_[v] = x.row(i);
    }
    look_at_all();
  }
  static Vec3 moved(const Vec3& b, const Vec2& step) {
    const double b1 = b[1] + step[0], b2 = b[2] + step[1];
    return {1 - b1 - b2, b1, b2};
  }
  bool star_is_valid(int v, const Vec3& b) {
    for (int t : around(v)) {
      const Triangle& f = triangles_[t];
      const int k = f.v[0] == v ? 0 : f.v[1] == v ? 1 : 2;
      if (!positive(b, b_[f.v[(k + 1) % 3]], b_[f.v[(k + 2) % 3]])) return false;
    }
    return true;
  }
  /// The worst shape around v when it stands at x; negative where a triangle faces away from the others.
  double star_quality(int v, const Vec3& x) {
    Vec3 facing = Vec3::Zero();
    for (int t : around(v)) facing += star_normal(t, v, x);
    double worst = 1;
    for (int t : ring_) {
      const Triangle& f = triangles_[t];
      const int k = f.v[0] == v ? 0 : f.v[1] == v ? 1 : 2;
      const double s = shape(x, x_[f.v[(k + 1) % 3]], x_[f.v[(k + 2) % 3]]);
      worst = std::min(worst, star_normal(t, v, x).dot(facing) > 0 ? s : -s);
    }
    return worst;
  }
  Vec3 star_normal(int t, int v, const Vec3& x) const {
    const Triangle& f = triangles_[t];
    const int k = f.v[0] == v ? 0 : f.v[1] == v ? 1 : 2;
    return (x_[f.v[(k + 1) % 3]] - x).cross(x_[f.v[(k + 2) % 3]] - x);
  }

  Points positions(const std::vector<Vec3>& b) const {
    if (b.empty()) return Points(0, 3);
    return position_(Eigen::Map<const Points>(b.front().data(), static_cast<Index>(b.size()), 3));
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

  const Position& position_;
  const Parameters& parameters_;
  int rim_;     // vertices 0 .. rim_ - 1 are the rim
  bool inner_;  // vertices inside are wanted
  std::array<int, 3> corner_{};
  std::array<std::vector<double>, 3> log_size_;  // wanted at the rim, by side
  double coarser_ = 1;
  double most_ = 0;       // triangles beyond which no inner edge is split
  double decline_ = 0.8;  // of the size per distance, where the rim is coarser
  std::vector<Vec3> b_, x_;
  std::vector<std::uint8_t> side_;  // bit i: on side i
  std::vector<double> size_;
  std::vector<int> triangle_of_;  // one triangle of each vertex, -1: removed
  std::vector<Triangle> triangles_;
  std::vector<std::array<int, 2>> dirty_;  // edges (triangle, opposite corner) to be looked at
  std::vector<int> ring_;
};

}  // namespace

TriangleMesh triangulate(const Parameters& parameters, std::optional<int> resolution, const Position& position) {
  check(parameters);
  if (resolution && *resolution < 1) throw InvalidArgument("resolution must be 1 or more");
  const Points rim = rim_coordinates(parameters);
  const Index n = static_cast<Index>(parameters[0].size()) - 1;
  const bool equal = parameters[1].size() == parameters[0].size() && parameters[2].size() == parameters[0].size();
  if (equal && n <= largest_regular && (!resolution || *resolution == n)) {
    if (auto mesh = regular_grid(parameters, rim, position)) return *std::move(mesh);
  }
  return Remesher(parameters, rim, resolution, position).run();
}

}  // namespace tripatch
