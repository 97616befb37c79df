#include "tripatch/spline/hermite_correction.h"

#include <algorithm>
#include <cmath>
#include <ranges>

#include "tripatch/math/decompositions.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/messages.h"

namespace tripatch {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Of the kernel r^5, which has the derivatives that slopes ask for.
constexpr int kernel_power = 5;
/// Of longer rims every second vertex, or third: the time grows with the cube of their number.
constexpr Index max_of_rim = count::hundreds;
/// Share of the domain's size that places keep from its border, where nothing is added.
constexpr double min_margin = share::trace;

/// Monomials up to degree 2, or their derivatives by one coordinate.
MatrixXd monomials(const PlanePoints& c, int axis) {
  MatrixXd m = MatrixXd::Zero(c.rows(), 6);
  const auto u = c.col(0), v = c.col(1);
  if (axis < 0) m << VectorXd::Ones(c.rows()), u, v, u.cwiseProduct(u), u.cwiseProduct(v), v.cwiseProduct(v);
  if (axis == 0) {
    m.col(1).setOnes();
    m.middleCols(3, 2) << 2 * u, v;
  } else if (axis == 1) {
    m.col(2).setOnes();
    m.rightCols(2) << u, 2 * v;
  }
  return m;
}

double cross(const Eigen::RowVector2d& a, const Eigen::RowVector2d& b) { return a[0] * b[1] - a[1] * b[0]; }

/// The triangles of a plane domain, and their border.
class Domain {
public:
  Domain(const PlanePoints& uv, const std::vector<std::array<Index, 3>>& triangles) : uv_(uv), triangles_(triangles) {
    std::vector<std::array<Index, 2>> edges;
    for (const std::array<Index, 3>& t : triangles)
      for (int k = 0; k < 3; ++k) edges.push_back({t[k], t[(k + 1) % 3]});
    std::sort(edges.begin(), edges.end());
    for (const auto& [a, b] : edges)
      if (!std::binary_search(edges.begin(), edges.end(), std::array<Index, 2>{b, a})) border_.push_back({a, b});
    size_ = (uv.colwise().maxCoeff() - uv.colwise().minCoeff()).maxCoeff();
  }
  bool has(const Vec2& place) const {
    const Eigen::RowVector2d p = place.transpose();
    const bool inside = std::any_of(triangles_.begin(), triangles_.end(), [&](const std::array<Index, 3>& t) {
      for (int k = 0; k < 3; ++k)
        if (cross(uv_.row(t[(k + 1) % 3]) - uv_.row(t[k]), p - uv_.row(t[k])) < 0) return false;
      return true;
    });
    return inside && std::all_of(border_.begin(), border_.end(), [&](const std::array<Index, 2>& e) {
             const Eigen::RowVector2d way = uv_.row(e[1]) - uv_.row(e[0]), from = p - uv_.row(e[0]);
             const double t = std::clamp(from.dot(way) / std::max(way.squaredNorm(), tolerance::tiny), 0.0, 1.0);
             return (from - t * way).norm() > min_margin * size_;
           });
  }
  /// Middles of the triangles; those that the domain has where there are such.
  PlanePoints middles() const {
    std::vector<Vec2> all, inside;
    for (const std::array<Index, 3>& t : triangles_) {
      all.emplace_back((uv_.row(t[0]) + uv_.row(t[1]) + uv_.row(t[2])) / 3);
      if (has(all.back())) inside.push_back(all.back());
    }
    const std::vector<Vec2>& chosen = inside.empty() ? all : inside;
    PlanePoints out(static_cast<Index>(chosen.size()), 2);
    for (std::size_t k = 0; k < chosen.size(); ++k) out.row(static_cast<Index>(k)) = chosen[k];
    return out;
  }

private:
  const PlanePoints& uv_;
  const std::vector<std::array<Index, 3>>& triangles_;
  std::vector<std::array<Index, 2>> border_;
  double size_ = 0;
};

}  // namespace

PlanePoints nearest_places(const Surface& surface, const PlanePoints& uv, const std::vector<std::array<Index, 3>>& triangles,
                           const std::vector<Through>& points) {
  const Domain domain(uv, triangles);
  const PlanePoints starts = domain.middles();
  const Points known = surface.positions(as_rows(starts));
  PlanePoints places(static_cast<Index>(points.size()), 2);
  for (Index k = 0; k < places.rows(); ++k) {
    const Vec3& point = points[k].point;
    Index nearest = 0;
    (known.rowwise() - point.transpose()).rowwise().squaredNorm().minCoeff(&nearest);
    Vec2 place = starts.row(nearest);
    Foot foot = foot_at(surface, place, point);
    for (int step = 0; step < tolerance::newton_steps && foot.step.allFinite(); ++step) {
      const Foot from = foot;
      // far from a surface that bends away Gauss-Newton goes too far
      double share = 1;
      for (; share > tolerance::slight; share /= 2) {
        if (!domain.has(place + share * from.step)) continue;
        foot = foot_at(surface, place + share * from.step, point);
        if (foot.off.squaredNorm() < from.off.squaredNorm()) break;
      }
      if (share <= tolerance::slight) break;
      place += share * from.step;
    }
    places.row(k) = place;
  }
  return places;
}

