// Isotropic remeshing with a size field (Botsch and Kobbelt 2004, "A remeshing approach to multiresolution modeling"; size-weighted
// smoothing as in Dunyach et al. 2013, "Adaptive remeshing for real-time mesh deformation") with Delaunay flips. Evaluating the
// surface is what costs: new vertices are evaluated in one batch a pass, vertices that move in between follow their own tangent
// plane, and only at the end all are put on the surface.
#include "tripatch/output/remesh.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "tripatch/math/interruption.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/math/tolerant_compare.h"
#include "tripatch/output/domain_mesh.h"

namespace tripatch {
namespace {

using VertexPair = std::array<int, 2>;

constexpr int max_sources = count::hundreds;    // of rim sizes: longer rims count by runs of edges
constexpr int max_passes = count::many_places;  // a rim of 10,000 edges needs 25
constexpr int careful_passes = count::pair;
constexpr double min_move = 0.03;  // of the size: smaller moves are not worth an evaluation

VertexPair ordered(Index a, Index b) { return {static_cast<int>(std::min(a, b)), static_cast<int>(std::max(a, b))}; }

void check(const PlanePolygon& p, std::optional<int> resolution) {
  if (resolution && *resolution < 1) throw InvalidArgument("resolution must be 1 or more");
  const Index n = p.uv.rows();
  if (p.points.rows() != n || p.rim < 3 || p.rim > n)
    throw InvalidArgument("a point in space for each point in the plane, rim first");
  for (const auto& t : p.triangles) {
    for (Index v : t)
      if (v < 0 || v >= n) throw InvalidArgument("triangles of rows that the polygon does not have");
    const Vec2 a = p.uv.row(t[1]) - p.uv.row(t[0]), b = p.uv.row(t[2]) - p.uv.row(t[0]);
    if (!(a[0] * b[1] - a[1] * b[0] > 0)) throw InvalidArgument("a triangle of the polygon is turned over");
  }
  for (const auto* pairs : {&p.creases, &p.joined})
    for (const auto& [a, b] : *pairs)
      if (std::min(a, b) < 0 || std::max(a, b) >= n) throw InvalidArgument("pairs of rows that the polygon does not have");
}

/// Border edges in the order of their loops: edges of one triangle, from and to.
std::vector<VertexPair> border_edges(const PlanePolygon& p) {
  std::vector<VertexPair> edges, border;
  for (const auto& t : p.triangles)
    for (int k = 0; k < 3; ++k) edges.push_back({static_cast<int>(t[k]), static_cast<int>(t[(k + 1) % 3])});
  std::sort(edges.begin(), edges.end());
  std::vector<int> next(p.uv.rows(), -1);
  for (const auto& [a, b] : edges)
    if (!std::binary_search(edges.begin(), edges.end(), VertexPair{b, a})) next[a] = b;
  for (int start = 0; start < static_cast<int>(next.size()); ++start)
    for (int v = start; next[v] >= 0;) {
      border.push_back({v, next[v]});
      next[std::exchange(v, next[v])] = -1;
    }
  return border;
}

/// The lengths that edges should have, from the rim's.
class Sizes {
public:
  Sizes(const PlanePolygon& p, std::optional<int> resolution) : border_(border_edges(p)) {
    const Index n = static_cast<Index>(border_.size()), run = std::max<Index>(1, (n + max_sources - 1) / max_sources);
    u_.setZero((n + run - 1) / run);
    v_ = weight_ = log_size_ = soft_ = u_;
    const Vec2 low = p.uv.colwise().minCoeff(), high = p.uv.colwise().maxCoeff();
    middle_ = (low + high) / 2;
    scale_ = std::max((high - low).maxCoeff() / 2, tolerance::tiny);
    space_ = scale_ * p.unit;
    for (Index k = 0; k < n; ++k) {
      const auto& [a, b] = border_[k];
      const double length = (p.points.row(a) - p.points.row(b)).norm();
      edge_.push_back(length);
      const Vec2 at = ((p.uv.row(a) + p.uv.row(b)) / 2 - middle_.transpose()) / scale_;
      const auto share = length / space_ + tolerance::tiny;
      u_[k / run] += share * at[0];
      v_[k / run] += share * at[1];
      log_size_[k / run] += share * std::log(std::max(length / space_, tolerance::tiny));
      weight_[k / run] += share;
    }
    u_ /= weight_;
    v_ /= weight_;
    log_size_ /= weight_;
    soft_ = 0.25 * weight_.square();
    around_ = std::accumulate(edge_.begin(), edge_.end(), 0.0);
    if (resolution) log_size_.setConstant(std::log(std::max(around_ / (p.sides * *resolution) / space_, tolerance::tiny)));
  }

