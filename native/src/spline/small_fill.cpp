#include "tripatch/spline/small_fill.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "tripatch/constructions/methods.h"
#include "tripatch/creases/walls.h"
#include "tripatch/estimate/long_edges.h"
#include "tripatch/math/angle.h"
#include "tripatch/math/height_models.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/report/dihedrals.h"
#include "tripatch/report/folded_triangles.h"

namespace tripatch {
namespace {

/// Of the error at samples of the rim that are predicted by the others, from one side: that at the new vertices, which lie amid the rim.
constexpr double share_of_error = share::most;

using Triangle = std::array<int, 3>;

/// The rim, then the other vertices of the faces of two rings around it; and these faces.
struct TwoRings {
  std::vector<Index> vertices, faces;
};

TwoRings two_rings(const Connectivity& around, const std::vector<Index>& rim) {
  TwoRings near{rim, {}};
  std::vector<Index> known = rim;
  std::sort(known.begin(), known.end());
  std::size_t first = 0;
  for (int ring = 0; ring < 2; ++ring) {
    const std::size_t end = near.vertices.size();
    for (std::size_t k = first; k < end; ++k)
      for (const Connectivity::Corner c : around.at(near.vertices[k])) near.faces.push_back(around.face(c));
    std::sort(near.faces.begin(), near.faces.end());
    near.faces.erase(std::unique(near.faces.begin(), near.faces.end()), near.faces.end());
    std::vector<Index> found;
    for (const Index f : near.faces) {
      const IndicesRef face = around.faces()[f];
      found.insert(found.end(), face.begin(), face.end());
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    std::set_difference(found.begin(), found.end(), known.begin(), known.end(), std::back_inserter(near.vertices));
    known = std::move(found);
    first = end;
  }
  return near;
}

double square(double x) { return x * x; }
double cross_in_plane(const Vec2& a, const Vec2& b) { return a[0] * b[1] - a[1] * b[0]; }
double turn(const Vec2& a, const Vec2& b, const Vec2& c) { return cross_in_plane(b - a, c - a); }

/// The plane of the faces around, and what lies over it in units of the rim's mean edge.
struct Frame {
  Vec3 origin, u, v, normal;
  double unit = 1;

  Vec3 to(const Vec3& p) const {
    const Vec3 d = (p - origin) / unit;
    return {d.dot(u), d.dot(v), d.dot(normal)};
  }
  Vec3 from(const Vec2& place, double height) const { return origin + unit * (place[0] * u + place[1] * v + height * normal); }
  Vec3 normal_of(const Vec2& slope) const { return (normal - slope[0] * u - slope[1] * v).normalized(); }
};

/// Nothing where a face is turned from the plane, or from one next to it, as far as at a crease; but for needles.
std::optional<Frame> frame_of(const Mesh& mesh, const Connectivity& around, const TwoRings& near, std::size_t edges) {
  static const double min_cosine = std::cos(min_crease_angle);
  std::vector<Vec3> areas;  // zero of needles
  Vec3 sum = Vec3::Zero();
  for (const Index f : near.faces) {
    const IndicesRef face = mesh.faces[f];
    const Vec3 first = mesh.vertices.row(face[0]);
    Vec3 area = Vec3::Zero();
    for (std::size_t k = 2; k < face.size(); ++k)
      area += (Vec3(mesh.vertices.row(face[k - 1])) - first).cross(Vec3(mesh.vertices.row(face[k])) - first);
    double longest = 0;  // its square
    for (std::size_t k = 0; k < face.size(); ++k)
      longest = std::max(longest, (mesh.vertices.row(face[k]) - mesh.vertices.row(face[(k + 1) % face.size()])).squaredNorm());
    sum += area;
    areas.push_back(longest > needle_length * area.norm() ? Vec3(Vec3::Zero()) : area);
  }
  Frame frame;
  frame.normal = sum.normalized();
  const auto is_within = [&](const Vec3& a, const Vec3& b) { return a.dot(b) >= min_cosine * a.norm() * b.norm(); };
  for (std::size_t k = 0; k < areas.size(); ++k) {
    if (!is_within(areas[k], frame.normal)) return {};
    const IndicesRef face = mesh.faces[near.faces[k]];
    for (std::size_t i = 0; i < face.size(); ++i) {
      const auto beyond = around.edge(face[(i + 1) % face.size()], face[i]);
      if (!beyond) continue;
      const auto other = std::lower_bound(near.faces.begin(), near.faces.end(), around.face(*beyond)) - near.faces.begin();
      if (other < static_cast<std::ptrdiff_t>(k) && near.faces[other] == around.face(*beyond) &&
          !is_within(areas[k], areas[other]))
        return {};
    }
  }
  frame.u = frame.normal.unitOrthogonal();
  frame.v = frame.normal.cross(frame.u);
  frame.origin.setZero();
  double length = 0;
  for (std::size_t k = 0; k < edges; ++k) {
    const Vec3 a = mesh.vertices.row(near.vertices[k]), b = mesh.vertices.row(near.vertices[(k + 1) % edges]);
    frame.origin += a / static_cast<double>(edges);
    length += (b - a).norm();
  }
  frame.unit = length / static_cast<double>(edges);
  if (!(frame.unit > 0) || !frame.origin.allFinite()) return {};
  return frame;
}

std::vector<Vec3> samples_of(const Mesh& mesh, const TwoRings& near, const Frame& frame) {
  std::vector<Vec3> samples;
  for (const Index v : near.vertices) samples.push_back(frame.to(mesh.vertices.row(v)));
  return samples;
}

bool crosses_itself(const std::vector<Vec2>& rim) {
  const std::size_t n = rim.size();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 2; j < n; ++j) {
      if (i == 0 && j + 1 == n) continue;
      const Vec2 &a = rim[i], &b = rim[i + 1], &c = rim[j], &d = rim[(j + 1) % n];
      if (turn(a, b, c) * turn(a, b, d) <= 0 && turn(c, d, a) * turn(c, d, b) <= 0) return true;
    }
  return false;
}

/// Triangles in the plane: rows of `places`, the rim's first.
class SmallTriangulation {
public:
  SmallTriangulation(const Connectivity& around, const std::vector<Index>& rim, std::vector<Vec2> places)
      : around_(around), rim_(rim), places_(std::move(places)) {
    const std::size_t n = rim_.size();
    for (std::size_t k = 0; k < n; ++k)
      size_.push_back(0.5 * ((places_[(k + 1) % n] - places_[k]).norm() + (places_[(k + n - 1) % n] - places_[k]).norm()));
  }

