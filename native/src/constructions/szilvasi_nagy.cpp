#include "tripatch/constructions/szilvasi_nagy.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "tripatch/constructions/shape_search.h"
#include "tripatch/math/quadrature.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/messages.h"
#include "tripatch/patch/bezier_triangle.h"
#include "tripatch/patch/vertex_ray.h"

namespace tripatch {
namespace {

constexpr Index batch = count::block;

/// The printed feet: along lines on which v, u and again u are constant.
FootDirections printed_feet() { return {Vec3(1, 0, -1), Vec3(0, 1, -1), Vec3(0, -1, 1)}; }

/// The degree of a surface's homogeneous form: a Bezier triangle's own; any other is read as a function of the ratios u : v : w.
double homogeneous_degree(const Surface& surface) {
  const auto* const bezier = dynamic_cast<const BezierTriangle*>(&surface);
  return bezier ? bezier->degree() : 0;
}

/// The partial derivative with respect to b_i of a homogeneous form f of this degree, by Euler's theorem from derivatives within the
/// triangle: degree f + the derivative in the direction e_i - b.
template <int M>
Jet<M - 1> homogeneous_partial(const Jet<M>& f, const Barycentric<M>& b, int i, double degree) {
  constexpr int N = M - 1;
  const Jet<N> along0 = (i == 0 ? 1.0 : 0.0) - truncated<N>(b[0]), along1 = (i == 1 ? 1.0 : 0.0) - truncated<N>(b[1]);
  return degree * truncated<N>(f) + along0 * directional(f, 1, 0) + along1 * directional(f, 0, 1);
}

/// mu_i or its first or second derivative with respect to lambda_i.
template <int N>
Jet<N> mu_jet(const Barycentric<N>& b, int i, double lambda, int derivative = 0) {
  const int k = (i + 2) % 3;
  const double scale = 1 / (b[i].value() + b[k].value());  // homogeneous: nothing underflows next to the corner where both vanish
  const Jet<N> u = square(b[i] * scale), w = square(b[k] * scale);
  const Jet<N> r = reciprocal(lambda * u + (1 - lambda) * w);
  if (derivative == 0) return (1 - lambda) * (w * r);
  if (derivative == 1) return -(u * w * square(r));
  return 2.0 * (u * w * (u - w) * square(r) * r);
}

/// f is a sum of three linear terms L_i of the blends G_i = r_{i+1} + mu_{i+2} (r_{i+2} - r_{i+1}): everything about a point that
/// does not depend on lambda, for derivatives of order N.
template <int N, int C>
struct Point {
  static constexpr int M = N + C;
  Barycentric<N> b;
  std::array<Jet<N>, 3> weight;
  std::array<Barycentric<M>, 3> foot;
  std::array<JetPoint<N>, 3> base, difference;
  std::array<JetPoint<M>, 3> base_at_foot, difference_at_foot;
};

template <int N, int C>
class Formula {
public:
  static constexpr int M = N + C;

  Formula(const std::array<SurfacePtr, 3>& surfaces, bool as_printed)
      : surfaces_(surfaces), as_printed_(as_printed), directions_(as_printed ? printed_feet() : perpendicular_feet()) {
    for (int i = 0; i < 3; ++i) {
      to_foot_[i] = foot_substitution<N>(directions_[i], i);
      degree_[i] = homogeneous_degree(*surfaces[i]);
    }
  }

  /// visit(k, point) for each of n points.
  template <class Visit>
  void for_each(const double* b, Index n, const Visit& visit) const {
    for (Index start = 0; start < n; start += batch) {
      const Index count = std::min(batch, n - start);
      const double* here = b + 3 * start;
      constexpr Index stride = 3 * jet_size(N), foot_stride = 3 * jet_size(M);
      std::array<std::vector<double>, 3> at_b, foot, next_at_foot, last_at_foot;
      for (int i = 0; i < 3; ++i) {
        at_b[i].resize(count * stride);
        surfaces_[i]->evaluate(here, count, N, at_b[i].data());
        foot[i] = feet(here, count, i, directions_[i]);
        next_at_foot[i].resize(count * foot_stride);
        last_at_foot[i].resize(count * foot_stride);
        surfaces_[(i + 1) % 3]->evaluate(foot[i].data(), count, M, next_at_foot[i].data());
        surfaces_[(i + 2) % 3]->evaluate(foot[i].data(), count, M, last_at_foot[i].data());
      }
      Point<N, C> p;
      for (Index k = 0; k < count; ++k) {
        p.b = Barycentric<N>(here + 3 * k);
        p.weight = side_weights(p.b);
        for (int i = 0; i < 3; ++i) {
          p.base[i] = load<N>(&at_b[(i + 1) % 3][k * stride]);
          p.difference[i] = load<N>(&at_b[(i + 2) % 3][k * stride]) - p.base[i];
          p.foot[i] = Barycentric<M>(&foot[i][3 * k]);
          p.base_at_foot[i] = load<M>(&next_at_foot[i][k * foot_stride]);
          p.difference_at_foot[i] = load<M>(&last_at_foot[i][k * foot_stride]) - p.base_at_foot[i];
        }
        visit(start + k, p);
      }
    }
  }

