#include "tripatch/fairing/fairing.h"

#include <span>

#include "tripatch/fairing/candidates.h"
#include "tripatch/fairing/center.h"
#include "tripatch/fairing/energy.h"
#include "tripatch/fairing/fairing_problem.h"
#include "tripatch/fairing/fold_removal.h"
#include "tripatch/math/thresholds.h"

namespace tripatch {
namespace {

/// Of a grid's 2145 points: where more fold, a little of the interior term cannot help.
constexpr Index few_folds = count::hundred;

/// The candidate to be taken: the first with folds no more than the plain patch has, or that can do without them.
class CandidateChoice {
public:
  CandidateChoice(const FairingBase& base, const FairingBase& measured, const FairingOptions& options, const FoldCounter* folds,
                  const Candidates<FairingProblem>& candidates)
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
      best.result.warnings = {{Code::fairest_folds}};
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
  const Candidates<FairingProblem>& candidates_;
  SurfacePtr start_;
};

}  // namespace

void check_shape_options(bool faired, double tension, bool center, double center_offset) {
  if (tension > 0 && !faired) throw CodedArgument(Code::option_needs, {{"option", "tension"}, {"needed", "fairing"}});
  if (center && center_offset != 0)
    throw CodedArgument(Code::options_exclusive, {{"first", "center"}, {"second", "center_offset"}});
}

FairResult fair(const FairingBase& base, const FairingBase& given_measured, const FairingOptions& given,
                const FoldCounter* folds) {
  FairingBase measured = given_measured;
  if (given.center) measured.patch = with_center(measured.patch, *given.center);
  FairingOptions options = given;
  if (given.automatic[0] || given.automatic[1] || given.automatic[2]) {
    const std::array<bool, 3> agree = curvature_agrees(measured.sides);
    for (int i = 0; i < 3; ++i) options.curvature[i] = given.curvature[i] || (given.automatic[i] && agree[i]);
  }
  const Candidates<FairingProblem> candidates = is_quadratic(given.energy)
                                                    ? quadratic_candidates<FairingProblem>(measured, options, base.boundary.size)
                                                    : geometric_candidates<FairingProblem>(measured, options);
  const CandidateChoice choice(base, measured, options, folds, candidates);
  FairResult fairest;
  if (!candidates.beyond) {
    fairest = choice.best_of(candidates.best_first);
    if (fairest.folds.value_or(0) <= few_folds) return fairest;
  }
  FairResult plain = choice.best_of({});
  plain.gave_up = true;
  plain.warnings = {{Code::surroundings_vary}};
  if (plain.folds.value_or(0) == 0) return plain;
  if (candidates.beyond) fairest = choice.best_of(candidates.best_first);
  return fairest.folds == Index{0} ? fairest : plain;
}

}  // namespace tripatch
