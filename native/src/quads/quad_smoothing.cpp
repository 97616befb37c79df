#include "tripatch/quads/quad_smoothing.h"

#include <Eigen/Geometry>
#include <Eigen/Sparse>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>

#include "tripatch/math/interruption.h"
#include "tripatch/math/simd.h"
#include "tripatch/math/sparse_ldlt.h"

namespace tripatch {
namespace {

// Other numbers were tried on quads between four, five and six sides of a wavy saddle. Reported is by how much of the diameter a vertex of
// one of them moves at most; "0" says that no vertex does.
/// Distortions count with this power: high enough for the worst corner to lead, low enough for Newton's steps to converge (5e-4 with 2).
constexpr int distortion_power = 3;
/// In the end the least angle leads: (1 / sin)^2 counts with this power (of two), and next to it how even the spacing is.
constexpr int sharp_power = 8;
constexpr double spacing = 0.25;  ///< weight of the evenness, a choice
/// Of the shortest edge at a vertex: no step is longer, beyond it the surface's second order says little (0 with half).
constexpr double longest_step = 0.4;
/// Of the larger eigenvalue of a Hessian: where the smaller one is less it becomes that share (0 with a tenth, 0 with half).
constexpr double min_convex = 1e-3, made_convex = 0.1;
constexpr int halvings = 6;  ///< of a Newton step that makes things worse, before it is left out (0 with three)
/// Between two evaluations of the surface, whose second order is good for small moves (5e-5 with two).
constexpr int sweeps_a_metric = 5;
/// Of a mean corner's area: below it a corner counts as turned over and is pulled back by a smooth bound of that size (0 with a tenth).
constexpr double min_area = 1e-3;

/// As sweeps of a cover, but of what is only compared: half of them take the same layouts of four to six sides of a saddle.
constexpr int sweeps_of_trials = 4, angles_of_trials = 5;
/// What an irregular vertex may cost the least scaled Jacobian: below that one more is not worth it.
constexpr double pole_price = 0.02, mean_weight = 0.3;

double square(double x) { return x * x; }

using Edge = std::array<Index, 2>;
Edge edge_of(Index a, Index b) { return {std::min(a, b), std::max(a, b)}; }

/// Widths of rows of quads: of each edge that of the row that it lies across.
class RowWidths {
public:
  /// round: of rows that go round and have no ends; none: the mean length of their edges.
  RowWidths(const Faces& faces, Index rim_count, const Points& positions, std::optional<double> round = {}) {
    for (Index f = 0; f < faces.size(); ++f) {
      check_interruption();
      for (std::size_t k = 0, m = faces[f].size(); k < m; ++k) number(edge_of(faces[f][k], faces[f][(k + 1) % m]));
    }
    std::vector<Index> root(number_.size());
    std::iota(root.begin(), root.end(), Index{0});
    const auto find = [&](Index e) {
      while (root[e] != e) e = root[e] = root[root[e]];
      return e;
    };
    for (Index f = 0; f < faces.size(); ++f) {
      const auto q = faces[f];
      if (q.size() != 4) continue;
      for (int k : {0, 1}) root[find(number(edge_of(q[k], q[k + 1])))] = find(number(edge_of(q[k + 2], q[(k + 3) % 4])));
    }
    std::vector<double> sum(root.size(), 0), all(root.size(), 0);
    std::vector<Index> ends(root.size(), 0), edges(root.size(), 0);
    for (const auto& [edge, e] : number_) {
      const double length = (positions.row(edge[0]) - positions.row(edge[1])).norm();
      const bool rim = edge[1] < rim_count && (edge[1] - edge[0] == 1 || edge[1] - edge[0] == rim_count - 1);
      const Index row = find(e);
      all[row] += length;
      ++edges[row];
      if (!rim) continue;
      sum[row] += std::log(length);
      ++ends[row];
    }
    width_.resize(root.size());
    for (std::size_t e = 0; e < root.size(); ++e) {
      const Index row = find(static_cast<Index>(e));
      width_[e] = ends[row] > 0 ? std::exp(sum[row] / static_cast<double>(ends[row]))
                                : round.value_or(all[row] / static_cast<double>(edges[row]));
    }
  }

