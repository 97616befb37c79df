#include "tripatch/polygon/fair.h"

#include <algorithm>
#include <cmath>

#include "tripatch/fairing/candidates.h"
#include "tripatch/fairing/energy.h"
#include "tripatch/fairing/folds.h"
#include "tripatch/math/angle.h"
#include "tripatch/math/linear.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/patch/through.h"
#include "tripatch/polygon/problem.h"

namespace tripatch {
namespace {

constexpr int energy_nodes = count::octet;  ///< a direction, where an energy is only measured
constexpr int grid_rings = count::places;   ///< on which folds are counted: a choice

/// Vector multiples of the squared bubble times 1, x, y, ...: as many functions as there are conditions.
class Lift final : public PolygonSurface {
public:
  Lift(const PolygonDomain& domain, int degree, Points coefficients)
      : PolygonSurface(domain), degree_(degree), coefficients_(std::move(coefficients)) {}
  void evaluate(const double* b, Index n, int order, double* out) const override {
    with_order<0, max_order>(order, [&](auto constant) {
      constexpr int N = constant.value;
      for (Index k = 0; k < n; ++k) {
        // next to corners the bubble is flat: a point there has no weights of its own
        Vec2 p(b[3 * k], b[3 * k + 1]);
        const int corner = domain().corner_at(p, tolerance::solved);
        if (corner >= 0) p = domain().moved_off(corner, p, tolerance::solved);
        const Jet<N> u = Jet<N>::linear(p[0], 1, 0), v = Jet<N>::linear(p[1], 0, 1);
        const std::vector<Jet<N>> basis = interior_functions(domain(), domain().bubble(u, v), u, v, degree_);
        JetPoint<N> sum;
        for (Index f = 0; f < coefficients_.rows(); ++f)
          for (int x = 0; x < 3; ++x) sum.x[x] += coefficients_(f, x) * basis[f];
        out = store(sum, out);
      }
    });
  }

private:
  int degree_;
  Points coefficients_;
};

/// Second derivatives across the sides, as those of a triangle's Bends.
class Bends final : public CornerSafeSurface<Bends> {
public:
  Bends(const PolygonDomain& domain, std::vector<PiecewisePolynomial> fields)
      : CornerSafeSurface(domain), fields_(std::move(fields)) {}
  Vec3 corner(int) const { return Vec3::Zero(); }
  template <int N>
  JetPoint<N> at(const Jet<N>& u, const Jet<N>& v) const {
    const Place<N> place = domain().place(u, v);
    JetPoint<N> p;
    for (int i = 0; i < domain().sides(); ++i)
      if (!fields_[i].empty()) p += (0.5 * (square(place.phi[i]) * place.cubic[i])) * compose(fields_[i], place.t[i]);
    return p;
  }

private:
  std::vector<PiecewisePolynomial> fields_;
};

/// What the sides show at a place of the domain: their normals by the side weights.
Vec3 shown(const PolygonDomain& domain, const SideList& sides, const Vec2& p) {
  const Place<0> place = domain.place(Jet<0>(p[0]), Jet<0>(p[1]));
  Vec3 n = Vec3::Zero();
  for (int i = 0; i < domain.sides(); ++i) n += place.side[i].value() * sides[i].normal(place.t[i].value());
  return n;
}

}  // namespace

double polygon_energy(const Surface& surface, const PolygonDomain& domain, Fairing of, double size) {
  const PolygonQuadrature quadrature = polygon_quadrature(domain, energy_nodes);
  return weighed_energy(plane_derivatives(surface, quadrature.uv), quadrature.weights, of, size);
}

double weighed_energy(const std::vector<Derivatives>& all, const std::vector<double>& weights, Fairing of, double size) {
  double variation = 0, quadric = 0, flat = 0;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const Derivatives& d = all[k];
    if (is_quadratic(of)) {
      flat += weights[k] *
              (of == Fairing::thin_plate
                   ? d.row(2).squaredNorm() + 2 * d.row(3).squaredNorm() + d.row(4).squaredNorm()
                   : d.row(5).squaredNorm() + 3 * d.row(6).squaredNorm() + 3 * d.row(7).squaredNorm() + d.row(8).squaredNorm());
      continue;
    }
    const CurvatureVariation v = curvature_variation(d, flat_curvature(size));
    const double w = weights[k] * size * size * v.area;
    variation += w * v.variation.squaredNorm();
    quadric += w * v.quadric.squaredNorm();
  }
  if (is_quadratic(of)) return flat;
  if (of == Fairing::minimum_variation) return variation;
  if (of == Fairing::quadric_variation || !(quadric > 0)) return quadric;
  return soft_minimum(variation, quadric);
}