  /// In space; uv in the polygon's own units.
  double at(const Vec2& uv) const {
    const double u = (uv[0] - middle_[0]) / scale_, v = (uv[1] - middle_[1]) / scale_;
    work_ = weight_ / ((u_ - u).square() + (v_ - v).square() + soft_);
    return space_ * std::exp((work_ * log_size_).sum() / work_.sum());
  }

  /// How many triangles of these sizes cover the polygon, each of its triangles looked at in places enough.
  double triangles(const PlanePolygon& p) const {
    double count = 0;
    for (const auto& t : p.triangles) {
      const Vec2 a = p.uv.row(t[0]), b = Vec2(p.uv.row(t[1])) - a, c = Vec2(p.uv.row(t[2])) - a;
      const double twice = (b[0] * c[1] - b[1] * c[0]) * p.unit * p.unit;
      const double longest = std::max({b.norm(), c.norm(), (b - c).norm()}) * p.unit;
      const int parts = static_cast<int>(std::clamp<double>(std::ceil(longest / (2 * at(a + (b + c) / 3))), 1, 6));
      for (int i = 0; i < parts; ++i)
        for (int j = 0; i + j < parts; ++j)
          for (int half = 0; half < (i + j + 1 < parts ? 2 : 1); ++half) {
            const double third = (half + 1) / 3.0, h = at(a + ((i + third) * b + (j + third) * c) / parts);
            count += twice / 2 / (parts * parts) / (area_of_triangle * h * h);
          }
    }
    return count;
  }

  const std::vector<VertexPair>& border() const { return border_; }
  const std::vector<double>& edges() const { return edge_; }
  double around() const { return around_; }
  const Vec2& middle() const { return middle_; }
  double scale() const { return scale_; }

private:
  std::vector<VertexPair> border_;
  std::vector<double> edge_;                   // lengths in space
  double around_ = 0, scale_ = 1, space_ = 1;  // half the domain's size, and what it is in space
  Vec2 middle_;
  Eigen::ArrayXd u_, v_, weight_, log_size_, soft_;  // of runs of edges, in units of scale_, or of space_
  mutable Eigen::ArrayXd work_;
};

class PlaneRemesher final : DomainMesh {
public:
  PlaneRemesher(const PlanePolygon& polygon, std::optional<int> resolution, const Surface& surface)
      : DomainMesh(static_cast<int>(polygon.rim)),
        polygon_(polygon),
        surface_(surface),
        sizes_(polygon, resolution),
        inner_(resolution != 1),
        given_(static_cast<int>(polygon.uv.rows())) {
    for (Index v = 0; v < given_; ++v) {
      const Vec2 uv = (polygon.uv.row(v).transpose() - sizes_.middle()) / sizes_.scale();
      add_vertex(Vec3(0, uv[0], uv[1]), polygon.points.row(v));
    }
    set_lowest(polygon.size);
    for (const auto& [a, b] : polygon.joined) joined_.push_back(ordered(a, b));
    std::sort(joined_.begin(), joined_.end());
    for (const auto& [a, b] : polygon.creases) {
      creases_.insert(ordered(a, b));
      on_crease_[a] = on_crease_[b] = 1;
    }
    connect();
    set_sizes(resolution);
  }

