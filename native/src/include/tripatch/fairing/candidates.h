// What a fairing has to choose from: the solutions of the quadratic energies, and what descent makes of them.
//
// Problem: an EnergyProblem made of (base, options, nodes), with raised() and meets_planes() as FairingProblem has them.
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "tripatch/fairing/descent.h"
#include "tripatch/fairing/energy_problem.h"
#include "tripatch/math/thresholds.h"

namespace tripatch {

/// A geometric energy that stays above this is that of waves of an eighth of the hole, shorter than what the unknowns and the quadrature
/// can follow (it grows with the fourth power); what is least then is not near to anything. Of 407 holes in Suzanne's limit surface,
/// corners anywhere, 317 were so: their fairest patches were 1.4 times as far from the truth as plain ones, of the others half as far.
constexpr double hopeless = 5e3;
/// The same where the curvature along all sides is known well enough to be followed: Franke's hole from the chart's own sides, at 1e4, comes
/// to 8.3e-3 of the truth, plain 2.0e-2.
constexpr double hopeless_even_so = 2e4;
/// Whether the least energy that was found is one of those. followed: the curvature along all sides is.
inline bool beyond_energies(double least, bool followed) { return least > (followed ? hopeless_even_so : hopeless); }

/// Where the energy on all nodes is above that on a few by more than this (and the surface is rich), the patch oscillates between the few.
/// With it Franke's hole came to 9.3e-3 of the truth instead of 1.4e-2.
constexpr double oscillating = 1.25;
inline bool oscillates(double on_all, double on_few, double rich) { return on_all > std::max(rich, oscillating * on_few); }

struct Candidate {
  Eigen::VectorXd x;
  double energy;
};

/// What is left to choose from.
template <class Problem>
struct Candidates {
  std::optional<Problem> problem;  // whose unknowns they are
  std::vector<Candidate> best_first;
  double before = 0;  // energy of the base
  int iterations = 0;
  bool beyond = false;  // what an energy can tell
};

/// FairingOptions::tension; without unknowns: none.
Quadratic tension_of(const EnergyProblem& problem);
Merit merit_of(const EnergyProblem& problem, const Quadratic& third);

/// size: of the hole, for the energies' units.
template <class Problem, class Base>
Candidates<Problem> quadratic_candidates(const Base& base, const FairingOptions& options, double size) {
  Candidates<Problem> out;
  const Problem& problem = out.problem.emplace(base, options, options.nodes);
  Quadratic q = problem.quadratic(options.energy == Fairing::thin_plate ? 2 : 3);
  if (options.tension > 0) q += tension_of(problem);
  const double unit = size * size;
  out.before = unit * q.constant;
  const Eigen::VectorXd x = minimum(problem, q);
  out.best_first.push_back({x, unit * q(x)});
  return out;
}

struct Descent {
  Eigen::VectorXd first, x;  // the third-derivative solution, and what became of it
  Merit::Value value;
  int iterations;
};

Descent descent(const EnergyProblem& problem, const Quadratic& third);
/// The lowest of that and two others: from the thin plate; and, from the better start of both, by way of another energy, the least variation
/// to the automatic one, that one to the others.
Descent lowest_of_descents(const EnergyProblem& problem, const Quadratic& third, const Descent& first);

/// With few nodes and unknowns first: the last steps are those of the exact energy.
template <class Problem, class Base>
Candidates<Problem> geometric_candidates(const Base& base, const FairingOptions& low) {
  Candidates<Problem> out;
  const Problem rough(base, low, low.rough_nodes);
  Quadratic third = rough.quadratic(3);
  const auto least_of = [&](const Problem& of, const Quadratic& its_third) {
    const Descent first = descent(of, its_third);
    return low.many_starts && first.value.energy > low.rich ? lowest_of_descents(of, its_third, first) : first;
  };
  Descent d = least_of(rough, third);
  out.iterations = d.iterations;
  FairingOptions options = low;
  if (d.value.energy > low.rich) options.degree = std::max(low.degree, low.high_degree);
  const bool raised = options.degree > low.degree;
  const Problem& problem = out.problem.emplace(base, options, options.nodes);
  if (raised) third = problem.quadratic(3);
  const Merit merit = merit_of(problem, third);
  Eigen::VectorXd x = problem.raised(rough, d.x);
  Merit::Value value = merit(x);
  if (oscillates(value.energy, d.value.energy, low.rich)) {
    const Problem all(base, low, low.nodes);
    d = least_of(all, all.quadratic(3));
    out.iterations += d.iterations;
    x = problem.raised(rough, d.x);
    value = merit(x);
  }
  const Eigen::VectorXd first = problem.raised(rough, d.first);
  const Merit::Value before = merit(Eigen::VectorXd::Zero(problem.count()));
  out.before = before.energy;
  const auto take = [&](const Eigen::VectorXd& candidate, const Merit::Value& v) {
    if (v.log < before.log) out.best_first.push_back({candidate, v.energy});
  };
  const Eigen::VectorXd early = x;
  const Merit::Value early_value = value;
  const int last = descend(merit, third.normal, x, value, raised ? 2 : 1);
  out.iterations += last;
  take(x, value);
  if (last > 0) take(early, early_value);
  take(first, merit(first));
  const double least = out.best_first.empty() ? before.energy : out.best_first[0].energy;
  out.beyond = beyond_energies(least, problem.following().all()) && !problem.controlled() && problem.meets_planes();
  return out;
}

}  // namespace tripatch