  double at(Index a, Index b) const { return width_[number_.at(edge_of(a, b))]; }
  const std::map<Edge, Index>& edges() const { return number_; }
  double width(Index e) const { return width_[e]; }

private:
  Index number(const Edge& edge) { return number_.try_emplace(edge, static_cast<Index>(number_.size())).first->second; }
  std::map<Edge, Index> number_;
  std::vector<double> width_;
};

Points in_plane(const PlanePoints& uv) {
  Points rows = Points::Zero(uv.rows(), 3);
  rows.leftCols(2) = uv;
  return rows;
}

/// A function of two variables to second order about a place: its value, by u, by v, and the halves of uu, all of uv and of vv. As Jet<2>
/// to the last bit, but inlined, and what does not change is a number: Newton's steps are nearly all of the time that quads take.
struct Second {
  double value = 0, u = 0, v = 0, uu = 0, uv = 0, vv = 0;

  [[gnu::always_inline]] friend inline Second operator+(const Second& a, const Second& b) {
    return {a.value + b.value, a.u + b.u, a.v + b.v, a.uu + b.uu, a.uv + b.uv, a.vv + b.vv};
  }
  [[gnu::always_inline]] friend inline Second operator-(const Second& a, const Second& b) {
    return {a.value - b.value, a.u - b.u, a.v - b.v, a.uu - b.uu, a.uv - b.uv, a.vv - b.vv};
  }
  [[gnu::always_inline]] friend inline Second operator+(Second a, double b) {
    a.value += b;
    return a;
  }
  [[gnu::always_inline]] friend inline Second operator+(double b, const Second& a) { return a + b; }
  [[gnu::always_inline]] friend inline Second operator*(double s, const Second& a) {
    return {s * a.value, s * a.u, s * a.v, s * a.uu, s * a.uv, s * a.vv};
  }
  [[gnu::always_inline]] friend inline Second operator*(const Second& a, double s) { return s * a; }
  [[gnu::always_inline]] friend inline Second operator*(const Second& a, const Second& b) {
    return {a.value * b.value,
            a.value * b.u + a.u * b.value,
            a.value * b.v + a.v * b.value,
            a.value * b.uu + a.u * b.u + a.uu * b.value,
            a.value * b.uv + a.u * b.v + a.v * b.u + a.uv * b.value,
            a.value * b.vv + a.v * b.v + a.vv * b.value};
  }
  /// f(a) by f, f' and f''/2 at a's value.
  [[gnu::always_inline]] friend inline Second composed(const std::array<double, 3>& f, const Second& a) {
    const double u = f[2] * a.u, v = f[2] * a.v;
    return {f[0], f[1] * a.u, f[1] * a.v, f[1] * a.uu + u * a.u, f[1] * a.uv + u * a.v + v * a.u, f[1] * a.vv + v * a.v};
  }
};

[[gnu::always_inline]] inline Second one_over(const Second& a) {
  const double f = 1 / a.value, slope = -f * f;
  return composed({f, slope, -slope * f}, a);
}
Second root_of(const Second& a) {
  const double f = std::sqrt(a.value), slope = f * 0.5 / a.value;
  return composed({f, slope, slope * -0.5 / (2 * a.value)}, a);
}
double root_of(double x) { return std::sqrt(x); }
[[gnu::always_inline]] inline Second ratio(const Second& a, const Second& b) { return a * one_over(b); }
Second ratio(const Second& a, double b) { return a * (1 / b); }
Second ratio(double a, const Second& b) { return a * one_over(b); }
double ratio(double a, double b) { return a / b; }

#ifdef TRIPATCH_PACKS
/// The same of four corners at a time, in the same order of operations and with nothing fused: to the last bit. Written again, for what is
/// inlined must be marked for these machines, or it is taken apart into halves before it gets there.
namespace packed {

struct Second {
  Pack value, u, v, uu, uv, vv;

