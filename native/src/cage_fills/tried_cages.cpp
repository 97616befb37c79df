#include "tripatch/cage_fills/tried_cages.h"

#include <cmath>
#include <limits>
#include <tuple>
#include <variant>

#include "tripatch/cage_fills/cage_inside.h"
#include "tripatch/fill/polygon_fill.h"
#include "tripatch/fill/select.h"
#include "tripatch/fill/triangle_fill.h"
#include "tripatch/hole/rim_shape.h"
#include "tripatch/math/interruption.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/messages.h"
#include "tripatch/output/shaped.h"
#include "tripatch/patch_from_sides.h"

namespace tripatch {
namespace {

/// Edges of a rim at a vertex, the shorter of both, that a face there is as long as, from which on it is a strip: twice the diagonal of two squares.
constexpr double strip = factor::large;
/// Of the hole's diameter: a fair cage that is farther off from where the mesh around would continue has run off, as between strips of bevels
/// or on a wave, and so much farther wherever it is. Of 566 holes in Blender's primitives, remeshes and bevels 28 are placed for it that are not
/// at 0.13, and 21 of their limit surfaces are nearer to the one that was there, by a factor of three in the mean. Of coarse balls, eggs
/// and tori six of 116, all nearer. Of 639 cages in boxes, prisms and cylinders bevelled by Blender it was 68 at 0.13.
constexpr double run_off = 0.04;
/// The same between four guessed corners: quads there are as large as four corners make them, and one of them that is larger than those around has
/// its limit farther inside. A ball of eight edges around is flattened at 0.04.
constexpr double run_off_of_guess = 0.13;
constexpr double far_off = share::quarter;
/// Of the hole's diameter, of where the mesh would continue: what is known better is met by the fairest cage, whose limit is fitted, two to five
/// times as nearly on balls. Else the limit is 0.53 times as far from the one that was there where the mesh continues, in the geometric mean of 23
/// holes in Blender's heads, skins, remeshes and subdivided boxes whose quads continue, at most 2.3 times.
constexpr double well_known = 3e-4;
/// Standard deviations of where the mesh would continue: a fair cage within as many is as likely. Suzanne's jaw is at 2.9, its fair cage four
/// times nearer to the surface that was there than the other; 27 of the bevels' cages stay as they were, an eighth of the gain.
constexpr double likely = 3.5;
/// Vertices of a cage from which on it is not made fair first, which takes a second of 600 and a minute and a half of 4,400. Of 340 holes
/// in Blender's primitives, remeshes and bevels the five largest, of 100 and more faces, are two thirds as far from the limit that was
/// there; with 10 to 100 faces it is 1.1 to 1.2 times as far. Over grids on balls and waves 150 to 4,400 are 0.2 to 1 times as far.
constexpr Index many = 150;
/// If it folds or crosses itself there, it is made fair after all up to so many vertices, which takes three seconds.
constexpr Index max_fair = count::quadratic;

/// Whether the patch's own shape is asked for.
bool has_own_shape(const FillOptions& options) {
  return is_shaped(options) || !options.through.empty() || std::ranges::any_of(options.continuity, [](SideContinuity c) {
           return c == SideContinuity::free || c == SideContinuity::g0;
         });
}

/// What came of placing a cage.
struct Placing {
  std::optional<Code> why_not = {};  ///< none: it was placed
  bool is_possible = true;           ///< whether there is somewhere to put it
  double error = 0;                  ///< of what it was placed on
};

/// Puts the vertices of a cage where rows of quads continue, if they do.
Placing place_in_rows(const FillContext& context, const SidedRim& hole, const FillOptions& options, CageFill& cage) {
  if (hole.given || options.cage_rim != CageRim::smooth || options.subdivision.loop || options.resolution.value_or(0) > 0)
    return {Code::options_ask_otherwise};
  const std::variant<InRows, Code> found = cage_in_rows(context, cage.laid_out(0), options.replaced);
  if (const Code* const why = std::get_if<Code>(&found)) return {*why};
  const auto& [points, error] = std::get<InRows>(found);
  cage.place(points);
  return {.error = error};
}

/// Tells of a cage that is farther from the patch that was asked for than the tolerance, rms.
void tell_distance(double tolerance, Report& report) {
  if (!(report.cage_deviation_rms > tolerance)) return;
  std::erase_if(report.warnings, [](const Message& each) { return each.code == Code::tolerance_out_of_reach; });
  report.warnings.push_back(
      {Code::cage_off_patch, {{"distance", report.cage_deviation_rms}, {"method", report.method}, {"tolerance", tolerance}}});
}

/// How far the vertices inside a cage are from where the mesh around would continue, if they have run off: by a share of the hole's
/// diameter, and farther than is likely.
std::optional<double> runs_off(const Points& inside, const OnMesh& on_mesh, double size, double share) {
  const double off = (inside - on_mesh.points).cwiseProduct(on_mesh.normals).rowwise().sum().cwiseAbs().maxCoeff();
  const double least = std::max(share * size, std::min(likely * on_mesh.deviation, far_off * size));
  return off > least ? std::optional(off) : std::nullopt;
}

/// Tells of a cage by a method that was asked for, which nothing keeps near to where the mesh around would continue.
void tell_run_off(const FillContext& context, const SidedRim& hole, const CageHole& laid_out, const Points& inside,
                  const FillOptions& options, Report& report) {
  if (inside.rows() == 0 || options.subdivision.loop) return;
  const std::optional<OnMesh> on_mesh = cage_on_mesh(context, hole, laid_out, options, Smoothed::no);
  if (!on_mesh) return;
  const std::optional<double> off = runs_off(inside, *on_mesh, diameter(context.mesh, hole.rim), run_off);
  if (!off) return;
  report.warnings.push_back({Code::cage_runs_off, {{"method", report.method}, {"distance", *off}}});
}

/// Puts the vertices of a cage, if it is one of those, where the mesh around would continue.
Placing place_on_mesh(const FillContext& context, const SidedRim& hole, const FillOptions& options, OnMeshWhere where,
                      CageFill& cage) {
  if (where == OnMeshWhere::nowhere) return {Code::other_tried_first};
  if (options.cage_rim != CageRim::smooth || options.subdivision.loop || options.resolution.value_or(0) > 0)
    return {Code::options_ask_otherwise, false};
  const Points inside = cage.inside(0);
  if (inside.rows() == 0) return {Code::no_vertices_inside, false};
  const Smoothed smoothed = where == OnMeshWhere::untangled  ? Smoothed::in_plane
                            : where == OnMeshWhere::likelier ? Smoothed::on_surface
                                                             : Smoothed::no;
  const std::optional<OnMesh> on_mesh = cage_on_mesh(context, hole, cage.laid_out(0), options, smoothed);
  if (!on_mesh) return {Code::no_surface_continues, false};
  const double size = diameter(context.mesh, hole.rim);
  if (where == OnMeshWhere::likelier && !(on_mesh->deviation > well_known * size)) return {Code::fair_cage_stays};
  const bool goes_on = !hole.guessed || cage.laid_out(0).layout.grown;
  if (where == OnMeshWhere::run_off && !runs_off(inside, *on_mesh, size, goes_on ? run_off : run_off_of_guess))
    return {Code::fair_cage_stays};
  cage.place(on_mesh->points);
  return {.error = on_mesh->error};
}

/// One of two, with the other among its candidates.
TriedOnes chosen(TriedOnes tried, TriedOnes other, bool takes_other) {
  if (takes_other) std::swap(tried, other);
  tried->list(*other);
  return tried;
}

constexpr Harm max_harm = {true, std::numeric_limits<Index>::max()};

CageOptions cage_options(const FillOptions& options) {
  CageOptions own;
  own.rim = options.cage_rim;
  return own;
}

}  // namespace

bool is_named(const FillOptions& options) { return options.method != automatic_method && options.method != polygon_method; }

TriedCages::TriedCages(const FillContext& context, std::vector<SidedRim> holes, FillOptions options, OnMeshWhere on_mesh,
                       SeenWays* seen)
    : ground_(context),
      holes_(std::move(holes)),
      options_(std::move(options)),
      no_harm_wanted_(seen != nullptr),
      named_(is_named(options_)),
      cages_(context.mesh, context.left, holes_, options_.subdivision, options_.replaced, layout_options(options_),
             cage_options(options_)),
      fills_(holes_.size()) {
  // The border of an open cage, to which an exact rim holds, is flat across and round at corners: a patch that is made fair bends
  // sharply behind it, and no cage follows. Elsewhere curvature shall vary least: in the cage, whose patch follows it, or where
  // the patch's own shape is asked for, in the patch.
  exact_ = options_.cage_rim == CageRim::exact;
  fair_ = options_.fairing == Fairing::automatic && !has_own_shape(options_);
  follows_ = fair_ && !exact_;
  if (seen && !seen->add(holes_[0], options_, on_mesh, cages_.laid_out(0).layout)) {
    was_seen_ = true;
    return;
  }
  put(on_mesh);
  waits_ = holes_.size() == 1 && options_.resolution.value_or(0) == 0 && (placed_ || (fair_ && !holes_[0].is_triangle()));
  if (waits_)
    cages_.fit({nullptr}, {true});
  else
    complete();
}

Code why_not(const Harm& lost, const Harm& used) {
  if (lost.first > used.first) return Code::candidate_crosses;
  return lost.second > used.second ? Code::candidate_folds : Code::does_as_much_harm;
}

Harm TriedCages::harm() {
  if (was_seen_) return max_harm;
  if (!waits_) return tripatch::harm(fills_[0].report);
  if (no_harm_wanted_) {
    if (!folded_) folded_ = cages_.triangles_folded(0);
    if (*folded_ > 0) return {false, *folded_};
  }
  return {cages_.harm(0).crossing.has_value(), cages_.harm(0).triangles_folded};
}

Quality TriedCages::quality() {
  const SidedRim& hole = holes_[0];
  const double size = diameter(ground_.mesh, hole.rim);
  if (!waits_) return quality_of(ground_.mesh, fills_[0], size, 0, options_);
  const Fill made = faces();
  Report energies;
  cages_.report_energies(0, energies);
  Quality out;
  out.exceeds_hole_bounds = exceeds_hole_bounds(ground_.mesh, hole.rim, made.vertices);
  out.expected_error = placed_    ? placed_error_.value_or(NAN)
                       : follows_ ? std::min(error_of_patch(energies.energy_after, 0, size), size)
                                  : NAN;
  out.seam_deg = NAN;
  return out;
}

std::vector<FillCandidate> TriedCages::listed(const Harm& used) {
  if (was_seen_) return others_;
  Quality own = quality();
  std::tie(own.crosses, own.folds) = harm_and_folds();
  const bool is_grown = cages_.laid_out(0).layout.grown;
  Message row = {way_, {{"reason", Message{why_not(harm_and_folds(), used)}}}};
  if (is_grown) row.parameters.push_back({"grown", ""});
  if (holes_[0].guessed && !is_grown) row.parameters.push_back({"guessed", ""});
  if (options_.odd == Odd::triangle && holes_[0].rim.size() % 2 == 1) row.parameters.push_back({"triangle", ""});
  if (rows() > 0) row.parameters.push_back({"rows", rows()});
  std::vector<FillCandidate> out = {{method_between(holes_[0], options_), CandidateStatus::made, own, row}};
  out.insert(out.end(), others_.begin(), others_.end());
  return out;
}

void TriedCages::list(TriedCages& lost) {
  const std::vector<FillCandidate> more = lost.listed(harm_and_folds());
  others_.insert(others_.end(), more.begin(), more.end());
  skipped_.merge(lost.skipped_);
}

std::vector<FillCandidate> TriedCages::others() const {
  std::vector<FillCandidate> out = others_;
  for (const auto& [way, why] : skipped_) {
    const auto is_listed = [way = way](const FillCandidate& each) { return each.why->code == way; };
    if (way != way_ && std::ranges::none_of(others_, is_listed))
      out.push_back(
          {method_between(holes_[0], options_), CandidateStatus::skipped, {}, Message{way, {{"reason", Message{why}}}}});
  }
  return out;
}

std::vector<Fill> TriedCages::fills() {
  if (waits_) complete();
  for (Fill& fill : fills_) fill.report.candidates = others();
  Messages& said = fills_[0].report.warnings;
  said.insert(said.end(), warnings_.begin(), warnings_.end());
  return std::move(fills_);
}

void TriedCages::put(OnMeshWhere on_mesh) {
  const bool alone = follows_ && holes_.size() == 1 && !named_, by_itself = alone && on_mesh == OnMeshWhere::run_off;
  const auto takes = [&](Code way, const Placing& found) {
    placed_ = !found.why_not;
    if (placed_)
      way_ = way, placed_error_ = found.error;
    else
      skipped_[way] = *found.why_not;
    return placed_;
  };
  const auto place = [&](OnMeshWhere where) {
    const Placing found = place_on_mesh(ground_, holes_[0], options_, where, cages_);
    has_other_place_ = found.is_possible;
    return takes(Code::cage_on_surface, found);
  };
  if (follows_) way_ = Code::fairest_cage;
  if (!alone && !named_)
    for (const Code way : {Code::cage_in_rows, Code::cage_on_surface, Code::fairest_cage})
      skipped_[way] = holes_.size() > 1 ? Code::cages_fitted_together : Code::options_ask_otherwise;
  const bool of_many = alone && cages_.inside(0).rows() > many && on_mesh != OnMeshWhere::nowhere,
             anyway = alone && (on_mesh == OnMeshWhere::everywhere || on_mesh == OnMeshWhere::untangled);
  if (alone) {
    skipped_[Code::cage_on_surface] = Code::other_tried_first;
    skipped_[Code::fairest_cage] = of_many ? Code::large_cage_on_surface : Code::other_tried_first;
  }
  in_rows_ = by_itself && takes(Code::cage_in_rows, place_in_rows(ground_, holes_[0], options_, cages_));
  if (!placed_ && (of_many || anyway)) {
    of_many_ = place(on_mesh == OnMeshWhere::untangled ? on_mesh : OnMeshWhere::everywhere) && of_many;
    if (!placed_) return cages_.make_fair();
  }
  likelier_ = !placed_ && by_itself && cages_.laid_out(0).layout.grown && place(OnMeshWhere::likelier);
  if (placed_) return;
  cages_.make_fair();
  if (alone && place(on_mesh)) skipped_[Code::fairest_cage] = Code::leaves_surface;
}

void TriedCages::make_patches() {
  FillOptions wanted = options_;
  if (options_.fairing == Fairing::automatic && exact_ && options_.tension == 0) wanted.fairing.reset();
  FillOptions over_polygon = options_;
  if (options_.method == automatic_method) over_polygon.cross_boundary = CrossBoundary::consistent;  // of three sides
  if (placed_) cages_.take_sides();
  for (std::size_t h = 0; h < holes_.size(); ++h) {
    check_interruption();
    // between other than three sides the patch is that of a smooth rim in any case
    if (holes_[h].is_triangle() && !options_.through.empty()) throw CodedRefusal(Code::cage_meets_no_points, holes_[h].rim);
    MadePatch made =
        holes_[h].is_triangle()
            ? patch_from_sides(three_sides(cages_.sides(h)), wanted, follows_ ? &cages_.points(h) : nullptr)
            : patch_over_polygon(cages_.sides(h), cages_.domain(h), over_polygon, fair_ ? &cages_.points(h) : nullptr);
    fills_[h].patch = std::move(made.patch);
    fills_[h].report = std::move(made.report);
  }
}

void TriedCages::complete() {
  make_patches();
  // The rim's limit may run along its edges at very different rates, next to strips that are long next to them: a patch that folds in
  // following the fairest cage there is worth nothing, and the cage is kept.
  std::vector<bool> kept;
  std::vector<SurfacePtr> patches;
  for (std::size_t h = 0; h < holes_.size(); ++h) {
    kept.push_back(placed_ || (fair_ && !named_ && (!holes_[h].is_triangle() || (follows_ && fills_[h].report.folds > 0))));
    patches.push_back(fills_[h].patch);
  }
  if (!waits_) cages_.fit(patches, kept);
  waits_ = false;
  for (std::size_t h = 0; h < holes_.size(); ++h) {
    cages_.complete(h, fills_[h]);
    Report& report = fills_[h].report;
    if (follows_) cages_.report_energies(h, report);
    if (placed_) fills_[h].known_error = placed_error_;
    if (kept[h]) report.folds = 0;  // of a patch that the cage is not fitted to
    // Nor is a distance to it of interest, unless a tolerance for that was given.
    if (kept[h] && !options_.tolerance) report.cage_deviation_max = report.cage_deviation_rms = 0;
    complete_report(holes_[h], options_, report);
    if (named_ || options_.tolerance) tell_distance(cages_.tolerance(h), report);
    if (named_) tell_run_off(ground_, holes_[h], cages_.laid_out(h), cages_.inside(h), options_, report);
    report.cage_in_rows = in_rows_;
    if (in_rows_)
      report.method_reason = Message{Code::rows_continue};
    else if (placed_ && !likelier_)
      report.method_reason = Message{of_many_ ? Code::large_cage_on_surface : Code::fair_cage_leaves};
    else if (cages_.laid_out(h).layout.grown)
      report.method_reason = Message{Code::quads_continue};
    else if (holes_[h].guessed)
      report.method_reason = Message{Code::cage_of_guessed_corners};
  }
}

bool may_fold_by_splitting(const FillContext& context, const SidedRim& hole) {
  const Points vertices = context.mesh.vertices(hole.rim, Eigen::all);
  const Index n = vertices.rows();
  if (n == 3) return true;
  for (Index k = 0; k < n; ++k) {
    const double edge =
        std::min((vertices.row(k) - vertices.row((k + 1) % n)).norm(), (vertices.row(k) - vertices.row((k + n - 1) % n)).norm());
    for (const Connectivity::Corner c : context.left.at(hole.rim[k]))
      for (Index v : context.mesh.faces[context.left.face(c)])
        if ((context.mesh.vertices.row(v) - vertices.row(k)).norm() > strip * edge) return true;
  }
  return false;
}

namespace {

/// A vertex on an edge of an odd rim leaves the face next to it an n-gon, whose limit goes no way along a strip as that of its neighbors
/// does: next to long strips the rim's limit is a zigzag there. A triangle in the middle leaves the rim as it is.
TriedOnes with_triangle_if_that_folds_less(const FillContext& context, TriedOnes tried, SeenWays* seen) {
  const std::vector<SidedRim>& holes = tried->holes();
  if (tried->options().odd != Odd::split || holes[0].rim.size() % 2 == 0) return tried;
  const Harm before = tried->harm_and_folds();
  if (before == Harm(false, 0) || !may_fold_by_splitting(context, holes[0])) return tried;
  FillOptions triangle = tried->options();
  triangle.odd = Odd::triangle;
  TriedOnes other = try_cages(context, holes, triangle, seen);
  const bool is_better = other->harm_and_folds() < before;
  if (is_better) other->warn({before.first ? Code::split_edge_would_cross : Code::split_edge_would_fold});
  return chosen(std::move(tried), std::move(other), is_better);
}

/// Rows that a tolerance has asked for may turn quads over where there is no room for them.
TriedOnes without_rows_if_that_folds_less(const FillContext& context, TriedOnes tried, FillOptions options, SeenWays* seen) {
  if (options.resolution || tried->rows() == 0 || tried->is_harmless()) return tried;
  options.resolution = 0;
  TriedOnes other = try_cages(context, tried->holes(), options, seen);
  const bool is_better = other->harm() < tried->harm();
  if (is_better) other->warn({Code::rows_would_cross});
  return chosen(std::move(tried), std::move(other), is_better);
}

}  // namespace

TriedOnes try_cages(const FillContext& context, const std::vector<SidedRim>& holes, const FillOptions& options, SeenWays* seen,
                    OnMeshWhere on_mesh) {
  TriedOnes tried = std::make_unique<TriedCages>(context, holes, options, on_mesh, seen);
  if (holes.size() != 1 || on_mesh == OnMeshWhere::everywhere || on_mesh == OnMeshWhere::untangled) return tried;
  const bool placed = tried->is_placed(), has_other_place = tried->has_other_place(), of_many = tried->is_one_of_many();
  if (on_mesh != OnMeshWhere::nowhere) tried = with_triangle_if_that_folds_less(context, std::move(tried), seen);
  tried = without_rows_if_that_folds_less(context, std::move(tried), options, seen);
  if (on_mesh == OnMeshWhere::nowhere || (!placed && !has_other_place) || tried->is_harmless()) return tried;
  // its vertices elsewhere, where the mesh around would continue or as the fairest one's
  const bool too_many = of_many && tried->faces().vertices.rows() > max_fair;
  const OnMeshWhere elsewhere = too_many ? OnMeshWhere::untangled : placed ? OnMeshWhere::nowhere : OnMeshWhere::everywhere;
  TriedOnes other = try_cages(context, holes, options, seen, elsewhere);
  const bool is_better = other->harm() < tried->harm();
  return chosen(std::move(tried), std::move(other), is_better);
}

}  // namespace tripatch