  PlaneTriangulation run(const MostTriangles& most) {
    look_at_all();
    flip_all();
    if (!remesh(most)) return unfinished();
    if (take_lattices_out()) remesh(most);
    while (split_joined()) {
    }
    add_lattices();
    return result();
  }

private:
  /// False where it has come to more.
  bool remesh(const MostTriangles& most) {
    int nearly_done = 0;
    for (int pass = 0; pass < max_passes; ++pass) {
      limit_sizes();
      crease_halved_ = false;
      const std::size_t splits = split();
      flip_all();
      if (inner_) {
        collapse_short();
        flip_all();
        smooth(false);
      }
      if (is_more_than(most)) return false;
      if (splits == 0) break;
      if (!crease_halved_ && 30 * splits < triangles_.size() && ++nearly_done > 1) break;
    }
    flip_all();
    if (inner_) {
      put_on_surface();
      for (int pass = 0; pass < careful_passes; ++pass) {
        flip_all();
        smooth(true);
      }
      flip_all();
    }
    return true;
  }

  bool is_more_than(const MostTriangles& most) const {
    if (alive_triangles() <= most.count) return false;
    double twice = 0;
    for (const Triangle& f : triangles_)
      if (f.v[0] >= 0) twice += (x_[f.v[1]] - x_[f.v[0]]).cross(x_[f.v[2]] - x_[f.v[0]]).norm();
    return twice > 2 * most.area;
  }

  PlaneTriangulation unfinished() const {
    PlaneTriangulation made = result();
    made.unfinished = true;
    return made;
  }

  int add_vertex(const Vec3& b, const Vec3& x) override {
    on_crease_.push_back(0);
    return DomainMesh::add_vertex(b, x);
  }

  void connect() {
    std::vector<std::array<int, 3>> edges;  // lower vertex, higher vertex, 3 * triangle + opposite corner
    for (const auto& t : polygon_.triangles) {
      const int number = static_cast<int>(triangles_.size());
      triangles_.push_back({{static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2])}, {-1, -1, -1}});
      for (int k = 0; k < 3; ++k) {
        const VertexPair e = ordered(t[(k + 1) % 3], t[(k + 2) % 3]);
        edges.push_back({e[0], e[1], 3 * number + k});
        triangle_of_[t[k]] = number;
      }
    }
    std::sort(edges.begin(), edges.end());
    for (std::size_t k = 0; k + 1 < edges.size(); ++k) {
      if (edges[k][0] != edges[k + 1][0] || edges[k][1] != edges[k + 1][1]) continue;
      const int p = edges[k][2], q = edges[k + 1][2];
      triangles_[p / 3].n[p % 3] = q / 3;
      triangles_[q / 3].n[q % 3] = p / 3;
    }
    for (int v = 0; v < given_; ++v)
      if (triangle_of_[v] < 0) throw InvalidArgument("a vertex of the polygon without a triangle");
  }

  void set_sizes(std::optional<int> resolution) {
    const auto& border = sizes_.border();
    for (std::size_t k = 0; k < border.size(); ++k)
      for (int v : border[k]) size_[v] += sizes_.edges()[k] / 2;
    const double count = sizes_.triangles(polygon_), edges = static_cast<double>(border.size());
    if (resolution) {  // a coarse rim must not use up the room that a finer inside needs
      const double room = sizes_.around() / (6 * std::sqrt(3.0));  // radius of an equal triangle's incircle
      const double longest = *std::max_element(sizes_.edges().begin(), sizes_.edges().end());
      decline_ = std::max(decline_, 2 * longest / std::max(room, tolerance::tiny));
    }
    bound_triangles(count, edges, resolution);
  }

