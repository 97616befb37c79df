#include "tripatch/quads/quad_smoothing.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "tripatch/math/interruption.h"
#include "tripatch/math/simd.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/quads/corner_costs.h"
#include "tripatch/quads/row_widths.h"

namespace tripatch {
namespace {

using namespace corner_costs;

// Other numbers were tried on quads between four, five and six sides of a wavy saddle. Reported is by how much of the diameter a vertex of
// one of them moves at most; "0" says that no vertex does.
/// Of the shortest edge at a vertex: no step is longer, beyond it the surface's second order says little (0 with half).
constexpr double longest_step = 0.4;
/// Of the larger eigenvalue of a Hessian: where the smaller one is less it becomes that share (0 with a tenth, 0 with half).
constexpr double made_convex = share::tenth;
constexpr int halvings = count::half_dozen;  ///< of a Newton step that makes things worse, before it is left out (0 with three)
/// Between two evaluations of the surface, whose second order is good for small moves (5e-5 with two).
constexpr int sweeps_a_metric = 5;
/// Of the shortest edge at a vertex: one that is no farther from where the surface was evaluated is not evaluated again.
constexpr double near_enough = share::little;

/// As sweeps of a cover, but of what is only compared: half of them take the same layouts of four to six sides of a saddle.
constexpr int sweeps_of_trials = count::several, angles_of_trials = 5;
/// What an irregular vertex may cost the least scaled Jacobian: below that one more is not worth it.
constexpr double pole_price = share::trace, mean_weight = share::three_tenths;

/// Over all vertices inside: on the surface, then for the least angle. With half and twice of the first vertices of quads between four to six
/// sides of a wavy saddle move by up to 1e-3 and 2e-4 of the diameter, of the second by 9e-3 and 4e-3.
constexpr int sweeps_on_surface = 10, sweeps_of_angles = count::sweeps;
/// These again, while an angle is no good and becomes better. A choice.
constexpr int max_rounds = count::half_dozen;

/// Moves vertices one after the other.
class Smoother {
public:
  using Taylor = Eigen::Matrix<double, 6, 3, Eigen::RowMajor>;
  /// What moves.
  struct State {
    PlanePoints uv, base;  ///< where the vertices are, and where the surface was evaluated for them
    std::vector<Taylor> taylor;
    std::vector<Vec3> normal, x;
  };

  Smoother(const PlaneLayout& layout, const Surface* surface, const Points* border, const std::vector<Index>& held)
      : layout_(layout),
        surface_(surface),
        border_(border),
        widths_(layout.faces, layout.rim),
        at_(layout.uv.rows()),
        beside_(layout.uv.rows()),
        shortest_(layout.uv.rows(), 0),
        held_(layout.uv.rows(), false),
        beside_triangle_(layout.uv.rows(), false) {
    for (Index v : held) held_[v] = true;
    state_.uv = layout.uv;
    read_surface();
    for (Index f = 0; f < layout.faces.size(); ++f) {
      const auto face = layout.faces[f];
      const std::size_t m = face.size();
      for (std::size_t k = 0; k < m; ++k) {
        const Corner corner = {{face[k], face[(k + 1) % m], face[(k + m - 1) % m]}, 0, 0, m == 3};
        for (int is = 0; is < 3; ++is) {
          if (corner.v[is] >= layout.rim) at_[corner.v[is]].push_back(own(corner, is));
          if (m == 3) beside_triangle_[corner.v[is]] = true;
        }
        corners_.push_back(corner);
      }
    }
    for (std::vector<Own>& all : at_)
      std::stable_sort(all.begin(), all.end(), [](const Own& a, const Own& b) { return a.is < b.is; });
    read_widths();
  }

  /// Of the rows as they are now.
  void read_widths() {
    widths_.measure(positions());
    for (Index f = 0; f < layout_.faces.size(); ++f) {
      const Index from = layout_.faces.offsets[f], to = layout_.faces.offsets[f + 1];
      for (Index c = from; c < to; ++c) {
        corners_[c].next = 1 / widths_.beginning_at(c);
        corners_[c].last = 1 / widths_.beginning_at(c > from ? c - 1 : to - 1);
      }
    }
    for (std::size_t v = 0; v < at_.size(); ++v)
      for (const Own& own : at_[v]) {
        const Corner& corner = corners_[own.corner];
        if (own.is < 2) beside_[v][own.next].scale = corner.next;
        if (own.is != 1) beside_[v][own.last].scale = corner.last;
      }
  }

