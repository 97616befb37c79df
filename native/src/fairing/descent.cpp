#include "tripatch/fairing/descent.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

#include "tripatch/fairing/candidates.h"
#include "tripatch/fairing/energy.h"
#include "tripatch/math/damping.h"
#include "tripatch/math/linear.h"
#include "tripatch/math/thresholds.h"

namespace tripatch {
namespace {

// Half and twice of these numbers were tried on seven three-sided holes of 8 edges a side: in a sphere, a torus, a saddle, Franke's function
// and a helicoid, and at two corners of fillets. Reported is by how much of the diameter a vertex of one of them moves at most.
/// Of the energy at the start, for each jump of curvature that is tolerated: 1e-3.
constexpr double weight_of_jumps = share::tenth;
/// Of the way to alpha's bound, so that the steps that follow have room: 0 with 0.54.
constexpr double share_of_reach = share::nearly_all;
/// Of one of two energies in the derivative: for less its model, half the work, is not made: 1e-5.
constexpr double min_share = share::little;

constexpr double enough = share::hundredth;  // relative gain: the step that gains less is the last
/// Next to none: energies have no units, and those of holes with any shape of their own are above 1e-2.
constexpr double none = tolerance::close;

/// to += weight * from.
void add_times(double weight, const double* from, Index count, double* __restrict to) {
  for (Index k = 0; k < count; ++k) to[k] += weight * from[k];
}

}  // namespace

Eigen::VectorXd minimum(const EnergyProblem& problem, const Quadratic& energy) {
  const Eigen::MatrixXd held = problem.held();
  const CurvatureFollowing& following = problem.following();
  const auto among = [&](Index m) {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(problem.count());
    for (int pass = 0; pass < (following.any() ? 2 : 1); ++pass) {
      Eigen::MatrixXd normal = energy.normal.topLeftCorner(m, m);
      Eigen::VectorXd gradient = energy.normal.topRows(m) * x + energy.gradient.head(m);
      if (following.any()) {
        const Quadratic jumps = following.linearized(x);
        normal += weight_of_jumps * energy.constant * jumps.normal.topLeftCorner(m, m);
        gradient += weight_of_jumps * energy.constant * jumps.gradient.head(m);
      }
      normal.diagonal().array() += tolerance::rounding * normal.trace() / m;
      x.head(m) += constrained_quadratic_minimum(std::move(normal), gradient, held.leftCols(m));
    }
    return x;
  };
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(problem.count());
  const Eigen::VectorXd all = among(problem.count());
  if (all.allFinite() && problem.open(all)) return all;
  const Eigen::VectorXd scalars = among(problem.scalars());
  if (!scalars.allFinite()) return zero;
  if (!all.allFinite() || !problem.controlled()) return scalars;
  const double share = share_of_reach * problem.reach(all);
  return share > 0 ? scalars + std::min(share, 1.0) * (all - scalars) : scalars;
}

Merit::Merit(const EnergyProblem& problem, const Quadratic& third, Quadratic tension, Fairing energy)
    : problem_(problem),
      third_(third),
      tension_(std::move(tension)),
      held_(problem.held()),
      quadric_(energy != Fairing::minimum_variation),
      whole_(energy != Fairing::quadric_variation) {}

Merit::Value Merit::operator()(const Eigen::VectorXd& x) const {
  Value v;
  if (!x.allFinite() || !problem_.open(x)) return v;
  v.derivatives = std::make_shared<const std::vector<Derivatives>>(problem_.derivatives(x));
  std::tie(v.variation, v.quadric) = problem_.variation(*v.derivatives);
  v.third = third_(x);
  v.energy = energy(v.variation, v.quadric) + tension(x);
  if (std::isfinite(v.energy)) {
    v.log =
        std::log(std::max(v.energy, tolerance::tiny)) + parameterization_counts * std::log(std::max(v.third, tolerance::tiny));
    if (problem_.following().any()) v.log += problem_.following().jumps(x, nullptr).squaredNorm();
  }
  return v;
}

Merit::Model Merit::linearized(const Eigen::VectorXd& x, const Value& v) const {
  Model m;
  const double share = quadric_share(v.variation, v.quadric);
  m.used = {share<1 - min_share, share> min_share};  // a step counts only if it goes down anyway
  m.variation = problem_.linearized(v.derivatives ? *v.derivatives : problem_.derivatives(x), m.used);
  if (problem_.following().any()) m.jumps = problem_.following().linearized(x);
  return m;
}

/// The model of the logarithm about x, its parts weighed by their values at x + y: of the matrix the lower triangle, and no constant.
Quadratic Merit::weighted(const Model& m, const Eigen::VectorXd& x, const Eigen::VectorXd& third_slope, const Value& v,
                          const Eigen::VectorXd& y) const {
  const auto value = [&](int which, double now) {
    return m.used[which] ? std::max(m.variation[which](y), tolerance::slight * now) : now;
  };
  const double variation = value(0, v.variation), quadric = value(1, v.quadric), third = std::max(third_(x + y), tolerance::tiny);
  double share = quadric_share(variation, quadric);
  if (!m.used[0]) share = 1;
  if (!m.used[1]) share = 0;
  double part = 1, all = 1;  // of the logarithm's derivative what is not tension's; with tension
  if (tense()) {
    const double bent = energy(variation, quadric);
    all = std::max(bent + tension(x + y), tolerance::tiny);
    part = bent / all;
  }
  std::vector<std::pair<double, const Quadratic*>> parts;
  if (m.used[0]) parts.emplace_back(part * (1 - share) / variation, &m.variation[0]);
  if (m.used[1]) parts.emplace_back(part * share / quadric, &m.variation[1]);
  if (problem_.following().any()) parts.emplace_back(1, &m.jumps);
  Quadratic q;
  q.gradient = parameterization_counts / third * third_slope;
  if (tense()) q.gradient += (tension_.normal * x + tension_.gradient) / all;
  for (const auto& [weight, model] : parts) q.gradient += weight * model->gradient;
  const Index n = x.size();
  q.normal.resize(n, n);
  for (Index c = 0; c < n; ++c) {  // a column at a time, which stays in the cache
    const Index from = c * n + c;
    double* const column = q.normal.data() + from;
    const double* const third_column = third_.normal.data() + from;
    for (Index k = 0; k < n - c; ++k) column[k] = parameterization_counts / third * third_column[k];
    if (tense())
      for (Index k = 0; k < n - c; ++k) column[k] += tension_.normal.data()[from + k] / all;
    for (const auto& [weight, model] : parts) add_times(weight, model->normal.data() + from, n - c, column);
  }
  return q;
}

Eigen::VectorXd Merit::step(const Model& m, const Eigen::VectorXd& x, const Value& v, const Eigen::MatrixXd& metric,
                            double damping) const {
  constexpr int rounds = count::several;  // of weighting, at most: with two of them 5e-3, with eight 1e-2 at the saddle
  constexpr double near = share::tenth;   // where another round changes so little (relative), it is the last: 4e-4
  const Eigen::VectorXd third_slope = symmetric_product(third_.normal, x) + third_.gradient;
  Eigen::VectorXd y = Eigen::VectorXd::Zero(x.size());
  for (int round = 0; round < rounds; ++round) {
    Quadratic q = weighted(m, x, third_slope, v, y);
    const Index n = x.size();
    const double damped = damping * (q.normal.trace() / metric.trace());
    for (Index c = 0; c < n; ++c) add_times(damped, metric.data() + c * n + c, n - c, q.normal.data() + c * n + c);
    q.normal.diagonal().array() += tolerance::fit * q.normal.trace();
    const Eigen::VectorXd last = std::exchange(y, constrained_quadratic_minimum(std::move(q.normal), q.gradient, held_));
    if ((y - last).norm() < near * y.norm()) break;
  }
  return y;
}

double Merit::energy(double variation, double quadric) const {
  return !quadric_ ? variation : !whole_ ? quadric : soft_minimum(variation, quadric);
}

/// Of the quadric energy in the logarithm's derivative.
double Merit::quadric_share(double variation, double quadric) const {
  if (!quadric_ || !whole_) return quadric_ ? 1 : 0;
  if (!(variation > 0)) return 0;
  return 1 - 1 / (1 + std::pow(quadric_ratio * variation / quadric, 4));
}

int descend(const Merit& merit, const Eigen::MatrixXd& metric, Eigen::VectorXd& x, Merit::Value& value, int iterations) {
  double damping = tolerance::close;
  for (int step = 0; step < iterations; ++step) {
    const Merit::Model model = merit.linearized(x, value);
    double gain = 0;
    for (int attempt = 0; attempt < dampings_tried && gain == 0; ++attempt) {
      const Eigen::VectorXd y = x + merit.step(model, x, value, metric, damping);
      const Merit::Value next = merit(y);
      if (next.log < value.log) {
        gain = value.log - next.log;
        x = y;
        value = next;
        damping = std::max(damping / damping_by, tolerance::solved);
      } else {
        damping *= damping_by;
      }
    }
    if (gain < enough || value.energy < none) return step + (gain > 0 ? 1 : 0);
  }
  return iterations;
}

Quadratic tension_of(const EnergyProblem& problem) {
  const FairingOptions& options = problem.options();
  Quadratic tension;
  if (!(options.tension > 0)) return tension;
  tension = problem.quadratic(1);
  const double wave = 2 * std::numbers::pi;
  tension *= options.tension * std::pow(wave, options.energy == Fairing::thin_plate ? 2 : 4);
  return tension;
}

namespace {

Merit merit_by(const EnergyProblem& problem, const Quadratic& third, Fairing energy) {
  Quadratic tension = tension_of(problem);
  if (problem.options().tension > 0)  // less its minimum, so that it pulls gradually where the energy alone would reach zero
    tension.constant -= tension(constrained_quadratic_minimum(tension.normal, tension.gradient, problem.held()));
  return {problem, third, std::move(tension), energy};
}

}  // namespace

Merit merit_of(const EnergyProblem& problem, const Quadratic& third) {
  return merit_by(problem, third, problem.options().energy);
}

Descent descent(const EnergyProblem& problem, const Quadratic& third) {
  const Merit merit = merit_of(problem, third);
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(problem.count());
  Descent d;
  d.first = minimum(problem, third);
  d.x = d.first;
  d.value = merit(d.x);
  if (const Merit::Value unchanged = merit(none); !(d.value.log < unchanged.log)) d.x = none, d.value = unchanged;
  d.iterations = descend(merit, third.normal, d.x, d.value, problem.options().iterations);
  return d;
}

Descent lowest_of_descents(const EnergyProblem& problem, const Quadratic& third, const Descent& first) {
  const FairingOptions& options = problem.options();
  const Merit merit = merit_of(problem, third);
  const auto descended = [&](const Merit& by, Descent from) {
    from.value = by(from.x);
    from.iterations += descend(by, third.normal, from.x, from.value, options.iterations);
    return from;
  };
  const auto lower = [](const Descent& a, const Descent& b) { return b.value.log < a.value.log; };
  Descent thin = first;
  thin.x = minimum(problem, problem.quadratic(2));
  const Eigen::VectorXd start = thin.x;
  thin = descended(merit, thin);
  Descent by_way = first;
  by_way.x = lower(first, thin) ? start : first.first;
  const Fairing other = options.energy == Fairing::automatic ? Fairing::minimum_variation : Fairing::automatic;
  by_way = descended(merit, descended(merit_by(problem, third, other), by_way));
  Descent lowest = lower(first, thin) ? thin : first;
  if (lower(lowest, by_way)) lowest = by_way;
  return lowest;
}

}  // namespace tripatch
