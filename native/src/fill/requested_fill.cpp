#include "tripatch/fill/requested_fill.h"

#include <algorithm>
#include <utility>

#include "tripatch/constructions/methods.h"
#include "tripatch/fill/any_rim_fill.h"
#include "tripatch/fill/automatic_fill.h"
#include "tripatch/fill/polygon_fill.h"
#include "tripatch/fill/triangle_fill.h"
#include "tripatch/hole/clear_corners.h"
#include "tripatch/hole/rim_checks.h"
#include "tripatch/messages.h"
#include "tripatch/output/shaped.h"
#include "tripatch/spline/small_fill.h"

namespace tripatch {
namespace {

Fill polygon_fill(const FillContext& context, const std::vector<Index>& rim, const std::vector<Index>& corners,
                  const FillOptions& options) {
  const CorneredRim found = cornered(context, rim, corners);
  const PolygonInput input = polygon_input(context.mesh, context.left, found.rim, found.places, options, context.planes);
  return fill_with_polygon(context.mesh, context.left, input, options).fill;
}

Fill round_fill(const FillContext& context, const std::vector<Index>& rim, const FillOptions& options) {
  const DiscInput input = disc_input(context.mesh, context.left, rim, options, context.planes);
  return fill_round(context.mesh, context.left, input, options).fill;
}

/// What a fill is chosen by: without what only changes the shape of the one that is chosen.
FillOptions choosing(const FillOptions& options) {
  static const FillOptions plain;
  FillOptions left = unshaped(options);
  left.fairing = plain.fairing;
  left.cross_boundary = plain.cross_boundary;
  const auto is_all = [&](SideContinuity c) { return options.continuity.are_all(c); };
  if (!is_all(SideContinuity::g1) && !meets_position_only(options)) left.continuity = plain.continuity;
  return left;
}

/// The patch between the sides of a fill that was chosen without what shapes it, made as it is asked for.
Fill patch_as_asked(const FillContext& context, const Fill& chosen, FillOptions options) {
  const std::vector<Index>& corners = chosen.report.corners;
  const auto is_free = [](SeamContinuity c) { return c == SeamContinuity::free; };
  const bool flat = is_continuity_open(options) && std::ranges::all_of(chosen.report.continuity, is_free);
  if (flat) options.continuity = SideContinuity::free;
  Fill made;
  if (corners.empty()) {
    if (is_continuity_open(options) && chosen.report.continuity[0] == SeamContinuity::g1) options.continuity = SideContinuity::g1;
    made = round_fill(context, chosen.rim, unshaped(options));
    shape(context.mesh, context.left, {}, options, made);
  } else if (chosen.report.method != polygon_method) {
    made = fill_with_patch(context, triangle_input(context, hole_of(context, chosen.rim, corners), options), options);
  } else {
    options.cross_boundary = CrossBoundary::consistent;  // of three sides
    made = polygon_fill(context, chosen.rim, corners, options);
  }
  made.report.method_reason = chosen.report.method_reason;
  made.report.candidates.assign(chosen.report.candidates.begin() + 1, chosen.report.candidates.end());
  if (flat && std::ranges::count(chosen.report.warnings, Code::flat_all_around, &Message::code) > 0)
    made.report.warnings.push_back({Code::flat_all_around});
  return made;
}

/// Whether nothing is asked for but that the hole be closed by triangles.
bool asks_for_nothing(const FillOptions& options) {
  const bool of_mesh = options.surroundings == SurroundingsFrom::mesh && options.output == Output::triangles;
  return of_mesh && !options.resolution && options.islands.empty() && !is_shaped_by_hand(options) &&
         options.cap == Cap::automatic;
}

/// Of a hole of three edges, or of few in smooth surroundings.
std::optional<Fill> fill_if_small(const FillContext& context, const std::vector<Index>& rim, const FillOptions& options) {
  if (rim.size() > max_edges_of_small || !fills_small(options)) return {};
  std::vector<Index> checked = check_topology(context.left, rim);
  check_finite(context.mesh, context.left, checked);
  std::rotate(checked.begin(), std::min_element(checked.begin(), checked.end()), checked.end());
  return checked.size() == 3 ? fill_with_one_triangle(context.mesh, context.left, checked)
                             : fill_small(context.mesh, context.left, checked);
}

}  // namespace

bool fills_small(const FillOptions& options) { return options.method == automatic_method && asks_for_nothing(options); }

std::optional<Fill> fill_with_many_sides(const FillContext& context, const std::optional<std::vector<Index>>& rim,
                                         const Corners& corners, const FillOptions& options) {
  const bool inner = !options.through.empty();
  if (corners && !corners->empty() && !makes_polygon(*corners) && !inner) return {};
  std::vector<Index> given = corners.value_or(std::vector<Index>());
  std::vector<Index> loop = rim ? *rim : given.empty() ? only_hole(context) : loop_through(context, given);
  loop = check_topology(context.left, loop);
  check_finite(context.mesh, context.left, loop);
  if (!corners) {
    given = at_places(loop, corners_of_fill(context.mesh, context.left, loop));
    const bool other = given.size() != 3 && options.method == patch_method;
    if (other || (given.size() == 3 && !inner)) return {};
    if (given.empty() && !is_round(context.mesh, context.left, loop)) {
      if (options.method == polygon_method) throw CodedRefusal(Code::patch_needs_sides, {{"method", polygon_method}}, loop);
      return {};
    }
  }
  check_counts(options, std::max<std::size_t>(given.size(), 1));
  Fill fill;
  if (given.empty()) {
    check_positions(context.mesh, context.left, loop);
    fill = round_fill(context, loop, options);
  } else {
    fill = polygon_fill(context, loop, given, options);
  }
  if (options.method != polygon_method) fill.report.method_reason = Message{Code::polygon_meets_points};
  return fill;
}

Fill fill_and_shape(const FillContext& context, const std::vector<Index>& loop, const Corners& corners,
                    const FillOptions& options) {
  if (corners) check_counts(options, std::max<std::size_t>(corners->size(), 1));
  if (!corners)
    if (std::optional<Fill> small = fill_if_small(context, loop, options)) return std::move(*small);
  FillOptions by = choosing(options);
  if (!options.fairing) by.fairing.reset();  // between three sides it takes ten times as long as all else
  Fill fill = fill_as_the_rim_asks(context, loop, corners, by);
  const bool of_three = fill.report.method == patch_method;
  if (!options.fairing && !of_three) {
    by.fairing = choosing(options).fairing;
    fill = fill_as_the_rim_asks(context, loop, corners, by);
  }
  const bool as_chosen = options.fairing == by.fairing && options.continuity == by.continuity &&
                         (options.cross_boundary == by.cross_boundary || !of_three);
  // a round rim's patch is a surface of revolution where it can be, and stays one
  if (!fill.sides.empty() && options.islands.empty() && ((is_shaped(options) && !fill.report.corners.empty()) || !as_chosen)) {
    try {
      return patch_as_asked(context, fill, options);
    } catch (const CodedRefusal& refusal) {  // of what is asked for
      fill.report.warnings.push_back(refusal.message());
    }
  }
  shape(context.mesh, context.left, sizes_of(options.islands), options, fill);
  if (asks_for_nothing(options)) close_if_flat(context, options, fill);
  return fill;
}

std::vector<std::size_t> sizes_of(const std::vector<std::vector<Index>>& islands) {
  std::vector<std::size_t> sizes;
  for (const std::vector<Index>& island : islands) sizes.push_back(island.size());
  return sizes;
}

}  // namespace tripatch