  /// G_i or, with `derivative`, its derivative with respect to lambda, at b.
  JetPoint<N> blend(const Point<N, C>& p, int i, double lambda, int derivative = 0) const {
    const JetPoint<N> varying = mu_jet(p.b, (i + 2) % 3, lambda, derivative) * p.difference[i];
    return derivative ? varying : p.base[i] + varying;
  }
  /// The same at foot_i(b), times W_i.
  JetPoint<N> correction(const Point<N, C>& p, int i, double lambda, int derivative = 0) const {
    const JetPoint<M> g = at_foot(p, i, mu_jet(p.foot[i], (i + 2) % 3, lambda, derivative), derivative);
    JetPoint<N> q;
    for (int x = 0; x < 3; ++x) q.x[x] = p.weight[i] * to_foot_[i](truncated<N>(g.x[x]));
    return q;
  }
  /// b_i W_i times the derivative of G_i across side i at foot_i(b), halved.
  JetPoint<N> slope_correction(const Point<N, C>& p, int i, double lambda, int derivative = 0) const {
    static_assert(C == 1);
    const Jet<M> mu = mu_jet(p.foot[i], (i + 2) % 3, lambda, derivative);
    const JetPoint<M> g = as_printed_ ? JetPoint<M>() : at_foot(p, i, mu, derivative);
    JetPoint<N> slope;
    for (int x = 0; x < 3; ++x)
      slope.x[x] = as_printed_ ? printed_slope(p, i, truncated<N>(mu), derivative, x)
                               : directional(g.x[x], directions_[i][0], directions_[i][1]);
    const Jet<N> factor = 0.5 * (p.b[i] * p.weight[i]);
    for (int x = 0; x < 3; ++x) slope.x[x] = factor * to_foot_[i](slope.x[x]);
    return slope;
  }
  /// The i-th of the three terms whose sum is f.
  JetPoint<N> term(const Point<N, C>& p, int i, double lambda, int derivative = 0) const {
    const double share = as_printed_ && C == 1 ? 1.0 : 0.5;  // eq. (11) as printed subtracts all of q
    JetPoint<N> f = 0.5 * blend(p, i, lambda, derivative) - share * correction(p, i, lambda, derivative);
    if constexpr (C == 1) f -= slope_correction(p, i, lambda, derivative);
    return f;
  }

private:
  JetPoint<M> at_foot(const Point<N, C>& p, int i, const Jet<M>& mu, int derivative) const {
    const JetPoint<M> varying = mu * p.difference_at_foot[i];
    return derivative ? varying : p.base_at_foot[i] + varying;
  }
  /// Of eq. (9): mu of the partial derivatives with respect to b_i of both surfaces; mu itself is not differentiated.
  Jet<N> printed_slope(const Point<N, C>& p, int i, const Jet<N>& mu, int derivative, int x) const {
    const Jet<M>& base = p.base_at_foot[i].x[x];
    const Jet<N> next = homogeneous_partial(base, p.foot[i], i, degree_[(i + 1) % 3]),
                 last = homogeneous_partial(base + p.difference_at_foot[i].x[x], p.foot[i], i, degree_[(i + 2) % 3]);
    const Jet<N> varying = mu * (last - next);
    return derivative ? varying : next + varying;
  }

