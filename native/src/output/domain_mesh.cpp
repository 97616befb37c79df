#include "tripatch/output/domain_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "tripatch/math/interruption.h"
#include "tripatch/math/tolerances.h"

namespace tripatch {

namespace {

/// Of a triangle with these edges, `area` being twice its own.
double shape_by_edges(const Vec3& u, const Vec3& v, const Vec3& w, double area) {
  const double squares = u.squaredNorm() + v.squaredNorm() + w.squaredNorm();
  return squares > 0 ? 2 * std::sqrt(3.0) * area / squares : 0;
}

}  // namespace

double shape(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 u = b - a, v = c - a;
  return shape_by_edges(u, v, c - b, u.cross(v).norm());
}

bool DomainMesh::face_away(const TwoEdges& one, const TwoEdges& other) const {
  const double dot = one.normal.dot(other.normal);
  if (!(dot < 0)) return false;
  const double s = one.normal.norm(), t = other.normal.norm();
  if (!(dot < -tie * s * t)) return false;
  const auto has_area = [&](double area, const TwoEdges& edges) {
    const double a = edges.first.norm(), b = edges.second.norm();
    return area > tie * a * b && area > lowest_ * std::max(a, b);
  };
  return has_area(s, one) && has_area(t, other);
}

double DomainMesh::tie_between(const TwoEdges& one, const TwoEdges& other) const {
  const double shortest =
      std::min({one.first.squaredNorm(), one.second.squaredNorm(), other.first.squaredNorm(), other.second.squaredNorm()});
  return tie * tie * shortest < lowest_ * lowest_ ? lowest_ / std::sqrt(shortest) : tie;
}

std::size_t DomainMesh::alive_triangles() const {
  return static_cast<std::size_t>(
      std::count_if(triangles_.begin(), triangles_.end(), [](const Triangle& f) { return f.v[0] >= 0; }));
}

void DomainMesh::bound_triangles(double count, double edges, std::optional<int> resolution) {
  constexpr double per_squared_resolution = 2;  // a flat round hole with that many edges to a third of its rim: 9 / (4 pi 0.43)
  constexpr double far_too_many = 20;           // times what is asked for: a surface that needs them is distorted
  double most = 0, bound = 0;
  if (resolution) {
    const double asked = per_squared_resolution * *resolution * *resolution + edges;
    bound = far_too_many * asked;
    most = max_over * asked;
  } else {
    bound = triangles_per_squared_edge * edges * edges;
    most = std::min(std::max(max_triangles, 4 * edges), bound / 2);
  }
  if (count > most) coarser_ = std::sqrt(count / most);
  most_ = std::min(max_over * (std::min(count, most) + edges), bound);
  rows_ = std::max(1, resolution.value_or(1) / coarse_resolution);
  coarser_ *= rows_;
  most_ /= rows_ * rows_;
}

int DomainMesh::add_vertex(const Vec3& b, const Vec3& x) {
  b_.push_back(b);
  x_.push_back(x);
  size_.push_back(0);
  triangle_of_.push_back(-1);
  on_lattice_.push_back(0);
  return static_cast<int>(b_.size()) - 1;
}

void DomainMesh::set_lowest(double size) {
  Vec3 low = x_[0], high = x_[0];
  for (int v = 1; v < rim_; ++v) low = low.cwiseMin(x_[v]), high = high.cwiseMax(x_[v]);
  lowest_ = rounding * std::max(size, (high - low).maxCoeff());
}

void DomainMesh::limit_sizes() {
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
void DomainMesh::raise_beside_rim(double fall) {
  for (const Triangle& f : triangles_)
    for (int k = 0; k < 3 && f.v[0] >= 0; ++k) {
      const int a = f.v[(k + 1) % 3], b = f.v[(k + 2) % 3], apex = f.v[k];
      if (f.n[k] != at_rim || on_rim(apex) || !rim_is_complete(a, b)) continue;
      const Vec3 e = x_[b] - x_[a];
      const double height = e.cross(x_[apex] - x_[a]).norm() / std::max(e.norm(), tolerance::tiny);
      size_[apex] = std::max(size_[apex], e.norm() - fall * height);
    }
}

void DomainMesh::link(int t, int old_neighbor, int new_neighbor) {
  if (t < 0) return;
  for (int& n : triangles_[t].n)
    if (n == old_neighbor) {
      n = new_neighbor;
      return;
    }
}

void DomainMesh::split_edge(int t, int k, int m) {
  ring_of_ = -1;
  const int other = triangles_[t].n[k];
  auto halve = [&](int f, int j) {  // f keeps (apex, first, m); the new one is (apex, m, second)
    const int made = static_cast<int>(triangles_.size());
    Triangle& old = triangles_[f];
    const int apex = old.v[j], second = old.v[(j + 2) % 3], beyond = old.n[(j + 1) % 3];
    old.v[(j + 2) % 3] = m;
    old.n[(j + 1) % 3] = made;
    triangles_.push_back({{apex, m, second}, {old.n[j], beyond, f}});
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

void DomainMesh::look_at_all() {
  for (int t = 0; t < static_cast<int>(triangles_.size()); ++t)
    for (int k = 0; k < 3; ++k)
      if (alive(t) && t < triangles_[t].n[k]) dirty_.push_back({t, k});
}

void DomainMesh::flip_all() {
  std::size_t budget = looks_ * alive_triangles() + 1000;
  while (!dirty_.empty() && budget-- > 0) {
    check_interruption();
    const auto [t, k] = dirty_.back();
    dirty_.pop_back();
    const int o = alive(t) ? triangles_[t].n[k] : -1;
    if (o < 0) continue;
    Triangle &f = triangles_[t], &g = triangles_[o];
    const int j = slot(o, t);
    const int c = f.v[k], a = f.v[(k + 1) % 3], b = f.v[(k + 2) % 3], d = g.v[j];
    if (!valid(c, a, d) || !valid(c, d, b)) continue;
    if (!wants_flip(a, b, c, d)) continue;
    ring_of_ = -1;
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
  if (!dirty_.empty()) looks_ = few_looks;
  dirty_.clear();
}

const std::vector<DomainMesh::Corner>& DomainMesh::around(int v) {
  check_interruption();
  if (std::exchange(ring_of_, v) == v) return ring_;
  ring_.clear();
  int t = triangle_of_[v];
  do {
    const int k = corner_of(t, v);
    ring_.push_back({t, k});
    t = triangles_[t].n[(k + 1) % 3];
  } while (t != ring_.front().triangle);
  return ring_;
}

void DomainMesh::collapse_short() {
  std::vector<Edge> edges;  // triangle: the vertex that goes, k: where to
  for (int v = rim_; v < static_cast<int>(b_.size()); ++v) {
    if (triangle_of_[v] < 0 || is_fixed(v)) continue;
    for (const auto& [t, k] : around(v)) {
      const int w = triangles_[t].v[(k + 1) % 3];
      const double ratio = length(v, w) / (too_short * std::min(size_[v], size_[w]));
      if (ratio >= 1) continue;
      if (const double key = coarse(ratio); key < 1) edges.push_back({v, w, key});
    }
  }
  std::stable_sort(edges.begin(), edges.end(), [](const Edge& p, const Edge& q) {
    check_interruption();
    return p.excess < q.excess;
  });
  for (const Edge& e : edges) collapse(e.triangle, e.k);
}

bool DomainMesh::collapse(int v, int w) {
  if (triangle_of_[v] < 0 || (!on_rim(w) && triangle_of_[w] < 0)) return false;
  const std::vector<Corner>& ring = around(v);
  link_of_v_.clear();
  link_triangles_.clear();
  for (const auto& [t, k] : ring) {
    link_of_v_.push_back(triangles_[t].v[(k + 1) % 3]);
    link_triangles_.push_back(triangles_[t].n[k]);
  }
  const int n = static_cast<int>(ring.size());
  const int at = static_cast<int>(std::find(link_of_v_.begin(), link_of_v_.end(), w) - link_of_v_.begin());
  if (at == n) return false;
  double before = 1, after = 1;
  for (int i = 0; i < n; ++i) {
    const int p = link_of_v_[i], q = link_of_v_[(i + 1) % n];
    before = std::min(before, shape_of(v, p, q));
    if (p == w || q == w) continue;
    if (!valid(w, p, q) || !may_join(w, p) || !may_join(w, q)) return false;
    after = std::min(after, shape_of(w, p, q));
    if (p != link_of_v_[(at + 1) % n] && clearly_more(length(w, p), too_long * size_of_edge(w, p))) return false;
  }
  if (clearly_less(after, std::min(collapsed_shape, before))) return false;
  // ring[at] = (v, w, next) and ring[at - 1] = (v, previous, w) go
  const int gone = ring[at].triangle, gone2 = ring[(at + n - 1) % n].triangle;
  const int next = link_of_v_[(at + 1) % n], previous = link_of_v_[(at + n - 1) % n];
  const int inside = ring[(at + 1) % n].triangle, inside2 = ring[(at + n - 2) % n].triangle;
  const int outside = link_triangles_[at], outside2 = link_triangles_[(at + n - 1) % n];
  link(inside, gone, outside);
  link(outside, gone, inside);
  link(inside2, gone2, outside2);
  link(outside2, gone2, inside2);
  for (int i = 2; i < n; ++i) {
    const int t = ring[(at + i - 1) % n].triangle;
    for (int& corner : triangles_[t].v)
      if (corner == v) corner = w;
    for (int k = 0; k < 3; ++k) dirty_.push_back({t, k});
  }
  triangles_[gone].v[0] = triangles_[gone2].v[0] = -1;
  triangle_of_[w] = triangle_of_[next] = inside;
  triangle_of_[previous] = inside2;
  triangle_of_[v] = -1;
  ring_of_ = -1;
  return true;
}

/// By the plane's coordinates of the neighbors, made orthogonal first: sums of their squares alone have lost the digits of how vertices lie
/// across a strip.
std::optional<DomainMesh::Way> DomainMesh::way_of(int v) {
  Vec3 center = Vec3::Zero();
  double weights = 0, uu = 0, uv = 0;
  spokes_.clear();
  for (const auto& [t, k] : around(v)) {
    const Triangle& f = triangles_[t];
    const int p = f.v[(k + 1) % 3], q = f.v[(k + 2) % 3];
    const double size = (size_[v] + size_[p] + size_[q]) / 3;
    const Vec3 x = x_[p] - x_[v];
    const double w = x.cross(x_[q] - x_[v]).norm() / (size * size);
    center += w * (x_[p] + x_[q] - 2 * x_[v]) / 3;
    weights += w;
    const Vec2 along = (b_[p] - b_[v]).tail<2>();
    const double near = 1 / std::max(x.squaredNorm(), tolerance::tiny);
    uu += near * along[0] * along[0];
    uv += near * along[0] * along[1];
    spokes_.push_back({x, along, near});
  }
  if (!(weights > 0) || !(uu > 0)) return {};
  const double lean = uv / uu;
  double across = 0;
  Vec3 by_u = Vec3::Zero(), by_across = Vec3::Zero();
  for (const auto& [x, along, near] : spokes_) {
    const double off = along[1] - lean * along[0];
    across += near * off * off;
    by_u += near * along[0] * x;
    by_across += near * off * x;
  }
  if (!(across > 0)) return {};
  by_u /= uu;
  by_across /= across;  // x = by_u u + by_across (v - lean u)
  const Vec3 x_u = by_u - lean * by_across;
  const double xx = x_u.squaredNorm(), yy = by_across.squaredNorm(), xy = x_u.dot(by_across);
  if (!(x_u.cross(by_across).squaredNorm() > tolerance::rounding * (xx * xx + yy * yy + 2 * xy * xy))) return {};
  const double length = by_u.squaredNorm(), turn = by_u.dot(by_across) / length;
  const Vec3 aside = by_across - turn * by_u, to = center / weights;
  const double off = aside.dot(to) / aside.squaredNorm(), along = by_u.dot(to) / length - turn * off;
  return Way{Vec2(along, off + lean * along), by_u * (along + turn * off) + aside * off};
}

bool DomainMesh::star_is_valid(int v, const Vec3& b) {
  for (const auto& [t, k] : around(v)) {
    const Triangle& f = triangles_[t];
    if (!positive(b, b_[f.v[(k + 1) % 3]], b_[f.v[(k + 2) % 3]])) return false;
  }
  return true;
}

double DomainMesh::star_quality(int v, const Vec3& x) {
  Vec3 facing = Vec3::Zero();
  double areas = 0;
  star_.clear();
  for (const auto& [t, k] : around(v)) {
    const Triangle& f = triangles_[t];
    const Vec3 &p = x_[f.v[(k + 1) % 3]], &q = x_[f.v[(k + 2) % 3]];
    const TwoEdges edges(p - x, q - x);
    const double area = edges.normal.norm();
    facing += edges.normal;
    areas += area;
    star_.push_back({edges.normal, area, shape_by_edges(edges.first, edges.second, q - p, area)});
  }
  double worst = 1;
  for (const auto& [normal, area, shape] : star_) {
    const bool faces_away = normal.dot(facing) < -tie * areas * area;  // not at a right angle
    worst = std::min(worst, faces_away ? -shape : shape);
  }
  return worst;
}

bool DomainMesh::can_split(int t, int k, const Vec3& m) const {
  const Triangle& f = triangles_[t];
  const int a = f.v[(k + 1) % 3], b = f.v[(k + 2) % 3], c = f.v[k], d = triangles_[f.n[k]].v[slot(f.n[k], t)];
  return positive(b_[c], b_[a], m) && positive(b_[c], m, b_[b]) && positive(b_[d], b_[b], m) && positive(b_[d], m, b_[a]);
}

}  // namespace tripatch