HermiteCorrection::HermiteCorrection(const Surface& surface, const PlanePoints& rim, const PlanePoints& places,
                                     const std::vector<Through>& points, const Points& planes)
    : met_(places.rows()) {
  std::vector<Index> of_rim, held;
  const Index step = (rim.rows() + max_of_rim - 1) / max_of_rim;
  const auto asks = [&](Index k) { return !planes.row(k).isZero(0); };
  const bool some = std::ranges::any_of(std::views::iota(Index{0}, planes.rows()), [&](Index k) { return !asks(k); });
  for (Index k = 0; k < rim.rows(); ++k)
    if (k % step == 0 || (some && asks(k))) of_rim.push_back(k);
  const PlanePoints kept = rim(of_rim, Eigen::all);
  const Index n = kept.rows();
  middle_ = kept.colwise().mean();
  size_ = std::max((kept.rowwise() - middle_).cwiseAbs().maxCoeff(), tolerance::tiny);
  values_.resize(n + met_, 2);
  values_ << normalised(kept), normalised(places);
  for (Index i = 0; i < met_; ++i) {
    if (points[i].normal) held.push_back(i);
    for (Index j = 0; j < i; ++j)
      if ((values_.row(n + i) - values_.row(n + j)).norm() < tolerance::same)
        throw CodedRefusal(Code::points_over_one_place, {{"first", j}, {"second", i}});
  }
  held_ = static_cast<Index>(held.size());
  slopes_.resize(n + held_, 2);
  slopes_ << values_.topRows(n), values_.bottomRows(met_)(held, Eigen::all);
  std::vector<double> jets(9 * met_);
  surface.evaluate(as_rows(places).data(), met_, 1, jets.data());
  MatrixXd wanted(met_ + 2 * held_, 3);
  for (Index i = 0; i < met_; ++i) wanted.row(i) = points[i].point - Vec3::Map(&jets[9 * i]);
  for (Index i = 0; i < held_; ++i)
    for (int axis = 0; axis < 2; ++axis) {
      const Vec3 normal = points[held[i]].normal->normalized();
      wanted.row(met_ + axis * held_ + i) = -size_ * normal.dot(Vec3::Map(&jets[9 * held[i] + 3 * (1 + axis)])) * normal;
    }
  const MatrixXd all = conditions();
  std::vector<Index> rows;  // of the conditions at places
  for (Index i = 0; i < met_; ++i) rows.push_back(n + i);
  for (int axis = 0; axis < 2; ++axis)
    for (Index i = 0; i < held_; ++i) rows.push_back(values_.rows() + axis * slopes_.rows() + n + i);
  MatrixXd right = MatrixXd::Zero(count(), met_ + 2 * held_);
  right(rows, Eigen::all).setIdentity();
  const SquareSystem system(all);
  cardinal_ = system.solve(right);
  // what rounding leaves of the identity, once more
  const MatrixXd chosen = all(rows, Eigen::all), made = chosen * cardinal_;
  cardinal_ = (cardinal_ * SquareSystem(made).inverse()).eval();
  if (!cardinal_.allFinite()) throw CodedRefusal(Code::points_not_met);
  coefficients_ = cardinal_ * wanted;
  if (planes.rows() == rim.rows()) coefficients_ += system.solve(leaning(surface, kept, planes(of_rim, Eigen::all)));
}

/// What the surface's derivatives along the rim lack to be at right angles to normals there.
Eigen::MatrixXd HermiteCorrection::leaning(const Surface& surface, const PlanePoints& rim, const Points& planes) const {
  const Index n = rim.rows();
  std::vector<double> jets(9 * n);
  surface.evaluate(as_rows(rim).data(), n, 1, jets.data());
  MatrixXd right = MatrixXd::Zero(count(), 3);
  for (Index k = 0; k < n; ++k)
    for (int axis = 0; axis < 2; ++axis) {
      const Vec3 normal = planes.row(k);
      right.row(values_.rows() + axis * slopes_.rows() + k) =
          -size_ * normal.dot(Vec3::Map(&jets[9 * k + 3 * (1 + axis)])) * normal;
    }
  return right;
}

