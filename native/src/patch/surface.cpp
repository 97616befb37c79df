#include "tripatch/patch/surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "tripatch/math/linear.h"
#include "tripatch/math/parallel.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/math/unit_vector.h"
#include "tripatch/patch/point_formula.h"

namespace tripatch {
namespace {

/// f(first, count) for pieces of n points, on all cores where they are many: so few that their Taylor coefficients stay in the cache next to
/// the core. Few points come in one piece, and whatever evaluates them may share them out.
template <class F>
void in_blocks(Index n, int order, const F& f) {
  constexpr std::array<Index, max_order + 1> worth_a_thread = {400, 200, 100, 50,
                                                               25};  // some 0.05 us a point without derivatives
  constexpr Index block = count::block;
  const Index share = worth_a_thread[std::clamp(order, 0, max_order)];
  check_interruption();
  if (n < 2 * share) return f(0, n);
  parallel_for(0, n, share, [&](Index from, Index to) {
    const SerialScope serial;
    for (Index first = from; first < to; first += block) {
      check_interruption();
      f(first, std::min(block, to - first));
    }
  });
}

class Sum final : public Surface, public FormulaSurface {
public:
  Sum(SurfacePtr a, SurfacePtr b) : a_(std::move(a)), b_(std::move(b)) {
    const PointFormula *const of_a = formula_of(*a_), *const of_b = formula_of(*b_);
    if (of_a && of_b) formula_ = std::make_unique<const PointFormula>([=] { return of_a->terms() + of_b->terms(); });
  }

  const PointFormula* formula() const override { return formula_.get(); }