  /// sharp: the least angle leads.
  void run(int sweeps, bool sharp) {
    if (state_.uv.rows() == layout_.rim) return;
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      check_interruption();
      if (sweep % sweeps_a_metric == 0) read_surface();
      bound_ = 0;
      for (const Corner& corner : corners_)
        if (area(corner) < tolerance::slight) bound_ = tolerance::slight;
      sharp_ = sharp && bound_ == 0;
      for (Index v = layout_.rim; v < state_.uv.rows(); ++v)
        if (!held_[v]) move(v);
    }
  }

  const State& state() const { return state_; }
  void restore(State state) { state_ = std::move(state); }

  /// By the surface's second order about where it was evaluated.
  Points positions() const {
    Points all(static_cast<Index>(state_.x.size()), 3);
    for (std::size_t v = 0; v < state_.x.size(); ++v) all.row(static_cast<Index>(v)) = state_.x[v];
    return all;
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

  Own own(const Corner& corner, int is) {
    const Index c = static_cast<Index>(corners_.size()), v = corner.v[is];
    if (is == 0) return {c, is, arm_to(v, corner.v[1]), arm_to(v, corner.v[2])};
    const std::size_t arm = arm_to(v, corner.v[0]);
    return {c, is, arm, arm};
  }
  /// The place of a neighbor among those of a vertex.
  std::size_t arm_to(Index v, Index neighbor) {
    std::vector<Beside>& all = beside_[v];
    const auto found = std::find_if(all.begin(), all.end(), [&](const Beside& each) { return each.vertex == neighbor; });
    const std::size_t place = static_cast<std::size_t>(found - all.begin());
    if (found == all.end()) all.push_back({neighbor, 0});
    return place;
  }

  /// The surface about the vertices that are not near where it was evaluated for them; for all the first time.
  void read_surface() {
    const Index n = state_.uv.rows();
    const bool first = state_.taylor.empty();
    std::vector<Index> away;
    for (Index v = first ? 0 : layout_.rim; v < n; ++v) {
      if (!first) {
        const Vec2 d = state_.uv.row(v) - state_.base.row(v);
        const double moved = (state_.taylor[v].row(1) * d[0] + state_.taylor[v].row(2) * d[1]).norm();
        if (!surface_ || !(moved > near_enough * shortest_[v])) continue;
      }
      away.push_back(v);
    }
    if (first) {
      state_.taylor.resize(n, Taylor::Zero());
      state_.normal.resize(n, Vec3::UnitZ());
      state_.x.resize(n);
      state_.base = state_.uv;
    }
    const Points rows = as_rows(state_.uv(away, Eigen::all));
    std::vector<Taylor> read(away.size(), Taylor::Zero());
    if (surface_) {
      surface_->evaluate(rows.data(), rows.rows(), 2, read.data()->data());
    } else {
      for (std::size_t k = 0; k < read.size(); ++k) {
        read[k].row(0) = rows.row(static_cast<Index>(k));
        read[k].row(1) = Vec3::UnitX();
        read[k].row(2) = Vec3::UnitY();
      }
    }
    for (std::size_t k = 0; k < away.size(); ++k) {
      const Index v = away[k];
      if (surface_) state_.normal[v] = Vec3(read[k].row(1)).cross(Vec3(read[k].row(2))).stableNormalized();
      if (surface_ && border_ && v < layout_.rim) read[k].row(0) = border_->row(v);
      state_.taylor[v] = read[k];
      state_.base.row(v) = state_.uv.row(v);
      state_.x[v] = read[k].row(0);
    }
  }

  Vec3 position(Index v, const Eigen::Vector2d& d) const {
    Eigen::Matrix<double, 1, 6> powers;
    powers << 1, d[0], d[1], d[0] * d[0], d[0] * d[1], d[1] * d[1];
    return (powers * state_.taylor[v]).transpose();
  }

  double area(const Corner& c) const {
    return c.next * c.last *
           state_.normal[c.v[0]].dot((state_.x[c.v[1]] - state_.x[c.v[0]]).cross(state_.x[c.v[2]] - state_.x[c.v[0]]));
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
    auto area = area_between(state_.normal[corner.v[0]], next.to, last.to);
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
  bool in_packs(Index v) const { return has_packs() && bound_ == 0 && !beside_triangle_[v]; }

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
      gather(four, 0, state_.normal, normal);
      gather(four, 0, state_.x, own);
      gather(four, 1, state_.x, one);
      gather(four, 2, state_.x, other);
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
      gather(four, 0, state_.normal, normal);
      for (int k = 0; k < 3; ++k) gather(four, k, state_.x, at[k]);
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
    const auto place = [&](Index w) -> const Vec3& { return w == v ? x : state_.x[w]; };
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
        arms_[k].to[x] = scale * Second{state_.x[w][x] - m.value, -m.u, -m.v, -m.uu, -m.uv, -m.vv};
      }
      arms_[k].square = dot(arms_[k].to, arms_[k].to);
    }
  }

