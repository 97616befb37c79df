#include "tripatch/fairing/fairing.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include "tripatch/fairing/center.h"
#include "tripatch/fairing/descent.h"
#include "tripatch/fairing/energy.h"
#include "tripatch/fairing/fairing_problem.h"
#include "tripatch/fairing/fold_removal.h"
#include "tripatch/math/linear.h"

namespace tripatch {
namespace {

/// A geometric energy that stays above this is that of waves of an eighth of the hole, shorter than what the unknowns and the quadrature
/// can follow (it grows with the fourth power); what is least then is not near to anything. Of 407 holes in Suzanne's limit surface,
/// corners anywhere, 317 were so: their fairest patches were 1.4 times as far from the truth as plain ones, of the others half as far.
constexpr double hopeless = 5e3;
/// The same where the curvature along all sides is known well enough to be followed: Franke's hole from the chart's own sides, at 1e4, comes
/// to 8.3e-3 of the truth, plain 2.0e-2.
constexpr double hopeless_even_so = 2e4;

constexpr Index few_folds = 100;  // of a grid's 2145 points: where more fold, a little of the interior term cannot help

/// Where the energy on all nodes is above that on a few by more than this (and the surface is rich), the patch oscillates between the few.
/// With it Franke's hole came to 9.3e-3 of the truth instead of 1.4e-2.
constexpr double oscillating = 1.25;

struct Candidate {
  Eigen::VectorXd x;
  double energy;
};

/// What is left to choose from.
struct Candidates {
  std::optional<FairingProblem> problem;  // whose unknowns they are
  std::vector<Candidate> best_first;
  double before = 0;  // energy of the base
  int iterations = 0;
  bool beyond = false;  // what an energy can tell
};

/// FairingOptions::tension; without unknowns: none.
Quadratic tension_of(const FairingProblem& problem) {
  const FairingOptions& options = problem.options();
  Quadratic tension;
  if (!(options.tension > 0)) return tension;
  tension = problem.quadratic(1);
  const double wave = 2 * std::numbers::pi;
  tension *= options.tension * std::pow(wave, options.energy == Fairing::thin_plate ? 2 : 4);
  return tension;
}

/// size: of the hole, for the energies' units.
Candidates quadratic_candidates(const FairingBase& base, const FairingOptions& options, double size) {
  Candidates out;
  const FairingProblem& problem = out.problem.emplace(base, options, options.nodes);
  Quadratic q = problem.quadratic(options.energy == Fairing::thin_plate ? 2 : 3);
  if (options.tension > 0) q += tension_of(problem);
  const double unit = size * size;
  out.before = unit * q.constant;
  const Eigen::VectorXd x = minimum(problem, q);
  out.best_first.push_back({x, unit * q(x)});
  return out;
}

Merit merit_of(const FairingProblem& problem, const Quadratic& third) {
  Quadratic tension = tension_of(problem);
  if (problem.options().tension > 0)  // less its minimum, so that it pulls gradually where the energy alone would reach zero
    tension.constant -= tension(constrained_quadratic_minimum(tension.normal, tension.gradient, problem.held()));
  return {problem, third, std::move(tension), problem.options().energy};
}

struct Descent {
  Eigen::VectorXd first, x;  // the third-derivative solution, and what became of it
  Merit::Value value;
  int iterations;
};

Descent descent(const FairingProblem& problem, const Quadratic& third) {
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

/// With few nodes and unknowns first: the last steps are those of the exact energy.
Candidates geometric_candidates(const FairingBase& base, const FairingOptions& low) {
  Candidates out;
  const FairingProblem rough(base, low, low.rough_nodes);
  Quadratic third = rough.quadratic(3);
  Descent d = descent(rough, third);
  out.iterations = d.iterations;
  FairingOptions options = low;
  if (d.value.energy > low.rich) options.degree = std::max(low.degree, low.high_degree);
  const bool raised = options.degree > low.degree;
  const FairingProblem& problem = out.problem.emplace(base, options, options.nodes);
  if (raised) third = problem.quadratic(3);
  const Merit merit = merit_of(problem, third);
  Eigen::VectorXd x = problem.raised(rough, d.x);
  Merit::Value value = merit(x);
  if (value.energy > std::max(low.rich, oscillating * d.value.energy)) {
    const FairingProblem all(base, low, low.nodes);
    d = descent(all, all.quadratic(3));
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
  const std::array<bool, 3>& free = options.position_only;
  const double bound = problem.following().all() ? hopeless_even_so : hopeless;
  out.beyond = least > bound && !problem.controlled() && !free[0] && !free[1] && !free[2];
  return out;
}

/// The candidate to be taken: the first with folds no more than the plain patch has, or that can do without them.
class CandidateChoice {
public:
  CandidateChoice(const FairingBase& base, const FairingBase& measured, const FairingOptions& options, const FoldCounter* folds,
                  const Candidates& candidates)
      : base_(base),
        measured_(measured),
        options_(options),
        folds_(folds),
        candidates_(candidates),
        start_(options.center ? with_center(base.patch, *options.center) : base.patch) {}

  /// Of all candidates or, none of them being any good, of the start alone.
  FairResult best_of(std::span<const Candidate> candidates) const {
    Tried best;
    best.result.patch = start_;
    best.result.energy = options_.energy;
    best.result.iterations = candidates_.iterations;
    best.result.before = best.result.after = candidates_.before;
    best.measured = measured_.patch;
    if (folds_ && candidates.empty()) best.result.folds = (*folds_)(*start_);
    for (const Candidate& candidate : candidates) {
      if (!(candidate.energy <= best.result.before)) continue;
      Tried now = with(candidate, best);
      if (now.result.folds.value_or(0) == 0) return now.result;
      if (!best.result.folds) best.result.folds = (*folds_)(*start_);  // counted only when needed
      if (without_folds(now) ? now.result.after <= now.result.before : *now.result.folds <= *best.result.folds) return now.result;
      best.result.warnings = {"The fairest patch would fold over itself; a less fair one is used"};
    }
    without_folds(best);
    return best.result;
  }

private:
  struct Tried {
    FairResult result;
    SurfacePtr measured;  // the same on smoothed sides, on which energies are measured
  };

  Tried with(const Candidate& candidate, const Tried& start) const {
    const SurfacePtr correction = candidates_.problem->correction(candidate.x, base_.sides);
    Tried now = start;
    now.result.patch = sum(base_.patch, correction);
    // last: the sides that are measured and the sides as they are differ a little
    if (options_.center) now.result.patch = with_center(now.result.patch, *options_.center);
    now.result.after = candidate.energy;
    now.result.folds.reset();
    if (folds_) now.result.folds = (*folds_)(*now.result.patch);
    now.measured = sum(measured_.patch, correction);
    return now;
  }

  /// Takes the folds out, unless there are too many; true where there were any and none are left.
  bool without_folds(Tried& tried) const {
    FairResult& result = tried.result;
    const Index found = result.folds.value_or(0);
    if (found == 0 || found > few_folds || options_.center) return false;  // a given center stays where it is
    const SurfacePtr correction = fold_removal(result.patch, base_.sides, base_.boundary.size, *folds_);
    if (!correction) return false;
    result.patch = sum(result.patch, correction);
    result.folds = 0;
    if (options_.tension == 0)
      result.after = energy(*sum(tried.measured, correction), options_.energy, base_.boundary.size, options_.nodes);
    return true;
  }

  const FairingBase &base_, &measured_;
  const FairingOptions& options_;
  const FoldCounter* folds_;
  const Candidates& candidates_;
  SurfacePtr start_;
};

}  // namespace

FairResult fair(const FairingBase& base, const FairingBase& given_measured, const FairingOptions& given,
                const FoldCounter* folds) {
  FairingBase measured = given_measured;
  if (given.center) measured.patch = with_center(measured.patch, *given.center);
  FairingOptions options = given;
  if (given.automatic[0] || given.automatic[1] || given.automatic[2]) {
    const std::array<bool, 3> agree = curvature_agrees(measured.sides);
    for (int i = 0; i < 3; ++i) options.curvature[i] = given.curvature[i] || (given.automatic[i] && agree[i]);
  }
  const Candidates candidates = is_quadratic(given.energy) ? quadratic_candidates(measured, options, base.boundary.size)
                                                           : geometric_candidates(measured, options);
  const CandidateChoice choice(base, measured, options, folds, candidates);
  FairResult fairest;
  if (!candidates.beyond) {
    fairest = choice.best_of(candidates.best_first);
    if (fairest.folds.value_or(0) <= few_folds) return fairest;
  }
  FairResult plain = choice.best_of({});
  plain.gave_up = true;
  plain.warnings = {
      "The surroundings vary too rapidly over the length of the hole to be continued fairly; the plain patch is used"};
  if (plain.folds.value_or(0) == 0) return plain;
  if (candidates.beyond) fairest = choice.best_of(candidates.best_first);
  return fairest.folds == Index{0} ? fairest : plain;
}

}  // namespace tripatch