  const std::array<SurfacePtr, 3>& surfaces_;
  std::array<double, 3> degree_;  // of the surfaces' homogeneous forms
  bool as_printed_;
  FootDirections directions_;
  std::array<Substitution<N>, 3> to_foot_;
};

/// The nine inner points of a square (s, t) cut in four each way, u = t - s t, v = s t: of the paper's integral sum of its energy (5).
Quadrature printed_quadrature() {
  Quadrature result;
  result.b.resize(9, 3);
  Index row = 0;
  for (int i = 1; i < 4; ++i)
    for (int j = 1; j < 4; ++j) {
      const double s = i / 4.0, t = j / 4.0;
      result.b.row(row++) << t - s * t, s * t, 1 - t;
      result.weights.push_back(t / 9);
    }
  return result;
}

/// The thin-plate energy over the triangle as a function of lambda; as printed, by u and v at nine points.
template <int C>
class FormulaEnergy final : public ShapeEnergy {
public:
  FormulaEnergy(const std::array<SurfacePtr, 3>& surfaces, bool as_printed, int quadrature) : formula_(surfaces, as_printed) {
    // second Taylor coefficients in (x, y) of the equilateral triangle: db0 = dx - dy / sqrt 3, db1 = 2 dy / sqrt 3
    to_plane_ = as_printed ? Substitution<2>(1, 0, 0, 1) : Substitution<2>(1, -1 / std::sqrt(3.0), 0, 2 / std::sqrt(3.0));
    const Quadrature q = as_printed ? printed_quadrature() : corner_quadrature(quadrature);
    root_weight_.resize(q.b.rows());
    for (Index k = 0; k < q.b.rows(); ++k) root_weight_[k] = std::sqrt(q.weights[k]);
    points_.reserve(q.b.rows());
    formula_.for_each(q.b.data(), q.b.rows(), [&](Index, const Point<2, C>& p) { points_.push_back(p); });
  }