  double wanted(const Vec3& b) const override { return coarser_ * sizes_.at(sizes_.middle() + sizes_.scale() * b.tail<2>()); }
  bool is_fixed(int v) const override { return v < given_ || on_crease_[v] || on_lattice_[v]; }
  bool is_joined(int a, int b) const {
    return on_rim(a) && on_rim(b) && std::binary_search(joined_.begin(), joined_.end(), ordered(a, b));
  }
  bool may_join(int a, int b) const override { return !is_joined(a, b); }
  bool is_crease(int a, int b) const { return on_crease_[a] && on_crease_[b] && creases_.count(ordered(a, b)); }

  /// Where the angles opposite the edge come to more than 180 degrees; never into a fold, always out of one.
  bool wants_flip(int a, int b, int c, int d) const override {
    if (is_crease(a, b) || is_joined(c, d)) return false;
    if (is_joined(a, b)) return true;
    const Vec3 ca = x_[a] - x_[c], cb = x_[b] - x_[c], da = x_[a] - x_[d], db = x_[b] - x_[d], cd = x_[d] - x_[c];
    const TwoEdges near(ca, cb), far(db, da);
    const bool folded = face_away(near, far);
    const double s1 = near.normal.norm(), s2 = far.normal.norm(), c1 = ca.dot(cb), c2 = da.dot(db);
    const double sine = s1 * c2 + c1 * s2;     // of both angles
    if (!folded && !(sine < 0)) return false;  // as most are, whatever a flip would bring
    if (folded != face_away({ca, cd}, {cd, cb})) return folded;
    return sine < -tie_between(near, far) * (s1 + std::abs(c1)) * (s2 + std::abs(c2));
  }

  /// One round of splits, no triangle twice, the longest for its size first.
  std::size_t split() {
    std::vector<Edge> edges;
    // Where the surface is torn or folds, edges stay too long however often they are split.
    const double alive = static_cast<double>(alive_triangles());
    const bool inner = inner_ && alive < most_;
    for (int t = 0; t < static_cast<int>(triangles_.size()); ++t) {
      const Triangle& f = triangles_[t];
      if (f.v[0] < 0) continue;
      for (int k = 0; k < 3; ++k) {
        if (t >= f.n[k]) continue;
        const int a = f.v[(k + 1) % 3], b = f.v[(k + 2) % 3];
        const double excess = inner ? length(a, b) / (too_long * size_of_edge(a, b)) : 0;
        if (is_joined(a, b))
          edges.push_back({t, k, std::numeric_limits<double>::infinity()});
        else if (const double key = sorted_by(excess); key > 1)
          edges.push_back({t, k, key});
      }
    }
    std::stable_sort(edges.begin(), edges.end(), [](const Edge& p, const Edge& q) {
      check_interruption();
      return p.excess > q.excess;
    });
    if (inner) edges.resize(std::min(edges.size(), static_cast<std::size_t>((most_ - alive) / 2) + 1));
    return split(edges);
  }

  /// Edges between rim vertices that the mesh joins already.
  bool split_joined() {
    std::vector<Edge> edges;
    for (int t = 0; t < static_cast<int>(triangles_.size()); ++t)
      for (int k = 0; k < 3; ++k)
        if (alive(t) && t < triangles_[t].n[k] && is_joined(triangles_[t].v[(k + 1) % 3], triangles_[t].v[(k + 2) % 3]))
          edges.push_back({t, k, 0});
    return split(edges) > 0;
  }