double polygon_size(const Surface& surface, const PolygonDomain& domain) {
  constexpr int a_side = count::places;  // places
  Points uv = Points::Zero(static_cast<Index>(a_side) * domain.sides(), 3);
  for (Index k = 0; k < uv.rows(); ++k)
    uv.row(k).head<2>() = domain.on_side(static_cast<int>(k) / a_side, static_cast<double>(k % a_side) / a_side);
  const Points p = surface.positions(uv);
  double size = 0;
  for (Index k = 0; k < p.rows(); ++k) size = std::max(size, (p.rowwise() - p.row(k)).rowwise().norm().maxCoeff());
  return size;
}

PolygonFairResult fair_polygon(const PolygonBase& base, const PolygonBase& measured, const FairingOptions& options) {
  const PolygonDomain& domain = base.boundary.domain;
  const Candidates<PolygonProblem> candidates = is_quadratic(options.energy)
                                                    ? quadratic_candidates<PolygonProblem>(measured, options, base.boundary.size)
                                                    : geometric_candidates<PolygonProblem>(measured, options);
  PolygonFairResult plain;
  plain.patch = base.patch();
  plain.before = plain.after = std::isnan(candidates.before) ? 0 : candidates.before;  // of a plane both parts are nothing
  plain.folds = count_polygon_folds(*base.patch(), domain, base.sides);
  if (candidates.beyond && plain.folds == 0) {
    plain.gave_up = true;
    plain.warnings = {{Code::surroundings_vary}};
    return plain;
  }
  for (const Candidate& candidate : candidates.best_first) {
    if (!(candidate.energy <= plain.before)) continue;
    PolygonFairResult now = plain;
    now.patch = sum(base.patch(), candidates.problem->correction(candidate.x, base.sides));
    if (!base.through.empty()) now.patch = with_points(now.patch, domain, base.through, base.boundary.size);
    now.after = candidate.energy;
    now.folds = count_polygon_folds(*now.patch, domain, base.sides);
    if (now.folds <= plain.folds) return now;
    plain.warnings = {{Code::fairest_folds}};
  }
  return plain;
}

std::shared_ptr<const PolygonAtNodes> KnownAtNodes::find(int nodes) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = by_nodes_.find(nodes);
  return found == by_nodes_.end() ? nullptr : found->second;
}

void KnownAtNodes::add(int nodes, std::shared_ptr<const PolygonAtNodes> at_nodes) {
  const std::lock_guard<std::mutex> lock(mutex_);
  by_nodes_.insert_or_assign(nodes, std::move(at_nodes));
}

SurfacePtr with_points(const SurfacePtr& patch, const PolygonDomain& domain, const std::vector<InnerPoint>& points, double size) {
  const SurfacePtr lift = lift_to(patch, domain, points, size);
  return lift ? sum(patch, lift) : patch;
}

SurfacePtr lift_to(const SurfacePtr& patch, const PolygonDomain& domain, const std::vector<InnerPoint>& points, double size) {
  if (points.empty()) return {};
  // unknowns: functions by x, y, z; of all solutions the shortest
  Index conditions = 0;
  for (const InnerPoint& p : points) conditions += p.normal ? 5 : 3;
  int degree = 0;
  while (3 * polynomials_to(degree) < 2 * conditions) ++degree;
  const Index count = polynomials_to(degree);
  Points coefficients = Points::Zero(count, 3);
  SurfacePtr out = patch, lift;
  for (int round = 0; round < 2; ++round) {  // a second time for the last digits
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(conditions, 3 * count), right(conditions, 1);
    Index row = 0;
    for (const InnerPoint& p : points) {
      const Jet<1> u = Jet<1>::linear(p.uv[0], 1, 0), v = Jet<1>::linear(p.uv[1], 0, 1);
      const std::vector<Jet<1>> basis = interior_functions(domain, domain.bubble(u, v), u, v, degree);
      const std::array<double, 3> at = {p.uv[0], p.uv[1], 0};
      std::array<double, 9> jets;
      out->evaluate(at.data(), 1, 1, jets.data());
      const auto add = [&](int derivative, const Vec3& along, double wanted) {
        for (Index f = 0; f < count; ++f)
          for (int x = 0; x < 3; ++x) rows(row, x * count + f) = along[x] * basis[f].c[derivative];
        right(row++, 0) = wanted - along.dot(Vec3::Map(&jets[3 * derivative]));
      };
      for (int x = 0; x < 3; ++x) add(0, Vec3::Unit(x), p.point[x]);
      if (p.normal)
        for (int k = 1; k <= 2; ++k) add(k, *p.normal, 0);
    }
    const Eigen::MatrixXd x = least_squares(rows, right), met = rows * x;
    if (!x.allFinite() || (met - right).norm() > tolerance::same * size) throw CodedRefusal(Code::points_in_one_place);
    for (int c = 0; c < 3; ++c) coefficients.col(c) += x.col(0).segment(c * count, count);
    lift = std::make_shared<Lift>(domain, degree, coefficients);
    out = sum(patch, lift);
  }
  return lift;
}