  void evaluate(const double* b, Index n, int order, double* out) const override {
    const Index row = jet_size(order) * 3;
    in_blocks(n, order, [&](Index first, Index count) {
      double* const sums = out + first * row;
      const auto added = std::make_unique_for_overwrite<double[]>(count * row);
      a_->evaluate(b + 3 * first, count, order, sums);
      b_->evaluate(b + 3 * first, count, order, added.get());
      for (Index k = 0; k < count * row; ++k) sums[k] += added[k];
    });
  }

private:
  SurfacePtr a_, b_;
  std::unique_ptr<const PointFormula> formula_;
};

/// Coordinates without gaps between their rows, as evaluate() asks for them.
class Places {
public:
  explicit Places(const PointsRef& b) : data_(b.data()) {
    if (b.rows() < 2 || b.outerStride() == 3) return;
    copy_ = b;
    data_ = copy_.data();
  }
  const double* data() const { return data_; }

private:
  Points copy_;
  const double* data_;
};

}  // namespace

Foot foot_at(const Surface& surface, const Vec2& place, const Vec3& point) {
  const std::array<double, 3> b = {place[0], place[1], 0};
  std::array<double, 9> jets;
  surface.evaluate(b.data(), 1, 1, jets.data());
  const Vec3 off = point - Vec3::Map(jets.data());
  return {off, in_frame(Vec3::Map(&jets[3]), Vec3::Map(&jets[6]), off)};
}

SurfacePtr sum(SurfacePtr a, SurfacePtr b) { return std::make_shared<Sum>(std::move(a), std::move(b)); }

Points Surface::positions(const PointsRef& b) const {
  Points out(b.rows(), 3);
  evaluate(Places(b).data(), b.rows(), 0, out.data());
  return out;
}

Points Surface::normals(const PointsRef& b) const {
  Points normals(b.rows(), 3);
  positions_and_normals(b, nullptr, normals.data());
  return normals;
}

std::pair<Points, Points> Surface::positions_and_normals(const PointsRef& b) const {
  Points positions(b.rows(), 3), normals(b.rows(), 3);
  positions_and_normals(b, positions.data(), normals.data());
  return {std::move(positions), std::move(normals)};
}

void Surface::positions_and_normals(const PointsRef& b, double* positions, double* normals) const {
  constexpr Index size = jet_size(1) * 3;
  const Places places(b);
  const PointFormula* const formula = formula_of(*this);
  const bool by_formula = formula && formula->is_worth(b.rows());
  in_blocks(b.rows(), 1, [&](Index first, Index count) {
    if (by_formula) {
      double* const to = positions ? positions + 3 * first : nullptr;
      return formula->evaluate(*this, places.data() + 3 * first, count, to, normals + 3 * first);
    }
    const auto jets = std::make_unique_for_overwrite<double[]>(count * size);
    evaluate(places.data() + 3 * first, count, 1, jets.get());
    for (Index k = 0; k < count; ++k) {
      const double* const jet = jets.get() + size * k;
      if (positions) std::copy_n(jet, 3, positions + 3 * (first + k));
      Eigen::Map<Vec3>(normals + 3 * (first + k)) = unit_vector(Vec3::Map(jet + 3).cross(Vec3::Map(jet + 6)));
    }
  });
}

std::optional<Index> first_outside(const PointsRef& b, double off) {
  const auto is_inside = [&](Index k) {
    const double* const p = b.data() + k * b.outerStride();
    return std::abs(p[0] + p[1] + p[2] - 1) <= off && p[0] >= -off && p[1] >= -off && p[2] >= -off;
  };
  if (holds_for_all(b.rows(), is_inside)) return {};
  Index k = 0;
  while (is_inside(k)) ++k;
  return k;
}

void VertexSafeSurface::evaluate(const double* b, Index n, int order, double* out) const {
  if (order < 0 || order > max_order) throw InvalidArgument("derivatives must be from 0 to " + std::to_string(max_order));
  in_blocks(n, order,
            [&](Index first, Index count) { evaluate_some(b + 3 * first, count, order, out + 3 * jet_size(order) * first); });
}

/// First derivatives at a vertex continue along the ray from four distances, each twice the one before, to none: what is left out is of the
/// fourth order, and rounding of the nearest adds 1e-11. All lie before the first of 10,000 edges of a side ends.
constexpr double cone_distance = 2e-5;
constexpr std::array<double, 4> to_the_cone = {64.0 / 21, -56.0 / 21, 14.0 / 21, -1.0 / 21};

void VertexSafeSurface::evaluate_some(const double* b, Index n, int order, double* out) const {
  std::vector<Index> near;
  for (Index k = 0; k < n; ++k)
    if (vertex_of(b + 3 * k, vertex_radius[order]) >= 0) near.push_back(k);
  // a run of points far from the vertices at a time
  Index start = 0;
  const Index row = 3 * jet_size(order);
  for (std::size_t next = 0; start < n; ++next) {
    const Index end = next < near.size() ? near[next] : n;
    if (end > start) evaluate_regular(b + 3 * start, end - start, order, out + start * row);
    start = end + 1;
  }

  std::vector<double> series(row);
  for (Index k : near) {
    const double* p = b + 3 * k;
    const int i = vertex_of(p, vertex_radius[order]), j = (i + 1) % 3, l = (i + 2) % 3;
    const bool exact = vertex_of(p) >= 0;
    std::copy_n(corner(i).data(), 3, out + k * row);
    for (int m = exact ? 1 : 0; m <= order; ++m) {
      double* const of_order = out + k * row + 3 * jet_size(m - 1);
      const Index count = 3 * (m + 1);
      // at the vertex the mean of the two sides, where the weights are exact
      const std::vector<double> rays = exact ? std::vector<double>{0, 1} : std::vector<double>{p[l] / (p[j] + p[l])};
      std::fill_n(of_order, count, 0.0);
      const auto add = [&](const std::array<double, 3>& at, double share) {
        evaluate_regular(at.data(), 1, m, series.data());
        for (Index x = 0; x < count; ++x)
          of_order[x] += share * series[3 * jet_size(m - 1) + x] / static_cast<double>(rays.size());
      };
      for (double t : rays) {
        const auto at_distance = [&](double d) {
          std::array<double, 3> at;
          at[i] = 1 - d;
          at[j] = d * (1 - t);
          at[l] = d * t;
          return at;
        };
        if (vertex_of(p, vertex_radius[m]) < 0)
          add({p[0], p[1], p[2]}, 1);
        else if (m > 1)
          add(at_distance(vertex_radius[m]), 1);
        else
          for (int k = 0; k < 4; ++k) add(at_distance(cone_distance * (1 << k)), to_the_cone[k]);
      }
    }
  }
}

Eigen::VectorXd nearest(const Surface& surface, const Points& points, Points& b) {
  Eigen::VectorXd distance = Eigen::VectorXd::Constant(points.rows(), std::numeric_limits<double>::infinity());
  Points at = b;
  Eigen::Matrix<double, Eigen::Dynamic, 9, Eigen::RowMajor> jets(points.rows(), 9);
  for (int step = 0; step < 4; ++step) {
    surface.evaluate(at.data(), at.rows(), 1, jets.data());
    double largest = 0;
    for (Index k = 0; k < points.rows(); ++k) {
      const Vec3 off = points.row(k) - jets.row(k).head<3>(), d0 = jets.row(k).segment<3>(3), d1 = jets.row(k).tail<3>();
      if (off.norm() < distance[k]) {
        distance[k] = off.norm();
        b.row(k) = at.row(k);
      }
      const double a00 = d0.squaredNorm(), a01 = d0.dot(d1), a11 = d1.squaredNorm(), det = a00 * a11 - a01 * a01;
      const double r0 = d0.dot(off), r1 = d1.dot(off), m0 = (a11 * r0 - a01 * r1) / det, m1 = (a00 * r1 - a01 * r0) / det;
      if (!std::isfinite(m0) || !std::isfinite(m1)) continue;
      largest = std::max({largest, std::abs(m0), std::abs(m1), std::abs(m0 + m1)});
      Eigen::RowVector3d moved = (at.row(k) + Eigen::RowVector3d(m0, m1, -m0 - m1)).cwiseMax(0);
      at.row(k) = moved / moved.sum();
    }
    if (largest < tolerance::close) break;
  }
  return distance;
}

}  // namespace tripatch