  std::size_t split(const std::vector<Edge>& edges) {
    std::vector<char> taken(triangles_.size(), 0);
    std::vector<Edge> chosen;
    std::vector<Vec3> middles;
    for (const Edge& e : edges) {
      const Triangle& f = triangles_[e.triangle];
      const int other = f.n[e.k];
      if (taken[e.triangle] || taken[other]) continue;
      const Vec3 m = 0.5 * (b_[f.v[(e.k + 1) % 3]] + b_[f.v[(e.k + 2) % 3]]);
      if (!can_split(e.triangle, e.k, m)) continue;
      middles.push_back(m);
      taken[e.triangle] = taken[other] = 1;
      chosen.push_back(e);
    }
    const Points x = positions(middles);
    for (std::size_t row = 0; row < chosen.size(); ++row) {
      const Edge& e = chosen[row];
      const int a = triangles_[e.triangle].v[(e.k + 1) % 3], b = triangles_[e.triangle].v[(e.k + 2) % 3];
      const int m = add_vertex(middles[row], x.row(static_cast<Index>(row)));
      size_[m] = std::min(wanted(middles[row]), size_of_edge(a, b) + growth * length(a, b) / 2);
      if (is_crease(a, b)) {
        creases_.erase(ordered(a, b));
        creases_.insert(ordered(a, m));
        creases_.insert(ordered(m, b));
        on_crease_[m] = 1;
        crease_halved_ = true;
      }
      split_edge(e.triangle, e.k, m);
    }
    return chosen.size();
  }

  /// careful: evaluated on the surface, and only where the worst triangle around gets better.
  void smooth(bool careful) {
    std::vector<int> who;
    std::vector<Vec3> where, there;
    for (int v = given_; v < static_cast<int>(b_.size()); ++v) {
      if (triangle_of_[v] < 0 || is_fixed(v)) continue;
      const std::optional<Way> way = way_of(v);
      if (!way || clearly_less(way->in_space.norm(), min_move * size_[v])) continue;
      auto [step, in_space] = *way;
      for (int attempt = 0; attempt < 4; ++attempt, step *= 0.5, in_space *= 0.5) {
        const Vec3 b = b_[v] + Vec3(0, step[0], step[1]);
        if (!star_is_valid(v, b)) continue;
        who.push_back(v);
        where.push_back(b);
        there.push_back(x_[v] + in_space);
        break;
      }
    }
    if (careful) {
      const Points x = positions(where);
      for (std::size_t i = 0; i < who.size(); ++i) there[i] = x.row(static_cast<Index>(i));
    }
    for (std::size_t i = 0; i < who.size(); ++i) {
      const int v = who[i];
      if (!star_is_valid(v, where[i])) continue;  // a neighbor has moved meanwhile
      const double after = star_quality(v, there[i]);
      if ((careful || after < good_enough) && !clearly_more(after, star_quality(v, x_[v]))) continue;
      b_[v] = where[i];
      x_[v] = there[i];
    }
    look_at_all();
  }

  void put_on_surface() {
    std::vector<int> who;
    std::vector<Vec3> where;
    for (int v = given_; v < static_cast<int>(b_.size()); ++v)
      if (triangle_of_[v] >= 0) who.push_back(v), where.push_back(b_[v]);
    const Points x = positions(where);
    for (std::size_t i = 0; i < who.size(); ++i) x_[who[i]] = x.row(static_cast<Index>(i));
    look_at_all();
  }

  Points positions(const std::vector<Vec3>& b) const override {
    Points uv(static_cast<Index>(b.size()), 3);
    for (Index k = 0; k < uv.rows(); ++k) uv.row(k) << uv_of(b[k]).transpose(), 0;
    return uv.rows() ? surface_.positions(uv) : uv;
  }
  Vec2 uv_of(const Vec3& b) const { return sizes_.middle() + sizes_.scale() * b.tail<2>(); }

  PlaneTriangulation result() const {
    PlaneTriangulation made;
    std::vector<Index> number(b_.size(), -1);
    Index count = 0;
    for (std::size_t v = 0; v < b_.size(); ++v)
      if (triangle_of_[v] >= 0) number[v] = count++;
    made.uv.resize(count, 2);
    made.points.resize(count, 3);
    for (int v = 0; v < static_cast<int>(b_.size()); ++v) {
      if (number[v] < 0) continue;
      made.uv.row(number[v]) = v < given_ ? Vec2(polygon_.uv.row(v)) : uv_of(b_[v]);
      made.points.row(number[v]) = x_[v];
    }
    for (const Triangle& f : triangles_) {
      if (f.v[0] < 0) continue;
      made.triangles.push_back({number[f.v[0]], number[f.v[1]], number[f.v[2]]});
      for (int k = 0; k < 3; ++k) made.doubles_edges |= f.n[k] >= 0 && is_joined(f.v[(k + 1) % 3], f.v[(k + 2) % 3]);
    }
    for (const auto& [a, b] : creases_) made.creases.push_back({number[a], number[b]});
    return made;
  }

