#include "tripatch/fill/automatic_fill.h"

#include <algorithm>
#include <array>
#include <memory>
#include <utility>
#include <variant>

#include "tripatch/constructions/methods.h"
#include "tripatch/creases/walls.h"
#include "tripatch/estimate/quadric.h"
#include "tripatch/fill/any_rim_fill.h"
#include "tripatch/fill/found_sides.h"
#include "tripatch/fill/polygon_fill.h"
#include "tripatch/fill/rows_fill.h"
#include "tripatch/fill/select.h"
#include "tripatch/fill/triangle_fill.h"
#include "tripatch/grid/continued_quads.h"
#include "tripatch/hole/rim_checks.h"
#include "tripatch/hole/rim_shape.h"
#include "tripatch/math/angle.h"
#include "tripatch/math/linear.h"
#include "tripatch/math/parallel.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/messages.h"
#include "tripatch/output/quad_cover.h"
#include "tripatch/report/dihedrals.h"
#include "tripatch/report/folded_triangles.h"
#include "tripatch/spline/averaged_models.h"
#include "tripatch/spline/plane_fill.h"
#include "tripatch/spline/plane_patch.h"

namespace tripatch {

namespace {

/// What the patch of a hole is made of.
using PatchInput = std::variant<TriangleInput, PolygonInput, DiscInput>;

}  // namespace

/// Of one hole.
struct FillProblem {
  FillProblem(const FillContext& g, const std::vector<Index>& given_rim, const Corners& given, const FillOptions& asked)
      : context(g), rim(given_rim), loop(check_topology(g.left, given_rim)), corners(given), options(asked) {}

  /// The same problem as before, if it is one.
  static std::shared_ptr<FillProblem> of(const FillContext& context, const std::vector<Index>& rim, const Corners& corners,
                                         const FillOptions& options) {
    if (context.problem && context.problem->options.fairing == options.fairing) return context.problem;
    auto problem = std::make_shared<FillProblem>(context, rim, corners, options);
    if (context.is_part()) context.problem = problem;
    return problem;
  }

  const SidesFound& sides() {
    if (!sides_) sides_ = found_sides(context, loop, corners, options);
    return *sides_;
  }
  bool is_flat() const { return sides_ && sides_->is_flat; }
  /// Begins the spline on another thread, where one is free.
  void begin_spline() {
    if (may_share()) begun_ = std::make_unique<AsyncTask<Fill>>([this] { return spline_anew(); });
  }
  void end_spline() { begun_.reset(); }
  Fill spline() {
    if (spline_) return *spline_;
    const std::unique_ptr<AsyncTask<Fill>> begun = std::move(begun_);
    Fill made = begun ? begun->get() : spline_anew();
    if (context.is_part()) spline_ = made;
    return made;
  }

  const FillContext& context;
  const std::vector<Index> rim;
  const std::vector<Index> loop;  ///< checked
  const Corners corners;          ///< as given
  const FillOptions options;
  const double size = diameter(context.mesh, loop);
  std::optional<PatchInput> input;             ///< once it is read for the patch
  bool is_of_revolution = false;               ///< the surroundings of a round rim
  std::optional<std::pair<Fill, bool>> patch;  ///< once it is made, and whether it is of revolution
  std::optional<Fill> early_spline;            ///< if it was made before the patch

private:
  Fill spline_anew() const { return fill_any_rim(context, rim, sides_->of_spline, sides_->options); }