  TRIPATCH_PACKED_INLINE friend Second operator+(const Second& a, const Second& b) {
    return {a.value + b.value, a.u + b.u, a.v + b.v, a.uu + b.uu, a.uv + b.uv, a.vv + b.vv};
  }
  TRIPATCH_PACKED_INLINE friend Second operator-(const Second& a, const Second& b) {
    return {a.value - b.value, a.u - b.u, a.v - b.v, a.uu - b.uu, a.uv - b.uv, a.vv - b.vv};
  }
  TRIPATCH_PACKED_INLINE friend Second operator+(const Second& a, const Pack& b) {
    return {a.value + b, a.u, a.v, a.uu, a.uv, a.vv};
  }
  TRIPATCH_PACKED_INLINE friend Second operator+(const Pack& b, const Second& a) { return a + b; }
  TRIPATCH_PACKED_INLINE friend Second operator*(const Pack& s, const Second& a) {
    return {s * a.value, s * a.u, s * a.v, s * a.uu, s * a.uv, s * a.vv};
  }
  TRIPATCH_PACKED_INLINE friend Second operator*(const Second& a, const Pack& s) { return s * a; }
  TRIPATCH_PACKED_INLINE friend Second operator*(const Second& a, const Second& b) {
    return {a.value * b.value,
            a.value * b.u + a.u * b.value,
            a.value * b.v + a.v * b.value,
            a.value * b.uu + a.u * b.u + a.uu * b.value,
            a.value * b.uv + a.u * b.v + a.v * b.u + a.uv * b.value,
            a.value * b.vv + a.v * b.v + a.vv * b.value};
  }
};

TRIPATCH_PACKED_INLINE Pack one_over(const Pack& x) { return 1 / x; }
TRIPATCH_PACKED_INLINE Second one_over(const Second& a) {
  const Pack f = 1 / a.value, slope = -f * f, bend = -slope * f, u = bend * a.u, v = bend * a.v;
  return {f, slope * a.u, slope * a.v, slope * a.uu + u * a.u, slope * a.uv + u * a.v + v * a.u, slope * a.vv + v * a.v};
}
TRIPATCH_PACKED_INLINE Pack ratio(const Pack& a, const Pack& b) { return a / b; }
template <class A, class B>
TRIPATCH_PACKED_INLINE auto ratio(const A& a, const B& b) {
  return a * one_over(b);
}

template <class T>
struct Arm {
  T to[3];
  T square;
};
template <class T>
TRIPATCH_PACKED_INLINE Arm<T> arm_of(const T (&to)[3]) {
  return {{to[0], to[1], to[2]}, to[0] * to[0] + to[1] * to[1] + to[2] * to[2]};
}
/// Each lane of its own scale.
TRIPATCH_PACKED_INLINE Arm<Pack> arm_between(const Pack& scale, const Pack (&from)[3], const Pack (&to)[3]) {
  const Pack way[3] = {scale * (to[0] - from[0]), scale * (to[1] - from[1]), scale * (to[2] - from[2])};
  return arm_of(way);
}
/// From where a vertex moves.
TRIPATCH_PACKED_INLINE Second way_from(const Pack& scale, const Second& moving, const Pack& to) {
  return scale * Second{to - moving.value, -moving.u, -moving.v, -moving.uu, -moving.uv, -moving.vv};
}
TRIPATCH_PACKED_INLINE Arm<Second> arm_from(const Pack& scale, const Second (&moving)[3], const Pack (&to)[3]) {
  const Second way[3] = {way_from(scale, moving[0], to[0]), way_from(scale, moving[1], to[1]), way_from(scale, moving[2], to[2])};
  return arm_of(way);
}
TRIPATCH_PACKED_INLINE Arm<Second> backwards(const Arm<Second>& arm) {
  const Pack minus = all_lanes(-1);
  return {{minus * arm.to[0], minus * arm.to[1], minus * arm.to[2]}, arm.square};
}

/// As Smoother's, between edges of quads none of which is turned over.
template <class A, class B>
TRIPATCH_PACKED_INLINE auto distortion(const Pack (&n)[3], const Arm<A>& next, const Arm<B>& last, bool in_space, bool sharp) {
  const auto &a = next.to, &b = last.to;
  auto area = a[0] * b[1] - a[1] * b[0];
  if (in_space) area = n[0] * (a[1] * b[2] - a[2] * b[1]) + n[1] * (a[2] * b[0] - a[0] * b[2]) + n[2] * area;
  if (sharp) {
    auto power = ratio(next.square * last.square, area * area);
    for (int k = 1; k < sharp_power; k *= 2) power = power * power;
    const auto shape = ratio(next.square, last.square);
    return power + all_lanes(spacing) * (shape + one_over(shape));
  }
  const auto once = all_lanes(0.5) * ratio(next.square + last.square, area);
  auto power = once;
  for (int k = 1; k < distortion_power; ++k) power = power * once;
  return power;
}

}  // namespace packed
#endif

template <class T>
using Vector = std::array<T, 3>;
template <class A, class B>
auto dot(const Vector<A>& a, const Vector<B>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Moves vertices one after the other.
class Smoother {
public:
  Smoother(PlaneLayout& layout, const Surface* surface, const Points* border, const std::vector<Index>& held)
      : layout_(layout),
        surface_(surface),
        border_(border),
        at_(layout.uv.rows()),
        beside_(layout.uv.rows()),
        held_(layout.uv.rows(), false) {
    for (Index v : held) held_[v] = true;
    read_surface();
    const RowWidths widths(layout.faces, layout.rim, positions());
    for (Index f = 0; f < layout.faces.size(); ++f) {
      check_interruption();
      const auto face = layout.faces[f];
      const std::size_t m = face.size();
      for (std::size_t k = 0; k < m; ++k) {
        const Index v = face[k], next = face[(k + 1) % m], last = face[(k + m - 1) % m];
        const Corner corner = {{v, next, last}, 1 / widths.at(v, next), 1 / widths.at(v, last), m == 3};
        for (int is = 0; is < 3; ++is)
          if (corner.v[is] >= layout.rim) at_[corner.v[is]].push_back(own(corner, is));
        corners_.push_back(corner);
      }
    }
    for (std::vector<Own>& all : at_)
      std::stable_sort(all.begin(), all.end(), [](const Own& a, const Own& b) { return a.is < b.is; });
  }

  void run(int sweeps, int sharpening) {
    for (int sweep = 0; sweep < sweeps + sharpening; ++sweep) {
      check_interruption();
      if (surface_ && sweep > 0 && sweep % sweeps_a_metric == 0) read_surface();
      bound_ = 0;
      for (const Corner& corner : corners_)
        if (area(corner) < min_area) bound_ = min_area;
      sharp_ = sweep >= sweeps && bound_ == 0;
      for (Index v = layout_.rim; v < layout_.uv.rows(); ++v)
        if (!held_[v]) move(v);
    }
  }

private:
  struct Corner {
    std::array<Index, 3> v;  ///< itself, the next and the last of its face
    double next, last;       ///< one over the widths of these edges
    bool triangle;
  };
  /// A corner as one of its vertices sees it: which of the three it is, and its arms that end there, among those of the vertex.
  struct Own {
    Index corner;
    int is;
    std::size_t next, last;
  };
  struct Beside {
    Index vertex;
    double scale;  ///< one over the width of the edge to it
  };
  using Taylor = Eigen::Matrix<double, 6, 3, Eigen::RowMajor>;

  Own own(const Corner& corner, int is) {
    const Index c = static_cast<Index>(corners_.size()), v = corner.v[is];
    if (is == 0) return {c, is, arm_to(v, corner.v[1], corner.next), arm_to(v, corner.v[2], corner.last)};
    const std::size_t arm = arm_to(v, corner.v[0], is == 1 ? corner.next : corner.last);
    return {c, is, arm, arm};
  }
  /// The place of a neighbor among those of a vertex.
  std::size_t arm_to(Index v, Index neighbor, double scale) {
    std::vector<Beside>& all = beside_[v];
    const auto found = std::find_if(all.begin(), all.end(), [&](const Beside& each) { return each.vertex == neighbor; });
    const std::size_t place = static_cast<std::size_t>(found - all.begin());
    if (found == all.end()) all.push_back({neighbor, scale});
    return place;
  }

  /// The surface about the vertices; what does not move, those of the rim, the first time only.
  void read_surface() {
    const Index n = layout_.uv.rows(), first = taylor_.empty() ? 0 : layout_.rim;
    taylor_.resize(n, Taylor::Zero());
    normal_.resize(n, Vec3::UnitZ());
    x_.resize(n);
    base_ = layout_.uv;
    const Points rows = in_plane(layout_.uv.bottomRows(n - first));
    if (surface_) {
      surface_->evaluate(rows.data(), n - first, 2, taylor_[first].data());
      for (Index v = first; v < n; ++v) normal_[v] = Vec3(taylor_[v].row(1)).cross(Vec3(taylor_[v].row(2))).stableNormalized();
      for (Index v = first; border_ && v < layout_.rim; ++v) taylor_[v].row(0) = border_->row(v);
    } else {
      for (Index v = first; v < n; ++v) {
        taylor_[v].row(0) = rows.row(v - first);
        taylor_[v].row(1) = Vec3::UnitX();
        taylor_[v].row(2) = Vec3::UnitY();
      }
    }
    for (Index v = first; v < n; ++v) x_[v] = taylor_[v].row(0);
  }

  Points positions() const {
    Points all(static_cast<Index>(x_.size()), 3);
    for (std::size_t v = 0; v < x_.size(); ++v) all.row(static_cast<Index>(v)) = x_[v];
    return all;
  }

  Vec3 position(Index v, const Eigen::Vector2d& d) const {
    Eigen::Matrix<double, 1, 6> powers;
    powers << 1, d[0], d[1], d[0] * d[0], d[0] * d[1], d[1] * d[1];
    return (powers * taylor_[v]).transpose();
  }

  double area(const Corner& c) const {
    return c.next * c.last * normal_[c.v[0]].dot((x_[c.v[1]] - x_[c.v[0]]).cross(x_[c.v[2]] - x_[c.v[0]]));
  }

  /// An edge of a corner over its row's width, and the square of its length.
  template <class T>
  struct Arm {
    Vector<T> to;
    T square;
  };
  static Arm<double> arm(double scale, const Vec3& from, const Vec3& to) {
    const Vec3 e = scale * (to - from);
    return {{e[0], e[1], e[2]}, e[0] * e[0] + e[1] * e[1] + e[2] * e[2]};
  }
  Arm<Second> backwards(const Arm<Second>& arm) const {
    return {{-1.0 * arm.to[0], -1.0 * arm.to[1], -1.0 * arm.to[2]}, arm.square};
  }

  template <class A, class B>
  auto area_between(const Vec3& n, const Vector<A>& a, const Vector<B>& b) const {
    const auto up = a[0] * b[1] - a[1] * b[0];
    if (!surface_) return up;
    return n[0] * (a[1] * b[2] - a[2] * b[1]) + n[1] * (a[2] * b[0] - a[0] * b[2]) + n[2] * up;
  }

  /// 1 for a right angle between edges as long as their rows are wide (a triangle: equal ones), infinite where it is flat; a power.
  template <class A, class B>
  auto distortion(const Corner& corner, const Arm<A>& next, const Arm<B>& last) const {
    auto area = area_between(normal_[corner.v[0]], next.to, last.to);
    using T = decltype(area);
    if (sharp_) {
      if (corner.triangle) area = (2 / std::sqrt(3.0)) * area;  // of two equal edges: 1 for 60 degrees
      T power = ratio(next.square * last.square, area * area);
      for (int k = 1; k < sharp_power; k *= 2) power = power * power;
      const T shape = ratio(next.square, last.square);
      return power + spacing * (shape + ratio(1.0, shape));
    }
    T size = next.square + last.square;
    if (corner.triangle) size = (2 / std::sqrt(3.0)) * (size - dot(next.to, last.to));
    if (bound_ > 0) area = 0.5 * (area + root_of(area * area + 4 * bound_ * bound_));
    const T once = 0.5 * ratio(size, area);
    T power = once;
    for (int k = 1; k < distortion_power; ++k) power = power * once;
    return power;
  }

#ifdef TRIPATCH_PACKS
  /// Whether the corners at a vertex can be looked at by fours: all of quads, none turned over.
  bool in_packs(Index v) const {
    static const bool are_there = __builtin_cpu_supports("avx2");
    return are_there && bound_ == 0 &&
           std::ranges::none_of(at_[v], [&](const Own& own) { return corners_[own.corner].triangle; });
  }

  /// Up to four corners at a vertex which see it alike; beyond the last it again.
  struct Four {
    std::array<const Corner*, lanes> corner;
    int is;
    std::size_t count;
  };
  Four four_from(const std::vector<Own>& all, std::size_t first) const {
    Four four = {{}, all[first].is, 0};
    for (int l = 0; l < lanes; ++l) {
      const std::size_t next = first + four.count;
      if (next < all.size() && all[next].is == four.is) ++four.count;
      four.corner[l] = &corners_[all[first + four.count - 1].corner];
    }
    return four;
  }
  TRIPATCH_PACKED_INLINE static void gather(const Four& four, int k, const std::vector<Vec3>& rows, Pack (&out)[3]) {
    const Vec3 &a = rows[four.corner[0]->v[k]], &b = rows[four.corner[1]->v[k]], &c = rows[four.corner[2]->v[k]],
               &d = rows[four.corner[3]->v[k]];
    for (int x = 0; x < 3; ++x) out[x] = Pack{a[x], b[x], c[x], d[x]};
  }
  TRIPATCH_PACKED_INLINE static Pack next_scales(const Four& four) {
    return Pack{four.corner[0]->next, four.corner[1]->next, four.corner[2]->next, four.corner[3]->next};
  }
  TRIPATCH_PACKED_INLINE static Pack last_scales(const Four& four) {
    return Pack{four.corner[0]->last, four.corner[1]->last, four.corner[2]->last, four.corner[3]->last};
  }

  /// The distortions at a vertex that moves, in the order of its corners.
  TRIPATCH_PACKED Second sum_in_packs(Index v, const Vector<Second>& moving) const {
    packed::Second way[3];
    for (int x = 0; x < 3; ++x) {
      const Second& m = moving[x];
      way[x] = {all_lanes(m.value), all_lanes(m.u), all_lanes(m.v), all_lanes(m.uu), all_lanes(m.uv), all_lanes(m.vv)};
    }
    const std::vector<Own>& all = at_[v];
    const bool in_space = surface_ != nullptr;
    Second sum;
    for (std::size_t first = 0; first < all.size();) {
      const Four four = four_from(all, first);
      const Pack next = next_scales(four), last = last_scales(four);
      Pack normal[3], own[3], one[3], other[3];
      gather(four, 0, normal_, normal);
      gather(four, 0, x_, own);
      gather(four, 1, x_, one);
      gather(four, 2, x_, other);
      packed::Second found;
      if (four.is == 0) {
        found =
            packed::distortion(normal, packed::arm_from(next, way, one), packed::arm_from(last, way, other), in_space, sharp_);
      } else if (four.is == 1) {
        found = packed::distortion(normal, packed::backwards(packed::arm_from(next, way, own)),
                                   packed::arm_between(last, own, other), in_space, sharp_);
      } else {
        found = packed::distortion(normal, packed::arm_between(next, own, one),
                                   packed::backwards(packed::arm_from(last, way, own)), in_space, sharp_);
      }
      for (std::size_t l = 0; l < four.count; ++l)
        sum = sum + Second{found.value[l], found.u[l], found.v[l], found.uu[l], found.uv[l], found.vv[l]};
      first += four.count;
    }
    return sum;
  }

  TRIPATCH_PACKED double cost_in_packs(Index v, const Vec3& x) const {
    const std::vector<Own>& all = at_[v];
    double sum = 0;
    for (std::size_t first = 0; first < all.size();) {
      const Four four = four_from(all, first);
      Pack normal[3], at[3][3];
      gather(four, 0, normal_, normal);
      for (int k = 0; k < 3; ++k) gather(four, k, x_, at[k]);
      for (int axis = 0; axis < 3; ++axis) at[four.is][axis] = all_lanes(x[axis]);
      const Pack found = packed::distortion(normal, packed::arm_between(next_scales(four), at[0], at[1]),
                                            packed::arm_between(last_scales(four), at[0], at[2]), surface_ != nullptr, sharp_);
      for (std::size_t l = 0; l < four.count; ++l) {
        if (!(found[l] > 0)) return INFINITY;
        sum += found[l];
      }
      first += four.count;
    }
    return sum;
  }
#endif

  double cost_at(Index v, const Vec3& x) const {
#ifdef TRIPATCH_PACKS
    if (in_packs(v)) return cost_in_packs(v, x);
#endif
    double sum = 0;
    const auto place = [&](Index w) -> const Vec3& { return w == v ? x : x_[w]; };
    for (const Own& own : at_[v]) {
      const Corner& corner = corners_[own.corner];
      const Vec3& at = place(corner.v[0]);
      const double value = distortion(corner, arm(corner.next, at, place(corner.v[1])), arm(corner.last, at, place(corner.v[2])));
      if (!(value > 0)) return INFINITY;
      sum += value;
    }
    return sum;
  }

  /// The arms from a vertex to its neighbors, where it moves.
  void read_arms(Index v, const Vector<Second>& moving) {
    arms_.resize(beside_[v].size());
    for (std::size_t k = 0; k < arms_.size(); ++k) {
      const auto& [w, scale] = beside_[v][k];
      for (int x = 0; x < 3; ++x) {
        const Second& m = moving[x];
        arms_[k].to[x] = scale * Second{x_[w][x] - m.value, -m.u, -m.v, -m.uu, -m.uv, -m.vv};
      }
      arms_[k].square = dot(arms_[k].to, arms_[k].to);
    }
  }

  Second distortion_of(const Own& own) const {
    const Corner& corner = corners_[own.corner];
    const auto place = [&](int k) -> const Vec3& { return x_[corner.v[k]]; };
    if (own.is == 0) return distortion(corner, arms_[own.next], arms_[own.last]);
    if (own.is == 1) return distortion(corner, backwards(arms_[own.next]), arm(corner.last, place(0), place(2)));
    return distortion(corner, arm(corner.next, place(0), place(1)), backwards(arms_[own.last]));
  }

  /// The distortions at a vertex that moves.
  Second sum_at(Index v, const Vector<Second>& moving) {
#ifdef TRIPATCH_PACKS
    if (in_packs(v)) return sum_in_packs(v, moving);
#endif
    read_arms(v, moving);
    Second sum;
    for (const Own& own : at_[v]) sum = sum + distortion_of(own);
    return sum;
  }

  void move(Index v) {
    check_interruption();
    const Eigen::Vector2d d = (layout_.uv.row(v) - base_.row(v)).transpose();
    const Taylor& t = taylor_[v];
    Vector<Second> moving;
    for (int k = 0; k < 3; ++k)
      moving[k] = {x_[v][k],
                   t(1, k) + 2 * d[0] * t(3, k) + d[1] * t(4, k),
                   t(2, k) + d[0] * t(4, k) + 2 * d[1] * t(5, k),
                   t(3, k),
                   t(4, k),
                   t(5, k)};
    const Second sum = sum_at(v, moving);
    const Eigen::Vector2d gradient(sum.u, sum.v);
    Eigen::Matrix2d hessian;
    hessian << 2 * sum.uu, sum.uv, sum.uv, 2 * sum.vv;
    // made positive: a saddle's step would lead uphill
    const double mean = 0.5 * hessian.trace(), spread = Vec2(0.5 * (hessian(0, 0) - hessian(1, 1)), hessian(0, 1)).norm();
    if (!(mean - spread > min_convex * (std::abs(mean) + spread)))
      hessian.diagonal().array() += spread - mean + made_convex * (std::abs(mean) + spread);
    Eigen::Vector2d step = -hessian.inverse() * gradient;
    if (!step.allFinite()) return;
    double shortest = INFINITY;
    for (const Own& own : at_[v])
      for (Index w : corners_[own.corner].v)
        if (w != v) shortest = std::min(shortest, (x_[w] - x_[v]).squaredNorm());
    shortest = std::sqrt(shortest);
    const double length = (t.row(1) * step[0] + t.row(2) * step[1]).norm();
    if (length > longest_step * shortest) step *= longest_step * shortest / length;
    for (int half = 0; half < halvings; ++half, step *= 0.5) {
      const Vec3 there = position(v, d + step);
      if (!(cost_at(v, there) < sum.value)) continue;
      layout_.uv.row(v) += step.transpose();
      x_[v] = there;
      return;
    }
  }

  PlaneLayout& layout_;
  const Surface* surface_;
  const Points* border_;
  std::vector<std::vector<Own>> at_;         // of each vertex inside
  std::vector<std::vector<Beside>> beside_;  // likewise
  std::vector<Arm<Second>> arms_;            // of the vertex that moves
  std::vector<bool> held_;
  std::vector<Corner> corners_;
  std::vector<Taylor> taylor_;
  std::vector<Vec3> normal_, x_;
  PlanePoints base_;
  double bound_ = 0;
  bool sharp_ = false;
};

}  // namespace

QuadQuality quad_quality(const PointsRef& points, const Faces& faces) {
  QuadQuality quality;
  double sum = 0;
  Index count = 0;
  for (Index f = 0; f < faces.size(); ++f) {
    const auto face = faces[f];
    const std::size_t m = face.size();
    const auto at = [&](std::size_t k) { return Vec3(points.row(face[k % m])); };
    const Vec3 normal = m == 3 ? (at(1) - at(0)).cross(at(2) - at(0)).stableNormalized()
                               : (at(2) - at(0)).cross(at(3) - at(1)).stableNormalized();
    for (std::size_t k = 0; m == 4 && k < m; ++k) {
      const double sine = normal.dot((at(k + 1) - at(k)).stableNormalized().cross((at(k + m - 1) - at(k)).stableNormalized()));
      quality.least = std::min(quality.least, sine);
      sum += sine;
      ++count;
    }
  }
  if (count > 0) quality.mean = sum / static_cast<double>(count);
  return quality;
}

void spread_inside(const Faces& faces, Index rim, Points& rows) {
  const Index unknowns = rows.rows() - rim;
  if (unknowns == 0) return;
  double mean = 0;
  for (Index k = 0; k < rim; ++k) mean += (rows.row(k) - rows.row((k + 1) % rim)).norm() / static_cast<double>(rim);
  const RowWidths widths(faces, rim, rows, mean);
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(unknowns, 3);
  for (const auto& [edge, e] : widths.edges()) {
    const double weight = square(mean / widths.width(e));
    for (const auto& [a, b] : {std::pair(edge[0], edge[1]), std::pair(edge[1], edge[0])}) {
      if (a < rim) continue;
      entries.emplace_back(a - rim, a - rim, weight);
      if (b < rim) {
        right.row(a - rim) += weight * rows.row(b);
      } else {
        entries.emplace_back(a - rim, b - rim, -weight);
      }
    }
  }
  Eigen::SparseMatrix<double> laplacian(unknowns, unknowns);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  SparseLdlt solver;
  solver.analyzePattern(laplacian);
  solver.factorize(laplacian);
  rows.bottomRows(unknowns) = solver.solve(right);
}

void embed(PlaneLayout& layout) {
  Points rows = in_plane(layout.uv);
  spread_inside(layout.faces, layout.rim, rows);
  layout.uv = rows.leftCols(2);
}

void smooth_quads(PlaneLayout& layout, int sweeps, int sharpening, const Surface* surface, const Points* border,
                  const std::vector<Index>& held) {
  if (layout.uv.rows() > layout.rim) Smoother(layout, surface, border, held).run(sweeps, sharpening);
}

void smooth_trial(PlaneLayout& layout) { smooth_quads(layout, sweeps_of_trials, angles_of_trials); }

double score_of_trial(PlaneLayout& layout, double irregular) {
  smooth_trial(layout);
  const QuadQuality quality = quad_quality(as_rows(layout.uv), layout.faces);
  return quality.least + mean_weight * quality.mean - pole_price * irregular;
}

}  // namespace tripatch