  const PlanePolygon& polygon_;
  const Surface& surface_;
  Sizes sizes_;
  bool inner_;  // vertices inside are wanted
  int given_;   // vertices 0 .. given_ - 1 are the polygon's
  std::vector<VertexPair> joined_;
  std::set<VertexPair> creases_;
  std::vector<char> on_crease_;
  bool crease_halved_ = false;
};

}  // namespace

namespace {

/// Whether the last row is inside one ring of triangles, and every other in some.
bool is_inside_one_ring(const std::vector<std::array<Index, 3>>& triangles, Index last) {
  std::vector<char> has(static_cast<std::size_t>(last), 0);
  std::map<Index, Index> next;  // along the ring
  for (const std::array<Index, 3>& t : triangles) {
    for (int k = 0; k < 3; ++k) {
      if (t[k] < last)
        has[static_cast<std::size_t>(t[k])] = 1;
      else if (!next.emplace(t[(k + 1) % 3], t[(k + 2) % 3]).second)
        return false;
    }
  }
  if (next.empty() || std::find(has.begin(), has.end(), 0) != has.end()) return false;
  std::size_t steps = 0;
  const Index start = next.begin()->first;
  for (Index v = start; steps == 0 || v != start; ++steps) {
    const auto found = next.find(v);
    if (found == next.end() || steps > next.size()) return false;
    v = found->second;
  }
  return steps == next.size();
}

}  // namespace

bool insert_row(PlanePolygon& polygon, const Eigen::RowVector2d& uv, const Vec3& point) {
  const Index row = polygon.uv.rows();
  const double near = tolerance::same * (polygon.uv.colwise().maxCoeff() - polygon.uv.colwise().minCoeff()).maxCoeff();
  for (Index k = 0; k < row; ++k)
    if ((polygon.uv.row(k) - uv).norm() <= near) {
      if (k >= polygon.rim) polygon.points.row(k) = point;
      return true;
    }
  std::vector<std::array<Index, 3>> kept;
  for (const std::array<Index, 3>& t : polygon.triangles) {
    std::array<double, 3> height{};  // over the edge opposite each corner
    for (int k = 0; k < 3; ++k) {
      const Eigen::RowVector2d from = polygon.uv.row(t[(k + 1) % 3]) - uv, to = polygon.uv.row(t[(k + 2) % 3]) - uv;
      height[k] = (from[0] * to[1] - from[1] * to[0]) / (to - from).norm();
    }
    if (*std::min_element(height.begin(), height.end()) < -near) {
      kept.push_back(t);
      continue;
    }
    for (int k = 0; k < 3; ++k)
      if (height[k] > near) kept.push_back({t[(k + 1) % 3], t[(k + 2) % 3], row});
  }
  if (!is_inside_one_ring(kept, row)) return false;
  polygon.triangles = std::move(kept);
  polygon.uv.conservativeResize(row + 1, 2);
  polygon.uv.row(row) = uv;
  polygon.points.conservativeResize(row + 1, 3);
  polygon.points.row(row) = point;
  return true;
}

double triangles_wanted(const PlanePolygon& polygon, std::optional<int> resolution) {
  check(polygon, resolution);
  return Sizes(polygon, resolution).triangles(polygon);
}

PlaneTriangulation remesh(const PlanePolygon& polygon, std::optional<int> resolution, const Surface& surface,
                          const MostTriangles& most) {
  check(polygon, resolution);
  return PlaneRemesher(polygon, resolution, surface).run(most);
}

}  // namespace tripatch