  Eigen::VectorXd stacked(int i, double lambda, int derivative) const override {
    Eigen::VectorXd v(9 * static_cast<Index>(points_.size()));
    for (std::size_t k = 0; k < points_.size(); ++k) {
      const JetPoint<2> f = formula_.term(points_[k], (i + 1) % 3, lambda, derivative);  // mu_i is in G_{i+1}
      for (int x = 0; x < 3; ++x) {
        const Jet<2> p = to_plane_(f.x[x]);  // xx / 2, xy, yy / 2
        v.segment<3>(9 * k + 3 * x) = root_weight_[k] * Vec3(2 * p.c[3], std::sqrt(2.0) * p.c[4], 2 * p.c[5]);
      }
    }
    return v;
  }

private:
  Formula<2, C> formula_;
  Substitution<2> to_plane_;
  std::vector<Point<2, C>> points_;
  Eigen::VectorXd root_weight_;
};

}  // namespace

SzilvasiNagy::SzilvasiNagy(const std::array<SurfacePtr, 3>& surfaces, const SzilvasiNagyOptions& options)
    : surfaces_(surfaces),
      corner_(common_corners(surfaces)),
      continuity_(options.continuity),
      as_printed_(options.as_printed),
      shape_(options.shape) {
  if (continuity_ != 0 && continuity_ != 1) throw InvalidArgument("continuity of a Szilvasi-Nagy blend must be 0 or 1");
  for (int i = 0; i < 3; ++i)
    if (!(shape_[i] > 0 && shape_[i] < 1))
      throw CodedArgument(Code::out_of_range, {{"name", "shape[" + std::to_string(i) + "]"}, {"after", 0}, {"before", 1}});
  if (options.optimal) optimize(options.quadrature);
}

void SzilvasiNagy::optimize(int quadrature) {
  path_ = continuity_ == 0 ? min_energy(FormulaEnergy<0>(surfaces_, as_printed_, quadrature), shape_)
                           : min_energy(FormulaEnergy<1>(surfaces_, as_printed_, quadrature), shape_);
  shape_ = path_.back().shape;
}

void SzilvasiNagy::evaluate_regular(const double* b, Index n, int order, double* out) const {
  const auto run = [&](const auto& formula, auto size) {
    formula.for_each(b, n, [&](Index k, const auto& p) {
      auto f = formula.term(p, 0, shape_[2]);
      for (int i = 1; i < 3; ++i) f += formula.term(p, i, shape_[i - 1]);
      store(f, out + k * 3 * size);
    });
  };
  if (continuity_ == 0)
    with_order<0, max_order>(order, [&](auto N) { run(Formula<N.value, 0>(surfaces_, as_printed_), jet_size(N.value)); });
  else
    with_order<0, max_order - 1>(order, [&](auto N) { run(Formula<N.value, 1>(surfaces_, as_printed_), jet_size(N.value)); });
}

std::array<double, 3> SzilvasiNagy::mu(const double* b) const {
  std::array<double, 3> mu;
  for (int i = 0; i < 3; ++i) {
    const bool corner = b[i] == 0 && b[(i + 2) % 3] == 0;
    mu[i] = corner ? 1 : mu_jet(Barycentric<0>(b), i, shape_[i]).value();
  }
  return mu;
}

Points SzilvasiNagy::auxiliary_curve(int i, const std::vector<double>& t) const {
  if (i < 0 || i > 2) throw CodedArgument(Code::out_of_range, {{"name", "i"}, {"from", 0}, {"to", 2}, {"value", i}});
  Points b = Points::Zero(static_cast<Index>(t.size()), 3);
  for (Index k = 0; k < b.rows(); ++k) {
    b(k, (i + 1) % 3) = 1 - t[k];
    b(k, (i + 2) % 3) = t[k];
  }
  const Points next = surfaces_[(i + 1) % 3]->positions(b), last = surfaces_[(i + 2) % 3]->positions(b);
  Points curve(b.rows(), 3);
  for (Index k = 0; k < b.rows(); ++k) {
    const double m = mu(&b(k, 0))[(i + 2) % 3];
    curve.row(k) = m * last.row(k) + (1 - m) * next.row(k);
  }
  return curve;
}

Points SzilvasiNagy::correction(const PointsRef& b) const {
  const Points points = b;
  Points q(points.rows(), 3);
  const Formula<0, 0> formula(surfaces_, as_printed_);
  formula.for_each(points.data(), points.rows(), [&](Index k, const auto& p) {
    JetPoint<0> sum;
    for (int i = 0; i < 3; ++i) sum += formula.correction(p, i, shape_[(i + 2) % 3]);
    store(sum, &q(k, 0));
  });
  for (Index k = 0; k < points.rows(); ++k)
    if (const int v = vertex_of(&points(k, 0)); v >= 0) q.row(k) = corner_[v];
  return q;
}

Points SzilvasiNagy::slope_correction(const PointsRef& b) const {
  const Points points = b;
  Points s = Points::Zero(points.rows(), 3);
  if (continuity_ == 0) return s;
  const Formula<0, 1> formula(surfaces_, as_printed_);
  formula.for_each(points.data(), points.rows(), [&](Index k, const auto& p) {
    JetPoint<0> sum;
    for (int i = 0; i < 3; ++i) sum += formula.slope_correction(p, i, shape_[(i + 2) % 3]);
    store(sum, &s(k, 0));
  });
  for (Index k = 0; k < points.rows(); ++k)
    if (vertex_of(&points(k, 0)) >= 0) s.row(k).setZero();
  return s;
}

namespace {

class HoleSurface final : public JetSurface<HoleSurface> {
public:
  HoleSurface(std::shared_ptr<const Boundary> boundary, int i, int continuity)
      : boundary_(std::move(boundary)), ray_(*boundary_, i, RayDegree::cubic), continuity_(continuity) {}

  Vec3 corner(int i) const override { return ray_.corner(i); }

  template <int N>
  JetPoint<N> at(const Barycentric<N>& b) const {
    const std::array<Jet<N>, 3> w = side_weights(b);
    JetPoint<N> sum = 2.0 * ray_.at(b);
    for (int i = 0; i < 3; ++i) {
      const Jet<N> t = foot(b, i)[(i + 2) % 3];
      JetPoint<N> continued = compose(boundary_->ribbons[i].c, t);
      if (continuity_ == 1) continued -= b[i] * compose(boundary_->ribbons[i].d, t);
      sum += w[i] * continued;
    }
    return (1.0 / 3) * sum;
  }

private:
  std::shared_ptr<const Boundary> boundary_;
  VertexRay ray_;
  int continuity_;
};

}  // namespace

std::array<SurfacePtr, 3> hole_surfaces(const Boundary& boundary, int continuity) {
  const auto shared = std::make_shared<const Boundary>(boundary);
  std::array<SurfacePtr, 3> surfaces;
  for (int i = 0; i < 3; ++i) surfaces[i] = std::make_shared<HoleSurface>(shared, i, continuity);
  return surfaces;
}

}  // namespace tripatch
