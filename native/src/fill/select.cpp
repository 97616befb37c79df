#include "tripatch/fill/select.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "tripatch/constructions/methods.h"
#include "tripatch/fill/any_rim_fill.h"
#include "tripatch/hole/rim_shape.h"
#include "tripatch/math/tolerant_compare.h"

namespace tripatch {
namespace {

// What scripts/calibrate fits to holes whose truth is known. Errors are shares of the hole's diameter.
/// Error of a patch per square root of its energy, which is 0 on spheres and cylinders.
constexpr double error_by_energy = 5e-4;
/// Error per radian by which the tangent planes along the boundary are unknown.
constexpr double error_by_planes = 0.125;
/// Error of plain triangles, which know nothing of the surroundings.
constexpr double error_of_triangles = 0.1;
/// Nobody sees less.
constexpr double negligible = 1e-5;

double stated_error(const Fill& fill, double size) {
  if (fill.known_error) return *fill.known_error;
  if (fill.deviation.size() > 0 || fill.report.method == rows_method) return root_mean_square(fill.deviation);
  if (!fill.patch) return error_of_triangles * size;
  if (fill.vertices.rows() == 0) return 0;
  return error_of_patch(fill.report.energy_after, fill.report.surroundings_error, size);
}

auto compared(const Quality& q) { return std::tuple(q.crosses, q.folds, q.exceeds_hole_bounds); }

/// Why a candidate is not used.
Code why_not(const Quality& quality, const Quality& used) {
  if (quality.crosses > used.crosses) return Code::candidate_crosses;
  if (quality.folds > used.folds) return Code::candidate_folds;
  if (quality.exceeds_hole_bounds > used.exceeds_hole_bounds) return Code::candidate_leaves_hole;
  return Code::less_accurate;
}

}  // namespace

double root_mean_square(const Eigen::VectorXd& values) {
  return values.size() == 0 ? 0 : values.norm() / std::sqrt(static_cast<double>(values.size()));
}

double expected_error(const Fill& fill, double size) {
  const double error = stated_error(fill, size);
  return error < size ? error : size;  // a number, too
}

double error_of_patch(double energy, double degrees, double size) {
  return std::hypot(size * error_by_energy * std::sqrt(energy), least_error(degrees, size));
}

double least_error(double degrees, double size) { return error_by_planes * degrees * std::numbers::pi / 180 * size; }

bool is_negligible(double error, double size) { return error <= negligible * size; }

Quality quality_of(const Mesh& mesh, const Fill& fill, double size, Index forced_folds, const FillOptions& options) {
  const Report& report = fill.report;
  Quality quality;
  quality.crosses = report.crosses_itself || fill.passes_through;
  quality.folds = std::max<Index>(report.triangles_folded - forced_folds, 0);
  if (fill.faces.size() == 0) quality.folds = report.folds;  // was not laid out for that
  quality.folds = std::max<Index>(quality.folds, report.folds > 0 ? 1 : 0);
  quality.exceeds_hole_bounds = !is_shaped_by_hand(options) && exceeds_hole_bounds(mesh, fill.rim, fill.vertices);
  quality.expected_error = expected_error(fill, size);
  quality.seam_deg = report.seam_angle_max;
  return quality;
}

void list_used(const Mesh& mesh, const FillOptions& options, Fill& fill) {
  Report& report = fill.report;
  std::vector<FillCandidate>& rows = report.candidates;
  if (rows.empty() || rows[0].status != CandidateStatus::used) rows.emplace(rows.begin());
  if (!report.method_reason) report.method_reason = Message{Code::requested};
  rows[0] = {report.method, CandidateStatus::used, quality_of(mesh, fill, diameter(mesh, fill.rim), report.rim_folded, options),
             report.method_reason};
  std::ranges::stable_sort(rows, {}, &FillCandidate::status);
}

bool is_valid(const Quality& quality) { return compared(quality) == compared({}); }

bool is_better(const Quality& a, const Quality& b) {
  if (compared(a) != compared(b)) return compared(a) < compared(b);
  return clearly_less(a.expected_error, b.expected_error);
}

const Tried* best_of(const TriedFills& tried) {
  const Tried* best = nullptr;
  for (const Tried& each : tried) {
    if (!each.fill) continue;
    // a patch that folds has no faces yet: it is laid out last, if nothing else is valid
    const bool has_faces = each.fill->faces.size() > 0, best_has = best && best->fill->faces.size() > 0;
    if (!best || (has_faces == best_has ? is_better(each.row.quality, best->row.quality) : has_faces)) best = &each;
  }
  return best;
}

TriedFills try_all(FillProblem& problem, std::span<const Strategy> strategies, double size,
                   Quality (*judged)(FillProblem&, const Fill&)) {
  TriedFills tried;
  for (const Strategy& strategy : strategies) {
    Tried now;
    now.row.method = strategy.method;
    now.variant = strategy.variant;
    try {
      now.row.why = strategy.skips(problem, tried);
      const Tried* const best = best_of(tried);
      if (!now.row.why && best && is_valid(best->row.quality) && is_negligible(best->row.quality.expected_error, size))
        now.row.why = Message{Code::accurate_enough, {{"method", best->row.method}}};
      if (!now.row.why) {
        now.fill = strategy.make(problem, tried);
        now.row.method = now.fill->report.method;
        now.row.status = CandidateStatus::made;
        now.row.quality = judged(problem, *now.fill);
      }
    } catch (const CodedRefusal& refusal) {
      now.row.status = CandidateStatus::refused;
      now.row.why = Message{Code::not_made, {{"reason", refusal.message()}}};
      now.refusal = refusal;
    }
    tried.push_back(std::move(now));
  }
  return tried;
}

Fill selected(TriedFills tried) {
  const Tried* const best = best_of(tried);
  if (!best) {
    const auto last = std::find_if(tried.rbegin(), tried.rend(), [](const Tried& each) { return each.refusal.has_value(); });
    throw *last->refusal;
  }
  const auto used = static_cast<std::size_t>(best - tried.data());
  std::vector<FillCandidate> rows;
  for (Tried& each : tried) {
    if (each.row.status == CandidateStatus::made) each.row.why = Message{why_not(each.row.quality, best->row.quality)};
    if (each.variant) each.row.why = Message{*each.variant, {{"reason", *each.row.why}}};
    rows.push_back(each.row);
  }
  Fill fill = std::move(*tried[used].fill);
  rows[used].status = CandidateStatus::used;
  rows[used].why = fill.report.method_reason;
  std::ranges::stable_sort(rows, {}, &FillCandidate::status);
  fill.report.candidates = std::move(rows);
  return fill;
}

}  // namespace tripatch