  std::optional<SidesFound> sides_;
  std::optional<Fill> spline_;
  std::unique_ptr<AsyncTask<Fill>> begun_;  // the last: it ends before what it reads
};

namespace {

Reason unless(bool tried, Code reason) { return tried ? Reason() : Message{reason}; }

Quality judged(FillProblem& problem, const Fill& fill) {
  const FillContext& context = problem.context;
  const bool is_known = fill.report.method == spline_method || fill.report.triangles_folded == 0;
  const Index forced = is_known ? fill.report.rim_folded : folds_of_rim(context.mesh, context.left, {fill.rim});
  Quality quality = quality_of(context.mesh, fill, problem.size, forced, problem.options);
  const Fill* const only = &fill;
  if (context.keeps_clear && context.passages_of({&only, 1}, problem.options)[0]) quality.crosses = true;
  return quality;
}

/// Whether the patch between the sides is used if it is valid, whatever else would be more accurate.
bool wants_patch(FillProblem& problem) {
  // without fairing nothing tells how accurate a patch between three sides is, and fairing takes ten times as long as all else
  const bool unknown = !problem.options.fairing && problem.sides().domain == PatchDomain::triangle;
  const bool given = problem.corners && !problem.corners->empty();
  return given || unknown || is_shaped_by_hand(problem.options) || problem.options.cap != Cap::automatic;
}

const Tried& patch_in(const TriedFills& tried) { return tried[1]; }
const Tried& spline_in(const TriedFills& tried) { return tried[4]; }

Reason skip_rows(FillProblem& problem, const TriedFills&) {
  const FillOptions& options = problem.options;
  const bool as_they_come = !problem.corners && options.resolution.value_or(0) == 0;
  if (!as_they_come || !options.islands.empty() || !options.through.empty() || meets_position_only(options) ||
      options.cap != Cap::automatic)
    return Message{Code::rows_take_no_options};
  const bool among_quads = options.output != Output::triangles || is_among_quads(problem.context.left, problem.loop);
  return unless(among_quads, Code::not_among_quads);
}

Fill make_rows(FillProblem& problem, const TriedFills&) {
  std::optional<Fill> fill = fill_with_rows(problem.context, problem.loop, problem.options.output, problem.options.features);
  if (!fill) throw CodedRefusal(Code::no_rows_of_quads, problem.loop);
  fill->report.method_reason = Message{Code::rows_continue};
  return std::move(*fill);
}

Fill new_spline(FillProblem& problem, const TriedFills& tried) {
  Fill fill = problem.spline();
  const std::optional<Fill>& rows = tried.front().fill;  // even quads, whatever their heights
  if (rows && problem.options.output == Output::quads)
    if (std::optional<Fill> even = rows_on_surface(problem.context, *rows, fill)) return std::move(*even);
  return fill;
}

void check_sides(const FillContext& context, const std::vector<Index>& rim, std::span<const Index> corners) {
  if (zigzag(context.mesh, rim, corners) > smooth_sides) throw CodedRefusal(Code::sides_zigzag, rim);
}

FillOptions options_of_patch(FillProblem& problem) {
  FillOptions options = problem.sides().options;
  if (problem.sides().domain != PatchDomain::triangle) options.cross_boundary = CrossBoundary::consistent;  // of three sides
  return options;
}

PatchInput read_input(FillProblem& problem) {
  const FillContext& context = problem.context;
  const SidesFound& sides = problem.sides();
  const FillOptions options = options_of_patch(problem);
  if (sides.domain == PatchDomain::triangle) {
    check_counts(options, 3);
    check_sides(context, sides.hole.rim, sides.hole.corners);
    return triangle_input(context, sides.hole, options);
  }
  if (sides.domain == PatchDomain::disc) {
    check_counts(options, 1);
    check_positions(context.mesh, context.left, problem.loop);
    return disc_input(context.mesh, context.left, problem.loop, options, context.planes);
  }
  check_counts(options, sides.corners.size());
  const CorneredRim found = cornered(context, problem.rim, sides.corners);
  check_sides(context, found.rim, found.places);
  if (!wants_patch(problem)) problem.begin_spline();
  return polygon_input(context.mesh, context.left, found.rim, found.places, options, context.planes);
}

const PatchInput& input_of(FillProblem& problem) {
  if (!problem.input) problem.input = read_input(problem);
  return *problem.input;
}

/// A patch is left out whose tangent planes are so uncertain that the spline is better whatever the patch is like.
Reason skip_patch(FillProblem& problem, const TriedFills& tried) {
  if (problem.sides().domain == PatchDomain::none) return problem.sides().reason;
  const double degrees = std::visit([](const auto& input) { return input.planes_error; }, input_of(problem));
  const double least = least_error(degrees, problem.size);
  if (wants_patch(problem) || is_negligible(least, problem.size)) return {};
  try {
    if (!problem.early_spline) problem.early_spline = new_spline(problem, tried);
  } catch (const CodedRefusal&) {
    return {};  // reported where the spline has its turn
  }
  const Quality quality = judged(problem, *problem.early_spline);
  const bool beaten = is_valid(quality) && least >= quality.expected_error;
  if (!beaten) return {};
  return Message{Code::not_more_accurate, {{"method", problem.early_spline->report.method}}};
}

bool is_beside_sharp(const Fill& patch) { return std::ranges::count(patch.report.continuity, SeamContinuity::free) > 0; }

Fill unless_given_up(const FillProblem& problem, PolygonFill made) {
  if (made.gave_up && !is_shaped_by_hand(problem.options)) throw CodedRefusal(Code::surroundings_too_rough, problem.loop);
  return std::move(made.fill);
}

/// laid_out: also if it folds.
Fill make_polygon(FillProblem& problem, bool laid_out) {
  const PolygonInput& input = std::get<PolygonInput>(input_of(problem));
  Fill fill = unless_given_up(
      problem, fill_with_polygon(problem.context.mesh, problem.context.left, input, options_of_patch(problem), laid_out));
  if (input.corners.size() == 2 && is_beside_sharp(fill) && !wants_patch(problem))
    throw CodedRefusal(Code::two_sides_tell_less, problem.loop);
  return fill;
}

Fill make_disc(FillProblem& problem, const SideContinuity* continuity) {
  FillOptions options = options_of_patch(problem);
  if (continuity) options.continuity = *continuity;
  PolygonFill made =
      fill_round(problem.context.mesh, problem.context.left, std::get<DiscInput>(input_of(problem)), options, false);
  problem.is_of_revolution = made.of_revolution;
  return unless_given_up(problem, std::move(made));
}

Fill make_patch(FillProblem& problem, const TriedFills&) {
  if (problem.patch) {
    problem.is_of_revolution = problem.patch->second;
    return problem.patch->first;
  }
  const PatchInput& input = input_of(problem);
  const auto* const three = std::get_if<TriangleInput>(&input);
  Fill fill = three                                      ? fill_with_patch(problem.context, *three, options_of_patch(problem))
              : std::holds_alternative<DiscInput>(input) ? make_disc(problem, nullptr)
                                                         : make_polygon(problem, false);
  const bool revolved = problem.is_of_revolution && problem.options.cap == Cap::automatic;
  fill.report.method_reason = revolved ? Message{Code::is_of_revolution} : problem.sides().reason;
  if (problem.context.is_part()) problem.patch = {fill, problem.is_of_revolution};
  return fill;
}

/// A cap of revolution that continues as its surroundings bend, and leaves the hole: one that is tangent to them only or, if that one does
/// too, a flat one.
Reason skip_lower_cap(FillProblem& problem, const TriedFills& tried) {
  if (!problem.is_of_revolution) return Message{Code::not_of_revolution};
  const bool leaves = patch_in(tried).row.quality.exceeds_hole_bounds && is_continuity_open(problem.sides().options);
  return unless(leaves, Code::cap_follows_curvature);
}

Fill make_lower_cap(FillProblem& problem, const TriedFills&) {
  for (const SideContinuity less : {SideContinuity::g1, SideContinuity::free}) {
    Fill fill = make_disc(problem, &less);
    if (!problem.is_of_revolution || !is_valid(judged(problem, fill))) continue;
    fill.report.method_reason = Message{Code::lower_cap_stays};
    if (less == SideContinuity::free) fill.report.warnings.push_back({Code::flat_all_around});
    return fill;
  }
  throw CodedRefusal(Code::lower_cap_fails, problem.loop);
}

Reason skip_lid(FillProblem& problem, const TriedFills&) { return unless(problem.sides().has_lost_wall, Code::no_wall_missing); }

Fill make_lid(FillProblem& problem, const TriedFills&) {
  const SidesFound& sides = problem.sides();
  Fill fill = fill_flat(problem.context, problem.loop, sides.options);
  fill.report.method_reason = sides.reason;
  if (problem.options.cap == Cap::flat) fill.report.warnings.clear();
  return fill;
}

/// Why the whole surrounding surface is continued.
Reason why_spline(FillProblem& problem, const TriedFills& tried) {
  const SidesFound& sides = problem.sides();
  if (sides.domain == PatchDomain::none || problem.options.cap != Cap::automatic) return sides.reason;
  const std::size_t count = sides.domain == PatchDomain::triangle ? 3 : std::max<std::size_t>(sides.corners.size(), 1);
  const Tried& patch = patch_in(tried);
  if (patch.refusal) return Message{Code::no_patch_fits, {{"count", count}, {"reason", patch.refusal->message()}}};
  const Quality& quality = patch.row.quality;
  return Message{quality.crosses               ? Code::patch_crosses
                 : quality.folds > 0           ? Code::patch_folds_over
                 : quality.exceeds_hole_bounds ? Code::patch_leaves_hole
                                               : Code::surroundings_tell_more,
                 {{"count", count}}};
}

Reason skip_spline(FillProblem& problem, const TriedFills& tried) {
  if (problem.sides().has_lost_wall) return problem.sides().reason;
  const Tried* const best = best_of(tried);
  if (!best || !is_valid(best->row.quality)) return {};
  if (wants_patch(problem)) return Message{Code::patch_requested};
  if (problem.is_of_revolution) return Message{Code::spline_of_revolution};
  return unless(!is_beside_sharp(*best->fill), Code::meets_sharp_sides);
}

Fill make_spline(FillProblem& problem, const TriedFills& tried) {
  Fill fill = problem.early_spline ? *problem.early_spline : new_spline(problem, tried);
  fill.report.method_reason = why_spline(problem, tried);
  return fill;
}

/// The spline with the tangent planes of a patch that is not valid itself, if they are known better.
Reason skip_spline_with_planes(FillProblem& problem, const TriedFills& tried) {
  const Tried &patch = patch_in(tried), &spline = spline_in(tried);
  if (!patch.fill || is_valid(patch.row.quality)) return Message{Code::has_planes_already};
  if (asks_for_sides(problem.sides().options)) return Message{Code::sides_requested};
  const bool better = spline.fill && patch.fill->report.surroundings_error < spline.fill->report.surroundings_error;
  return unless(better, Code::planes_not_better);
}

Fill make_spline_with_planes(FillProblem& problem, const TriedFills& tried) {
  Fill fill = fill_with_planes_of(problem.context, *patch_in(tried).fill, problem.sides().options);
  fill.report.method_reason = why_spline(problem, tried);
  return fill;
}

/// A spline that is not known to what nobody sees may have its vertices on a quadric.
Reason skip_quadric(FillProblem& problem, const TriedFills& tried) {
  const Tried &spline = spline_in(tried), *const best = best_of(tried);
  const bool is_open = !wants_patch(problem) && is_continuity_open(problem.options);
  const bool is_smooth = spline.fill && is_valid(spline.row.quality) && spline.fill->deviation.size() > 0 &&
                         spline.fill->feature_edges.empty() && spline.fill->report.warnings.empty();
  if (!is_open || !is_smooth) return Message{Code::no_smooth_spline};
  return unless(best->row.quality.expected_error > tolerance::close * problem.size, Code::is_known_well);
}

Fill make_on_quadric(FillProblem& problem, const TriedFills& tried) {
  const FillContext& context = problem.context;
  Fill fill = *spline_in(tried).fill;
  const Disc disc = disc_to_sample(context.mesh, context.left, {problem.loop}, reach_share * problem.size, rings_followed);
  const std::optional<Quadric> quadric = Quadric::through(with_points_on_edges(disc, disc.points));
  const Points rim = context.mesh.vertices(fill.rim, Eigen::all);
  const Index longest = static_cast<Index>(longest_edge(rim));
  const double edge = (rim.row((longest + 1) % rim.rows()) - rim.row(longest)).norm();
  if (!quadric) throw CodedRefusal(Code::not_on_quadric);
  fill.vertices = quadric->nearest(fill.vertices);
  fill.deviation = quadric->deviation(fill.vertices, edge);
  if (!(root_mean_square(fill.deviation) <= tolerance::same * problem.size)) throw CodedRefusal(Code::not_on_quadric);
  const PlanePoints places = stacked(fill.rim_uv, fill.uv);
  const Points change = stacked(rim, fill.vertices) - fill.patch->positions(as_rows(places));
  const SurfacePtr moved = through_vertices(places, change, rim.rows(), edge);
  if (!moved) throw CodedRefusal(Code::not_on_quadric);
  fill.patch = std::make_shared<PlanePatch>(sum(fill.patch, moved), fill.rim_uv);
  fill.normals = quadric->normals(fill.vertices, fill.normals);
  fill.rim_normals = quadric->normals(rim, fill.rim_normals);
  fill.report.deviation_max = fill.deviation.maxCoeff();
  measure_faces(context.mesh, fill.vertices, fill.faces, faces_beyond(context.mesh, context.left, {problem.loop}), fill.report);
  fill.report.method_reason = Message{Code::lies_on_quadric};
  return fill;
}

Reason skip_folded(FillProblem&, const TriedFills& tried) {
  const Tried* const best = best_of(tried);
  const bool laid_out = !patch_in(tried).fill || patch_in(tried).fill->faces.size() > 0;
  return unless(!laid_out && !(best && is_valid(best->row.quality)), Code::other_does_not_fold);
}

Fill make_folded(FillProblem& problem, const TriedFills&) {
  if (problem.sides().domain != PatchDomain::polygon) throw CodedRefusal(Code::patch_would_fold, problem.loop);
  Fill fill = make_polygon(problem, true);
  fill.report.method_reason = problem.sides().reason;
  return fill;
}

Reason skip_flat(FillProblem& problem, const TriedFills& tried) {
  const Tried* const best = best_of(tried);
  const bool passes = problem.context.keeps_clear && best && best->row.quality.crosses;
  return unless(passes && is_continuity_open(problem.options), Code::other_does_not_cross);
}

Fill make_flat(FillProblem& problem, const TriedFills&) {
  Fill fill = fill_flat(problem.context, problem.loop, problem.sides().options);
  fill.report.method_reason = Message{Code::tangent_fill_crosses};
  return fill;
}

/// All ways to fill a hole, the cheapest first. The patch is the second, the spline the fifth: others ask for them (see patch_in, spline_in).
constexpr std::array strategies = {
    Strategy{rows_method, {}, skip_rows, make_rows},
    Strategy{polygon_method, {}, skip_patch, make_patch},
    Strategy{polygon_method, Code::lower_cap, skip_lower_cap, make_lower_cap},
    Strategy{spline_method, Code::flat_wall, skip_lid, make_lid},
    Strategy{spline_method, {}, skip_spline, make_spline},
    Strategy{spline_method, Code::planes_of_patch, skip_spline_with_planes, make_spline_with_planes},
    Strategy{spline_method, Code::on_quadric, skip_quadric, make_on_quadric},
    Strategy{polygon_method, Code::folded_patch, skip_folded, make_folded},
    Strategy{spline_method, Code::flat_fill, skip_flat, make_flat},
};

/// The edges of the rim at which a fill meets the mesh at an angle.
std::vector<std::array<Index, 2>> sharp_rim_edges(const FillContext& context, const Fill& fill) {
  std::vector<std::array<Index, 2>> edges;
  for (const RimDihedral& each : rim_dihedrals(context.mesh, context.left, fill))
    if (radians(each.degrees) > min_crease_angle) edges.push_back(each.edge);
  return edges;
}

/// Whether nobody has asked for anything but that a wall that is lost comes back.
bool is_lid(const FillContext& context, const Fill& fill, const FillOptions& options) {
  if (options.cap != Cap::automatic || !options.islands.empty()) return options.cap == Cap::flat;
  return is_continuity_open(options) &&
         walls_end_at_flat_rim(context.mesh, context.left, fill.rim, diameter(context.mesh, fill.rim));
}

}  // namespace

Fill fill_as_the_rim_asks(const FillContext& context, const std::vector<Index>& rim, const Corners& corners,
                          const FillOptions& options) {
  if (!options.islands.empty()) return fill_around_islands(context, rim, options);
  const std::shared_ptr<FillProblem> problem = FillProblem::of(context, rim, corners, options);
  TriedFills tried = try_all(*problem, strategies, problem->size, judged);
  problem->end_spline();
  Fill fill = selected(std::move(tried));
  if (problem->is_flat()) fill.report.warnings.push_back({Code::flat_all_around});
  if (!is_lid(context, fill, options)) return fill;
  const std::vector<std::array<Index, 2>> edges = sharp_rim_edges(context, fill);
  fill.feature_edges.insert(fill.feature_edges.end(), edges.begin(), edges.end());
  return fill;
}

}  // namespace tripatch