  /// False where an edge of the mesh would be doubled, or rounding leaves no ear.
  bool make() {
    if (!cut_ears()) return false;
    flip();
    for (int added = 0; added < max_added && insert(); ++added) flip();
    for (int round = 0; round < smoothing_rounds; ++round) smooth();
    flip();
    return true;
  }
  const std::vector<Vec2>& places() const { return places_; }
  const std::vector<Triangle>& triangles() const { return triangles_; }

private:
  static constexpr int max_added = 2 * static_cast<int>(max_edges_of_small), smoothing_rounds = 3;
  /// Over what its ends ask for: between the diagonals of a square and of a regular pentagon, which gets a vertex inside.
  static constexpr double longest_edge = factor::slight;

  bool in_rim(int v) const { return static_cast<std::size_t>(v) < rim_.size(); }
  double area(const Triangle& t) const { return turn(places_[t[0]], places_[t[1]], places_[t[2]]); }
  bool is_in_mesh(int a, int b) const {
    if (!in_rim(a) || !in_rim(b)) return false;
    return around_.edge(rim_[a], rim_[b]).has_value() || around_.edge(rim_[b], rim_[a]).has_value();
  }

  bool cut_ears() {
    std::vector<int> left(rim_.size());
    for (std::size_t k = 0; k < left.size(); ++k) left[k] = static_cast<int>(k);
    while (left.size() > 3) {
      std::size_t best = left.size();
      double shortest = 0;
      const std::size_t n = left.size();
      for (std::size_t k = 0; k < n; ++k) {
        const Triangle ear = {left[(k + n - 1) % n], left[k], left[(k + 1) % n]};
        const double chord = (places_[ear[0]] - places_[ear[2]]).squaredNorm();
        if ((best < n && chord >= shortest) || !is_ear(ear, left) || is_in_mesh(ear[0], ear[2])) continue;
        best = k, shortest = chord;
      }
      if (best == n) return false;
      triangles_.push_back({left[(best + n - 1) % n], left[best], left[(best + 1) % n]});
      left.erase(left.begin() + static_cast<std::ptrdiff_t>(best));
    }
    triangles_.push_back({left[0], left[1], left[2]});
    return area(triangles_.back()) > tolerance::solved;
  }
  bool is_ear(const Triangle& ear, const std::vector<int>& left) const {
    if (!(area(ear) > tolerance::solved)) return false;
    for (const int v : left) {
      if (v == ear[0] || v == ear[1] || v == ear[2]) continue;
      const Vec2& p = places_[v];
      bool inside = true;
      for (int k = 0; k < 3; ++k) inside = inside && turn(places_[ear[k]], places_[ear[(k + 1) % 3]], p) >= 0;
      if (inside) return false;
    }
    return true;
  }

