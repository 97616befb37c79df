#include "tripatch/cage_fills/cage_fills.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numbers>
#include <utility>

#include "tripatch/cage_fills/tried_cages.h"
#include "tripatch/fill/insisted.h"
#include "tripatch/fill/select.h"
#include "tripatch/fill/triangle_fill.h"
#include "tripatch/hole/clear_corners.h"
#include "tripatch/hole/rim_checks.h"
#include "tripatch/hole/rim_shape.h"
#include "tripatch/math/angle.h"
#include "tripatch/math/parallel.h"
#include "tripatch/math/stopwatch.h"
#include "tripatch/math/tolerances.h"
#include "tripatch/messages.h"
#include "tripatch/output/doubled_edges.h"
#include "tripatch/output/shaped.h"

namespace tripatch {

namespace {

/// Of a cage that does harm: fewer rows may do none.
class Harmful final : public CodedRefusal {
public:
  using CodedRefusal::CodedRefusal;
};

/// Corners that nobody gave are a person's to choose, and no reason for a cage that crosses itself; guessed ones for none that folds either.
void refuse_if_harmful(const SidedRim& hole, bool crosses_itself, bool folds) {
  if (hole.given || !(crosses_itself || (hole.guessed && folds))) return;
  const std::vector<Index> corners = at_places(hole.rim, hole.corners);
  if (hole.guessed) throw Harmful(crosses_itself ? Code::cornerless_cage_crosses : Code::cornerless_cage_folds, corners);
  throw Harmful(crosses_itself ? Code::cage_crosses : Code::cage_folds, {{"count", hole.sides()}}, corners);
}

/// That of a vertex that is not to be a corner: less than of any four others.
constexpr double no_turn = -4 * std::numbers::pi;

/// Four vertices of a rim that shows no corners, as Grid Fill takes them: as many edges between opposite ones, or one more, where the rim
/// turns most at them. As few as possible have one face only, about which the limit of the open cage has no tangent plane. None of fewer than
/// four edges.
std::vector<Index> four_of(const FillContext& context, std::vector<Index> loop) {
  const std::size_t n = loop.size();
  if (n < 4) return {};
  std::rotate(loop.begin(), std::min_element(loop.begin(), loop.end()), loop.end());
  const auto at = [&](std::size_t k) -> Vec3 { return context.mesh.vertices.row(loop[k % n]); };
  std::vector<double> turn(n);
  for (std::size_t k = 0; k < n; ++k)
    turn[k] = context.left.at(loop[k]).size() < 2 ? no_turn : angle_between(at(k) - at(k + n - 1), at(k + 1) - at(k));
  const std::array<std::size_t, 4> steps = {0, (n + 2) / 4, n / 2, n / 2 + (n + 2) / 4};
  std::optional<std::size_t> best;
  double most = -INFINITY;
  for (std::size_t k = 0; k < n; ++k) {
    double sum = 0;
    for (std::size_t step : steps) sum += turn[(k + step) % n];
    if (sum > most + tolerance::same) most = sum, best = k;
  }
  std::vector<Index> corners;
  for (std::size_t step : steps)
    if (best) corners.push_back(loop[(*best + step) % n]);
  return corners;
}

std::optional<SidedRim> guessed_rim(const FillContext& context, const std::vector<Index>& loop) {
  const std::vector<Index> guess = four_of(context, loop);
  if (guess.empty()) return {};
  CorneredRim found = cornered(context, loop, guess);
  SidedRim result;
  result.rim = std::move(found.rim);
  result.corners = std::move(found.places);
  result.guessed = true;
  return result;
}

/// Edges of a fill that the mesh has already would have four faces.
void refuse_if_doubled(const FillContext& context, const SidedRim& hole, const Fill& fill) {
  if (!doubles_edges_of_mesh(context.left, hole.rim, fill.faces)) return;
  throw Harmful(Code::cage_doubles_edge, at_places(hole.rim, hole.corners));
}

using CageRows = std::vector<FillCandidate>;

void add(const CageRows& more, CageRows& all) { all.insert(all.end(), more.begin(), more.end()); }

/// A cage without harm between four guessed corners, or of quads that grow in from the rim. lost: those that do harm are added.
std::optional<Fill> harmless_without_corners(const FillContext& context, const SidedRim& hole, const FillOptions& options,
                                             SeenWays& seen, CageRows& lost) {
  std::optional<SidedRim> guess = hole.guessed ? hole : guessed_rim(context, hole.rim);
  for (const bool by_angle : {false, true}) {
    if (!guess || (hole.guessed && !by_angle)) continue;
    guess->by_angle = by_angle;
    const TriedOnes other = try_cages(context, {*guess}, options, &seen);
    if (!other->is_harmless()) {
      add(other->listed({}), lost);
      continue;
    }
    Fill fill = std::move(other->fills()[0]);
    if (is_finite(fill)) return fill;
  }
  return {};
}

/// With as many extra rows of quads as are asked for.
std::vector<Fill> with_these_rows(const FillContext& context, const std::vector<SidedRim>& holes, const FillOptions& options) {
  const SidedRim& first = holes[0];
  const bool alone = holes.size() == 1;
  SeenWays seen;
  const TriedOnes tried = try_cages(context, holes, options, alone && first.guessed ? &seen : nullptr);
  CageRows lost;
  if (alone && !first.given && !tried->is_harmless()) {
    const Fill faces = tried->faces();
    refuse_infinite(faces, first.rim);
    refuse_if_doubled(context, first, faces);
    std::optional<Fill> other;
    if (!is_named(options)) other = harmless_without_corners(context, first, options, seen, lost);
    if (other) {
      add(tried->listed({}), other->report.candidates);
      add(lost, other->report.candidates);
      return {std::move(*other)};
    }
    refuse_if_harmful(first, tried->crosses_itself(), true);
  }
  std::vector<Fill> fills = tried->fills();
  add(lost, fills[0].report.candidates);
  for (std::size_t h = 0; h < holes.size(); ++h) {
    const Report& report = fills[h].report;
    refuse_infinite(fills[h], holes[h].rim);
    refuse_if_doubled(context, holes[h], fills[h]);
    refuse_if_harmful(holes[h], report.crosses_itself, report.folds > 0 || report.triangles_folded > 0);
  }
  return fills;
}

/// A row of a cage with other extra rows, and those that it lists.
CageRows listed(const FillContext& context, int rows, const Fill& fill, const Harm& used, const FillOptions& options) {
  const Quality own = quality_of(context.mesh, fill, diameter(context.mesh, fill.rim), 0, options);
  const Message why = {why_not(harm(fill.report), used)};
  CageRows out = {
      {fill.report.method, CandidateStatus::made, own, Message{Code::cage_with_rows, {{"rows", rows}, {"reason", why}}}}};
  for (const FillCandidate& each : fill.report.candidates)
    if (each.status != CandidateStatus::skipped) out.push_back(each);
  return out;
}

/// The same, or fewer where that does less harm.
std::vector<Fill> with_rows_or_fewer(const FillContext& context, const std::vector<SidedRim>& holes, const FillOptions& options) {
  const int wanted = options.resolution.value_or(0);
  if (wanted == 0 || holes.size() > 1) return with_these_rows(context, holes, options);
  FillOptions fewer = options;
  std::optional<Fill> best;
  int most = 0;
  CageRows lost;
  for (int rows = wanted; !best || harm(best->report) != Harm(false, 0); rows /= 2) {
    fewer.resolution = rows;
    try {
      Fill fill = std::move(with_these_rows(context, holes, fewer)[0]);
      if (!best || harm(fill.report) < harm(best->report)) {
        if (best) add(listed(context, most, *best, harm(fill.report), fewer), lost);
        best = std::move(fill), most = rows;
      } else {
        add(listed(context, rows, fill, harm(best->report), fewer), lost);
      }
    } catch (const Harmful& refusal) {
      if (rows == 0 && !best) throw;
      const Message why = {Code::not_made, {{"reason", refusal.message()}}};
      lost.push_back({method_between(holes[0], options),
                      CandidateStatus::refused,
                      {},
                      Message{Code::cage_with_rows, {{"rows", rows}, {"reason", why}}}});
    }
    if (rows == 0) break;
  }
  add(lost, best->report.candidates);
  if (most < wanted) best->report.warnings.push_back({Code::fewer_rows, {{"rows", most}, {"wanted", wanted}}});
  return {std::move(*best)};
}

/// Between guessed corners there is no patch to be shaped: that of the guess leaves the mesh, folds or crosses itself.
FillOptions without_shape(FillOptions options) {
  const FillOptions plain;
  options.bulge = plain.bulge;
  options.tension = plain.tension;
  options.center = plain.center;
  options.center_offset = plain.center_offset;
  return options;
}

void tell_not_shaped(const FillOptions& options, Report& report) {
  for (const char* name : {"bulge", "tension", "center", "center_offset"}) report.not_applied.emplace(name, "sides");
  if (is_shaped(options)) report.warnings.push_back({Code::cornerless_cage_not_shaped});
}

}  // namespace

std::vector<Fill> fill_with_cages(const FillContext& context, const std::vector<SidedRim>& holes, const FillOptions& options) {
  const bool guessed = std::ranges::all_of(holes, [](const SidedRim& hole) { return hole.guessed; });
  std::vector<Fill> fills = with_rows_or_fewer(context, holes, guessed ? without_shape(options) : options);
  for (Fill& fill : fills)
    if (guessed) tell_not_shaped(options, fill.report);
  for (const Fill& fill : fills) refuse_if_insisted(context, fill, options);
  return fills;
}

namespace {

/// A group of cages, or where one of them stands in the way of the others each by itself.
std::vector<std::variant<Fill, Refused>> fill_group(const FillContext& context, const std::vector<SidedRim>& group,
                                                    const FillOptions& options) {
  const Stopwatch watch;
  std::vector<std::variant<Fill, Refused>> results;
  try {
    for (Fill& fill : fill_with_cages(context, group, options)) {
      fill.report.seconds = watch.seconds() / static_cast<double>(group.size());
      results.emplace_back(std::move(fill));
    }
  } catch (const CodedRefusal& refusal) {
    if (group.size() == 1) return {refused(refusal)};
    for (const SidedRim& hole : group) results.push_back(std::move(fill_group(context, {hole}, options)[0]));
  }
  return results;
}

}  // namespace

void fill_all_with_cages(const FillContext& context, const std::vector<std::optional<SidedRim>>& given,
                         const FillOptions& options, std::vector<std::variant<Fill, Refused>>& results,
                         const Progress& progress) {
  std::vector<SidedRim> holes;
  std::vector<std::size_t> place;  // of each hole in the results
  for (std::size_t k = 0; k < given.size(); ++k) {
    if (!given[k]) continue;
    holes.push_back(*given[k]);
    place.push_back(k);
  }
  const std::vector<std::vector<std::size_t>> groups = cage_groups(context.left, holes);
  std::atomic<std::size_t> done = given.size() - holes.size();
  const auto fill_one_group = [&](std::size_t g) {
    std::vector<SidedRim> together;
    for (std::size_t h : groups[g]) together.push_back(holes[h]);
    std::vector<std::variant<Fill, Refused>> made = fill_group(context, together, options);
    for (std::size_t k = 0; k < made.size(); ++k) results[place[groups[g][k]]] = std::move(made[k]);
    done += made.size();
  };
  parallel_for_each(groups.size(), fill_one_group, [&](std::size_t) {
    if (progress) progress(done);
  });
}

namespace {

/// Corners that are given or seen, else guessed ones.
SidedRim cornered_rim_of(const FillContext& context, const std::optional<std::vector<Index>>& rim, const Corners& corners) {
  if (corners && !corners->empty()) {
    if (!makes_polygon(*corners)) return hole_of(context, rim, corners);
    CorneredRim found = cornered(context, rim ? *rim : loop_through(context, *corners), *corners);
    SidedRim result;
    result.rim = std::move(found.rim);
    result.corners = std::move(found.places);
    return result;
  }
  CodedRefusal none(Code::cage_needs_corners);
  if (!corners) {
    try {
      return hole_of(context, rim, corners);
    } catch (const CodedRefusal& refusal) {
      none = refusal;
    }
  }
  const std::vector<Index> loop = check_topology(context.left, rim ? *rim : only_hole(context));
  check_finite(context.mesh, context.left, loop);
  if (!corners) {
    std::vector<Index> places = corners_by_valence(context.mesh, context.left, loop);
    if (places.empty()) places = corners_between_sides(context.mesh, context.left, loop);
    const std::vector<Index> seen = at_places(loop, places);
    if (makes_polygon(seen)) return cornered_rim_of(context, loop, seen);
  }
  const std::optional<SidedRim> guess = guessed_rim(context, loop);
  if (!guess) throw none;
  return *guess;
}

}  // namespace

SidedRim cage_rim_of(const FillContext& context, const std::optional<std::vector<Index>>& rim, const Corners& corners) {
  SidedRim found = cornered_rim_of(context, rim, corners);
  found.given = corners && !corners->empty();
  if (found.given || found.guessed || !grows_on(found, context.mesh.vertices, context.left)) return found;
  const std::vector<Index> by_valence = at_places(found.rim, corners_by_valence(context.mesh, context.left, found.rim));
  if (!by_valence.empty()) return cornered_rim_of(context, found.rim, by_valence);
  return guessed_rim(context, found.rim).value_or(found);
}

}  // namespace tripatch