  Second distortion_of(const Own& own) const {
    const Corner& corner = corners_[own.corner];
    const auto place = [&](int k) -> const Vec3& { return state_.x[corner.v[k]]; };
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
    const Eigen::Vector2d d = (state_.uv.row(v) - state_.base.row(v)).transpose();
    const Taylor& t = state_.taylor[v];
    Vector<Second> moving;
    for (int k = 0; k < 3; ++k)
      moving[k] = {state_.x[v][k],
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
    if (!(mean - spread > tolerance::slight * (std::abs(mean) + spread)))
      hessian.diagonal().array() += spread - mean + made_convex * (std::abs(mean) + spread);
    Eigen::Vector2d step = -hessian.inverse() * gradient;
    if (!step.allFinite()) return;
    double shortest = INFINITY;
    for (const Own& own : at_[v])
      for (Index w : corners_[own.corner].v)
        if (w != v) shortest = std::min(shortest, (state_.x[w] - state_.x[v]).squaredNorm());
    shortest_[v] = shortest = std::sqrt(shortest);
    const double length = (t.row(1) * step[0] + t.row(2) * step[1]).norm();
    if (length > longest_step * shortest) step *= longest_step * shortest / length;
    for (int half = 0; half < halvings; ++half, step *= 0.5) {
      const Vec3 there = position(v, d + step);
      if (!(cost_at(v, there) < sum.value)) continue;
      state_.uv.row(v) += step.transpose();
      state_.x[v] = there;
      return;
    }
  }

  const PlaneLayout& layout_;
  const Surface* surface_;
  const Points* border_;
  RowWidths widths_;
  std::vector<std::vector<Own>> at_;         // of each vertex inside
  std::vector<std::vector<Beside>> beside_;  // likewise
  std::vector<double> shortest_;             // edge of each vertex inside
  std::vector<Arm<Second>> arms_;            // of the vertex that moves
  std::vector<bool> held_, beside_triangle_;
  std::vector<Corner> corners_;
  State state_;
  double bound_ = 0;
  bool sharp_ = false;
};

}  // namespace

void smooth_quads(PlaneLayout& layout, int sweeps, int sharpening, const Surface* surface, const Points* border,
                  const std::vector<Index>& held) {
  Smoother smoother(layout, surface, border, held);
  smoother.run(sweeps, false);
  smoother.run(sharpening, true);
  layout.uv = smoother.state().uv;
}

Points smoothed_on(PlaneLayout& layout, const Surface& surface, const Points& border, const std::vector<Index>& held) {
  Smoother smoother(layout, &surface, &border, held);
  double least = quad_quality(smoother.positions(), layout.faces).least, before = -INFINITY;
  for (int round = 0; round == 0 || (round < max_rounds && least < min_sine && least > before); ++round) {
    before = least;
    for (const bool sharp : {false, true}) {
      const Smoother::State kept = smoother.state();
      smoother.read_widths();
      smoother.run(sharp ? sweeps_of_angles : sweeps_on_surface, sharp);
      const double now = quad_quality(smoother.positions(), layout.faces).least;
      if (now >= least)
        least = now;
      else
        smoother.restore(kept);
    }
  }
  layout.uv = smoother.state().uv;
  Points vertices = surface.positions(as_rows(layout.uv));
  vertices.topRows(layout.rim) = border;
  return vertices;
}

void smooth_trial(PlaneLayout& layout) { smooth_quads(layout, sweeps_of_trials, angles_of_trials); }

double score_of_trial(PlaneLayout& layout, double irregular) {
  smooth_trial(layout);
  const QuadQuality quality = quad_quality(as_rows(layout.uv), layout.faces);
  return quality.least + mean_weight * quality.mean - pole_price * irregular;
}

}  // namespace tripatch