  /// To Delaunay's triangles, as far as the edges of the mesh allow.
  void flip() {
    bool again = true;
    for (int round = 0; again && round < 50; ++round) {
      again = false;
      for (std::size_t s = 0; s < triangles_.size(); ++s)
        for (std::size_t t = s + 1; t < triangles_.size(); ++t) again = flip(triangles_[s], triangles_[t]) || again;
    }
  }
  bool flip(Triangle& s, Triangle& t) const {
    const auto shared = shared_edge(s, t);
    if (!shared) return false;
    const auto [a, b] = *shared;
    const int c = s[0] + s[1] + s[2] - a - b, d = t[0] + t[1] + t[2] - a - b;
    const Triangle one = {c, d, b}, other = {d, c, a};
    if (!(area(one) > tolerance::solved && area(other) > tolerance::solved) || !is_nearer(a, b, c, d) || is_in_mesh(c, d))
      return false;
    s = one, t = other;
    return true;
  }
  /// Whether d is inside the circle around a, b and c, by the sum of the angles across the edge from a to b.
  bool is_nearer(int a, int b, int c, int d) const {
    const Vec2 ca = places_[a] - places_[c], cb = places_[b] - places_[c], da = places_[a] - places_[d],
               db = places_[b] - places_[d];
    const double sine_c = cross_in_plane(ca, cb), cosine_c = ca.dot(cb), sine_d = cross_in_plane(db, da), cosine_d = da.dot(db);
    return sine_c * cosine_d + cosine_c * sine_d <
           -tolerance::solved * std::sqrt(ca.squaredNorm() * cb.squaredNorm() * da.squaredNorm() * db.squaredNorm());
  }

  /// A vertex in the middle of the inner edge that is longest next to what its ends ask for, where that is too long.
  bool insert() {
    double most = longest_edge;
    std::array<std::size_t, 2> at{};
    std::array<int, 2> edge{};
    for (std::size_t s = 0; s < triangles_.size(); ++s)
      for (std::size_t t = s + 1; t < triangles_.size(); ++t)
        if (const auto shared = shared_edge(triangles_[s], triangles_[t])) {
          const auto [a, b] = *shared;
          const double length = 2 * (places_[a] - places_[b]).norm() / (size_[a] + size_[b]);
          if (length > most) most = length, at = {s, t}, edge = *shared;
        }
    if (most <= longest_edge) return false;
    const int added = static_cast<int>(places_.size());
    places_.emplace_back((places_[edge[0]] + places_[edge[1]]) / 2);
    size_.push_back((size_[edge[0]] + size_[edge[1]]) / 2);
    for (const std::size_t t : at) {
      Triangle other = triangles_[t];
      std::ranges::replace(triangles_[t], edge[0], added);
      std::ranges::replace(other, edge[1], added);
      triangles_.push_back(other);
    }
    return true;
  }
  /// The edge from a to b of s that is one from b to a of t.
  static std::optional<std::array<int, 2>> shared_edge(const Triangle& s, const Triangle& t) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        if (s[i] == t[(j + 1) % 3] && s[(i + 1) % 3] == t[j]) return std::array{s[i], s[(i + 1) % 3]};
    return {};
  }

  /// Each new vertex amid those next to it, where that turns no triangle over.
  void smooth() {
    std::vector<Vec2> sum(places_.size(), Vec2::Zero());
    std::vector<int> count(places_.size(), 0);
    for (const Triangle& t : triangles_)
      for (int k = 0; k < 3; ++k) {
        sum[t[k]] += places_[t[(k + 1) % 3]];
        ++count[t[k]];
      }
    const std::vector<Vec2> before = places_;
    for (std::size_t v = rim_.size(); v < places_.size(); ++v) places_[v] = sum[v] / count[v];
    if (!std::ranges::all_of(triangles_, [&](const Triangle& t) { return area(t) > tolerance::solved; })) places_ = before;
  }

  const Connectivity& around_;
  const std::vector<Index>& rim_;
  std::vector<Vec2> places_;
  std::vector<double> size_;
  std::vector<Triangle> triangles_;
};

/// The vertices next to the rim first, as many as there may be.
void keep_nearest(std::vector<Vec3>& samples, std::size_t rim) {
  if (samples.size() <= max_height_samples) return;
  const auto nearer = [](const Vec3& a, const Vec3& b) { return a.head<2>().squaredNorm() < b.head<2>().squaredNorm(); };
  std::nth_element(samples.begin() + static_cast<std::ptrdiff_t>(rim), samples.begin() + max_height_samples, samples.end(),
                   nearer);
  samples.resize(max_height_samples);
}

/// What is reported of a fill without a patch.
void complete(const Mesh& mesh, const Connectivity& around, Code reason, Fill& fill) {
  Report& report = fill.report;
  report.method = spline_method;
  report.method_reason = Message{reason};
  report.seam_angle_max_by_side.clear();
  report.seam_angle_rms_by_side.clear();
  report.continuity.clear();
  measure_dihedrals(mesh, around, fill);
}

}  // namespace

