// Chooses between ways to fill one hole: each is a candidate, all are judged by the same Quality, and the least one is used.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "tripatch/messages.h"
#include "tripatch/options.h"
#include "tripatch/output/fill_result.h"

namespace tripatch {

/// 0 of none.
double root_mean_square(const Eigen::VectorXd& values);
/// How far the new vertices of a fill are expected to be off, scene units. size: the diameter of the hole.
double expected_error(const Fill& fill, double size);
/// That of a patch by its energy, and by the error of its sides' tangent planes in degrees.
double error_of_patch(double energy, double degrees, double size);
/// That of a patch at least, by the error of its sides' tangent planes in degrees.
double least_error(double degrees, double size);
/// Whether nobody sees so small an error.
bool is_negligible(double error, double size);

/// size: the hole's diameter. forced_folds: folds that its rim leaves no way around.
Quality quality_of(const Mesh& mesh, const Fill& fill, double size, Index forced_folds, const FillOptions& options);
/// Puts the fill as it is delivered first in the candidates of its report. A method of which no reason is given was requested.
void list_used(const Mesh& mesh, const FillOptions& options, Fill& fill);

/// Whether a fill neither crosses itself nor folds nor leaves the hole.
bool is_valid(const Quality& quality);
/// Whether a is clearly the better one.
bool is_better(const Quality& a, const Quality& b);

/// A candidate with its fill if it was made, or its refusal.
struct Tried {
  FillCandidate row;
  std::optional<Code> variant;  ///< of its strategy
  std::optional<Fill> fill;
  std::optional<CodedRefusal> refusal;
};
using TriedFills = std::vector<Tried>;

/// The best of those that are made, of equal ones the first; null: none is.
const Tried* best_of(const TriedFills& tried);

/// Facts of a hole and the options of its fill.
struct FillProblem;

/// One way to fill a hole. tried: the candidates of the strategies before it.
struct Strategy {
  const char* method;
  /// What distinguishes it from others of the method; none: it is the plain one.
  std::optional<Code> variant;
  /// Why it is not tried; none: it is.
  Reason (*skips)(FillProblem&, const TriedFills& tried);
  /// May throw a CodedRefusal.
  Fill (*make)(FillProblem&, const TriedFills& tried);
};

/// Tries the strategies in their order, cheapest first, until the expected error is negligible. size: the diameter of the hole.
TriedFills try_all(FillProblem& problem, std::span<const Strategy> strategies, double size,
                   Quality (*judged)(FillProblem&, const Fill&));

/// The best fill; its report lists all candidates, this one first. Throws the last refusal if none is made.
Fill selected(TriedFills tried);

}  // namespace tripatch