MatrixXd HermiteCorrection::basis(const PlanePoints& at, int axis) const {
  const Index n = values_.rows(), m = slopes_.rows();
  MatrixXd out(at.rows(), count());
  for (Index i = 0; i < at.rows(); ++i) {
    for (Index j = 0; j < n; ++j) {
      const Eigen::RowVector2d way = at.row(i) - values_.row(j);
      const double r = way.norm(), r3 = r * r * r;
      out(i, j) = -(axis < 0 ? r3 * r * r : kernel_power * r3 * way[axis]);
    }
    for (Index j = 0; j < m; ++j) {
      const Eigen::RowVector2d way = at.row(i) - slopes_.row(j);
      const double r = way.norm(), r3 = r * r * r;
      for (int by = 0; by < 2; ++by) {
        const double value = axis < 0 ? r3 * way[by] : (axis == by ? r3 : 0) + 3 * r * way[by] * way[axis];
        out(i, n + by * m + j) = kernel_power * value;
      }
    }
  }
  out.rightCols(free) = monomials(at, axis);
  return out;
}

MatrixXd HermiteCorrection::conditions() const {
  const Index n = values_.rows(), m = slopes_.rows();
  MatrixXd all = MatrixXd::Zero(count(), count());
  all.topRows(n) = basis(values_);
  for (int axis = 0; axis < 2; ++axis) all.middleRows(n + axis * m, m) = basis(slopes_, axis);
  all.bottomLeftCorner(free, n + 2 * m) = all.topRightCorner(n + 2 * m, free).transpose();
  all.diagonal().head(n - met_).array() += tolerance::rounding;
  for (int axis = 0; axis < 2; ++axis) all.diagonal().segment(n + axis * m, m - held_).array() += tolerance::rounding;
  return all;
}

template <int N>
void HermiteCorrection::jets(const double* b, Index n, double* out) const {
  const Index values = values_.rows(), m = slopes_.rows();
  const double step = 1 / size_;
  /// s to half of an odd number, and its Taylor coefficients.
  const auto power = [](const Jet<N>& s, int twice) {
    std::array<double, N + 1> f{};
    f[0] = std::sqrt(s.value());
    for (int k = 1; k < twice; k += 2) f[0] *= s.value();
    for (int d = 1; d <= N; ++d) f[d] = f[d - 1] * (0.5 * twice + 1 - d) / (d * s.value());
    return compose<N>(f.data(), 1, s);
  };
  for (Index k = 0; k < n; ++k) {
    const Eigen::RowVector2d at = (Eigen::RowVector2d(b[3 * k], b[3 * k + 1]) - middle_) / size_;
    JetPoint<N> sum;
    const auto add = [&](const Jet<N>& f, Index row) {
      for (int x = 0; x < 3; ++x) sum.x[x] += coefficients_(row, x) * f;
    };
    const auto from = [&](const Eigen::RowVector2d& center) {
      Eigen::RowVector2d way = at - center;
      if (way.cwiseAbs().sum() < tolerance::same) way[0] = tolerance::same;
      return std::array<Jet<N>, 2>{Jet<N>::linear(way[0], step, 0), Jet<N>::linear(way[1], 0, step)};
    };
    for (Index j = 0; j < values; ++j) {
      const std::array<Jet<N>, 2> way = from(values_.row(j));
      add(-power(way[0] * way[0] + way[1] * way[1], kernel_power), j);
    }
    for (Index j = 0; j < m; ++j) {
      const std::array<Jet<N>, 2> way = from(slopes_.row(j));
      const Jet<N> radial = kernel_power * power(way[0] * way[0] + way[1] * way[1], kernel_power - 2);
      for (int by = 0; by < 2; ++by) add(radial * way[by], values + by * m + j);
    }
    const Jet<N> u = Jet<N>::linear(at[0], step, 0), v = Jet<N>::linear(at[1], 0, step);
    Index row = values + 2 * m;
    for (const Jet<N>& f : {Jet<N>(1.0), u, v, u * u, u * v, v * v}) add(f, row++);
    out = store(sum, out);
  }
}

void HermiteCorrection::evaluate(const double* b, Index n, int order, double* out) const {
  with_order<0, max_order>(order, [&](auto constant) { jets<constant.value>(b, n, out); });
}

VectorXd HermiteCorrection::deviation_left(const PlanePoints& points, const VectorXd& at_points,
                                           const VectorXd& at_places) const {
  const MatrixXd met = cardinal_.leftCols(met_), share = basis(normalised(points)) * met;
  // covariances at the places given the samples, up to a factor: the inverse of their block of the inverse
  const MatrixXd covariance = SquareSystem(cardinal_.block(values_.rows() - met_, 0, met_, met_)).inverse();
  const VectorXd scale = at_places.cwiseQuotient(covariance.diagonal().cwiseAbs().cwiseSqrt());
  const MatrixXd known = scale.asDiagonal() * covariance * scale.asDiagonal();
  const VectorXd told = (share * known).cwiseProduct(share).rowwise().sum();
  return (at_points.cwiseAbs2() - told).cwiseMax(0).cwiseSqrt();
}

}  // namespace tripatch