Index count_polygon_folds(const Surface& patch, const PolygonDomain& domain, const SideList& sides) {
  std::vector<std::array<Index, 2>> edges;
  const Points uv = polygon_grid(domain, grid_rings, &edges);
  const Points normals = patch.normals(uv);
  const int n = domain.sides();
  std::vector<bool> clear;
  for (int k = 0; k < n; ++k) {
    const Vec3 a = sides[domain.wrap(k - 1)].normal(1), b = sides[k].normal(0);
    clear.push_back(degrees_between(a, b) < folds_one_plane);
  }
  const auto near_crease = [&](const Vec2& p) {
    const int k = domain.corner_at(p, beside_crease);
    return k >= 0 && !clear[k];
  };
  Index folds = 0;
  for (Index k = 0; k < uv.rows(); ++k) {
    const Vec2 p = uv.row(k).head<2>();
    folds += domain.corner_at(p, tolerance::same) < 0 && !(normals.row(k).dot(shown(domain, sides, p)) > 0);
  }
  for (const auto& [a, b] : edges) {
    const Vec3 p = normals.row(a), q = normals.row(b);
    folds += p.dot(q) <= folded_apart && p.norm() > 0 && q.norm() > 0 && !near_crease(uv.row(a).head<2>()) &&
             !near_crease(uv.row(b).head<2>());
  }
  return folds;
}

std::vector<Across> derivatives_across(const Surface& patch, const PolygonDomain& domain, int i, std::span<const double> t,
                                       int order) {
  const Index n = static_cast<Index>(t.size()), row = jet_size(order);
  Points uv = Points::Zero(n, 3);
  for (Index k = 0; k < n; ++k) uv.row(k).head<2>() = domain.on_side(i, t[k]);
  std::vector<double> jets(3 * row * n);
  patch.evaluate(uv.data(), n, order, jets.data());
  const Vec2 out = -domain.inward(i);
  std::vector<Across> result(t.size());
  for (Index k = 0; k < n; ++k) {
    const auto derivative = [&](Index which) { return Vec3::Map(&jets[3 * (row * k + which)]); };
    result[k].first = out[0] * derivative(1) + out[1] * derivative(2);
    if (order > 1)
      result[k].second =
          2 * (out[0] * out[0] * derivative(3) + out[0] * out[1] * derivative(4) + out[1] * out[1] * derivative(5));
  }
  return result;
}

SurfacePtr meet_curvature(const SurfacePtr& patch, const PolygonDomain& domain, const SideList& sides,
                          const std::vector<bool>& wanted) {
  std::vector<PiecewisePolynomial> fields(domain.sides());
  for (int i = 0; i < domain.sides(); ++i) {
    if (!wanted[i]) continue;
    fields[i] = fit_between_vertices(sides[i], tolerance::same, [&](std::span<const double> t, std::span<double> out) {
      const std::vector<Across> across = derivatives_across(*patch, domain, i, t);
      for (std::size_t k = 0; k < t.size(); ++k) Vec3::Map(&out[3 * k]) = lacking_curvature(sides[i], t[k], across[k]);
    });
  }
  return sum(patch, std::make_shared<Bends>(domain, std::move(fields)));
}

std::vector<bool> curvature_agrees(const SideList& sides) {
  const int n = static_cast<int>(sides.size());
  std::vector<bool> corner(n), agree(n);
  for (int k = 0; k < n; ++k) {
    // as the corner of a triangle between its sides 1, which ends there, and 2
    const Sides three = {sides[k], sides[(k + n - 1) % n], sides[k]};
    corner[k] = curvature_mismatch(three)[0] <= curvatures_agree;
  }
  for (int i = 0; i < n; ++i) agree[i] = corner[i] && corner[(i + 1) % n];
  return agree;
}

}  // namespace tripatch