std::vector<SeenPlane> planes_of_small(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim) {
  const std::size_t r = rim.size();
  if (r > max_edges_of_small) return {};
  const TwoRings near = two_rings(around, rim);
  const std::optional<Frame> frame = frame_of(mesh, around, near, r);
  if (!frame) return {};
  std::vector<Vec3> samples = samples_of(mesh, near, *frame);
  keep_nearest(samples, r);
  if (samples.size() < 2 * quadric_terms) return {};
  const HeightQuadric quadric(samples, r);
  if (!std::isfinite(quadric.error())) return {};
  std::vector<SeenPlane> planes;
  for (std::size_t k = 0; k < r; ++k)
    planes.push_back({frame->normal_of(quadric.at(samples[k].head<2>()).tail<2>()), square(quadric.error())});
  return planes;
}

std::optional<Fill> fill_small(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim) {
  const std::size_t r = rim.size();
  const TwoRings near = two_rings(around, rim);
  const std::optional<Frame> frame = frame_of(mesh, around, near, r);
  if (!frame) return {};
  std::vector<Vec3> samples = samples_of(mesh, near, *frame);
  std::vector<Vec2> places;
  for (std::size_t k = 0; k < r; ++k) places.emplace_back(samples[k].head<2>());
  if (crosses_itself(places)) return {};
  SmallTriangulation made(around, rim, std::move(places));
  if (!made.make()) return {};

  Fill fill;
  const auto added = static_cast<Index>(made.places().size() - r);
  fill.rim = rim;
  fill.vertices.resize(added, 3);
  fill.normals.resize(added, 3);
  fill.uv.resize(added, 2);
  fill.rim_uv.resize(static_cast<Index>(r), 2);
  fill.rim_normals.resize(static_cast<Index>(r), 3);
  keep_nearest(samples, r);
  if (samples.size() < 2 * quadric_terms) return {};
  const HeightQuadric quadric(samples, r);
  double share = 0, error = quadric.error();  // of the spline; of both
  std::optional<HeightSpline> spline;
  if (added > 0) {
    spline.emplace(samples, r);
    const double q = square(quadric.error()), p = square(spline->error());
    share = q + p > 0 ? q / (q + p) : 1;
    error = std::sqrt(share * p);
  }
  if (!std::isfinite(error)) return {};
  const auto height_at = [&](const Vec2& place) -> Vec3 {
    return share > 0 ? Vec3((1 - share) * quadric.at(place) + share * spline->at(place)) : quadric.at(place);
  };
  for (std::size_t k = 0; k < r; ++k) {
    fill.rim_uv.row(static_cast<Index>(k)) = frame->unit * made.places()[k];
    fill.rim_normals.row(static_cast<Index>(k)) = frame->normal_of(height_at(made.places()[k]).tail<2>());
  }
  for (Index k = 0; k < added; ++k) {
    const Vec2& place = made.places()[r + static_cast<std::size_t>(k)];
    const Vec3 jet = height_at(place);
    fill.vertices.row(k) = frame->from(place, jet[0]);
    fill.normals.row(k) = frame->normal_of(jet.tail<2>());
    fill.uv.row(k) = frame->unit * place;
  }
  const Index n = mesh.vertices.rows();
  for (const Triangle& t : made.triangles()) {
    std::array<Index, 3> face;
    for (int k = 0; k < 3; ++k) face[k] = t[k] < static_cast<int>(r) ? rim[t[k]] : n + t[k] - static_cast<Index>(r);
    fill.faces.add(face);
  }
  fill.deviation = Eigen::VectorXd::Constant(added, share_of_error * frame->unit * error);
  if (added > 0) fill.report.deviation_max = fill.deviation.maxCoeff();
  complete(mesh, around, Code::is_small, fill);
  return fill;
}

std::optional<Fill> fill_with_one_triangle(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim) {
  Fill fill;
  fill.rim = rim;
  fill.faces.add(rim);
  fill.report.corners = rim;
  complete(mesh, around, Code::has_three_edges, fill);
  if (!(fill.report.seam_angle_max < folded_degrees)) return {};
  const Vec3 a = mesh.vertices.row(rim[0]), b = mesh.vertices.row(rim[1]), c = mesh.vertices.row(rim[2]);
  fill.rim_normals = (b - a).cross(c - a).normalized().transpose().replicate(3, 1);
  fill.rim_uv.resize(3, 2);
  const Vec3 along = (b - a).normalized(), across = fill.rim_normals.row(0).transpose().cross(along);
  fill.rim_uv << 0, 0, (b - a).norm(), 0, along.dot(c - a), across.dot(c - a);
  return fill;
}

}  // namespace tripatch
