#include "tripatch/cage_fills/cage_fills.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <utility>

#include "tripatch/cage/cage_fill.h"
#include "tripatch/cage_fills/cage_inside.h"
#include "tripatch/fill/insisted.h"
#include "tripatch/fill/polygon_fill.h"
#include "tripatch/fill/rows_fill.h"
#include "tripatch/fill/triangle_fill.h"
#include "tripatch/hole/clear_corners.h"
#include "tripatch/hole/rim_checks.h"
#include "tripatch/math/angle.h"
#include "tripatch/math/parallel.h"
#include "tripatch/math/stopwatch.h"
#include "tripatch/messages.h"
#include "tripatch/output/doubled_edges.h"
#include "tripatch/output/quad_cover.h"
#include "tripatch/output/shaped.h"
#include "tripatch/patch_from_sides.h"

namespace tripatch {

namespace {

/// Edges of a rim at a vertex, the shorter of both, that a face there is as long as, from which on it is a strip: twice the diagonal of two squares.
constexpr double strip = 4;

/// Of the hole's diameter: a fair cage that is farther off from where the mesh around would continue has run off, as between strips of bevels
/// or on a wave, and so much farther wherever it is. Of 566 holes in Blender's primitives, remeshes and bevels 28 are placed for it that are not
/// at 0.13, and 21 of their limit surfaces are nearer to the one that was there, by a factor of three in the mean. Of coarse balls, eggs
/// and tori six of 116, all nearer. Of 639 cages in boxes, prisms and cylinders bevelled by Blender it was 68 at 0.13.
constexpr double run_off = 0.04;
/// The same between four guessed corners: quads there are as large as four corners make them, and one of them that is larger than those around has
/// its limit farther inside. A ball of eight edges around is flattened at 0.04.
constexpr double run_off_of_guess = 0.13;
constexpr double far_off = 0.25;
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
constexpr Index max_fair = 1000;
constexpr const char* grown_reason = "the quads around the hole continue";
constexpr const char* placed_reason = "the fairest cage would leave the surrounding surface, so its vertices lie on that surface";
constexpr const char* guessed_reason = "the hole has no clear corners, so the cage lies between four of its vertices";
constexpr const char* many_reason = "a cage of so many vertices lies on the surrounding surface";

/// Whether the patch's own shape is asked for.
bool has_own_shape(const FillOptions& options) {
  return is_shaped(options) || !options.through.empty() || std::ranges::any_of(options.continuity, [](SideContinuity c) {
           return c == SideContinuity::free || c == SideContinuity::g0;
         });
}

/// Whether a method between three sides is asked for by its name: then the cage is that one's or none.
bool is_named(const FillOptions& options) { return options.method != automatic_method && options.method != polygon_method; }

/// Which cages have their vertices where the mesh around would continue.
enum class OnMeshWhere { nowhere, likelier, run_off, everywhere, untangled };

/// Puts the vertices of a cage where rows of quads continue, if they do; whether they do.
bool place_in_rows(const FillContext& context, const SidedRim& hole, const FillOptions& options, CageFill& cage) {
  if (hole.given || options.cage_rim != CageRim::smooth || options.subdivision.loop || options.resolution.value_or(0) > 0)
    return false;
  const std::optional<Points> points = cage_in_rows(context, cage.laid_out(0), options.replaced);
  if (points) cage.place(*points);
  return points.has_value();
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

/// Whether a cage was put there, stays where it is, or there is nowhere to put it.
enum class Placing { placed, stays, nowhere };

/// Puts the vertices of a cage, if it is one of those, where the mesh around would continue.
Placing place_on_mesh(const FillContext& context, const SidedRim& hole, const FillOptions& options, OnMeshWhere where,
                      CageFill& cage) {
  if (where == OnMeshWhere::nowhere) return Placing::stays;
  if (options.cage_rim != CageRim::smooth || options.subdivision.loop || options.resolution.value_or(0) > 0)
    return Placing::nowhere;
  const Points inside = cage.inside(0);
  if (inside.rows() == 0) return Placing::nowhere;
  const Smoothed smoothed = where == OnMeshWhere::untangled  ? Smoothed::in_plane
                            : where == OnMeshWhere::likelier ? Smoothed::on_surface
                                                             : Smoothed::no;
  const std::optional<OnMesh> on_mesh = cage_on_mesh(context, hole, cage.laid_out(0), options, smoothed);
  if (!on_mesh) return Placing::nowhere;
  const double size = diameter(context.mesh, hole.rim);
  if (where == OnMeshWhere::likelier && !(on_mesh->deviation > well_known * size)) return Placing::stays;
  const bool goes_on = !hole.guessed || cage.laid_out(0).layout.grown;
  if (where == OnMeshWhere::run_off && !runs_off(inside, *on_mesh, size, goes_on ? run_off : run_off_of_guess))
    return Placing::stays;
  cage.place(on_mesh->points);
  return Placing::placed;
}

/// Ways that were tried where one without harm is wanted: the same again would do the same.
class SeenWays {
public:
  /// Whether it is new.
  bool add(const SidedRim& hole, const FillOptions& options, OnMeshWhere where, const QuadLayout& layout) {
    const auto is_same = [&](const Way& other) {
      return other.hole.rim == hole.rim && other.hole.corners == hole.corners && other.odd == options.odd &&
             other.resolution == options.resolution && other.where == where &&
             other.layout.faces.corners == layout.faces.corners && other.layout.faces.offsets == layout.faces.offsets &&
             other.layout.barycentric == layout.barycentric;
    };
    if (std::ranges::any_of(ways_, is_same)) return false;
    ways_.push_back({hole, options.odd, options.resolution, where, layout});
    return true;
  }

private:
  struct Way {
    SidedRim hole;
    Odd odd;
    std::optional<int> resolution;
    OnMeshWhere where;
    QuadLayout layout;
  };
  std::vector<Way> ways_;
};

/// That a cage crosses itself, then its folds: as of a report.
using Harm = std::pair<bool, Index>;
constexpr Harm max_harm = {true, std::numeric_limits<Index>::max()};

/// Cages in some holes, in one of several ways. Where a cage is alone and hangs on no patch, its patch, which takes longer than the cage, is
/// made when the fill is asked for: most of those that are tried are not taken.
class TriedCages {
public:
  /// seen: where one without harm is wanted.
  TriedCages(const FillContext& context, std::vector<SidedRim> holes, FillOptions options, OnMeshWhere on_mesh, SeenWays* seen)
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
  TriedCages(const TriedCages&) = delete;
  TriedCages& operator=(const TriedCages&) = delete;

  bool is_placed() const { return placed_; }
  /// Whether, and that in a hole of many vertices, it was placed before it was made fair.
  bool is_one_of_many() const { return of_many_; }
  /// Whether there is another place for its vertices.
  bool has_other_place() const { return has_other_place_; }
  const std::vector<SidedRim>& holes() const { return holes_; }
  const FillOptions& options() const { return options_; }

  /// Of the first hole. Where none is wanted what folds is not asked whether it crosses itself too.
  Harm harm() {
    if (was_seen_) return max_harm;
    if (!waits_) return tripatch::harm(fills_[0].report);
    if (no_harm_wanted_) {
      if (!folded_) folded_ = cages_.triangles_folded(0);
      if (*folded_ > 0) return {false, *folded_};
    }
    return {cages_.harm(0).crossing.has_value(), cages_.harm(0).triangles_folded};
  }
  bool is_harmless() { return harm() == Harm(false, 0); }
  bool crosses_itself() { return waits_ ? cages_.harm(0).crossing.has_value() : fills_[0].report.crosses_itself; }
  /// With the folds of a patch that it is fitted to.
  Harm harm_and_folds() {
    const auto [crosses, folded] = harm();
    return {crosses, folded + (waits_ || was_seen_ ? 0 : fills_[0].report.folds)};
  }
  int rows() const { return waits_ || was_seen_ ? 0 : fills_[0].report.rows; }

  /// To be said of the first fill.
  void warn(Message warning) { warnings_.push_back(std::move(warning)); }

  /// Rim, vertices, faces and what changes around them, of the first hole.
  Fill faces() const {
    Fill fill;
    cages_.deliver(0, fill);
    return fill;
  }
  std::vector<Fill> fills() {
    if (waits_) complete();
    Messages& said = fills_[0].report.warnings;
    said.insert(said.end(), warnings_.begin(), warnings_.end());
    return std::move(fills_);
  }

private:
  static CageOptions cage_options(const FillOptions& options) {
    CageOptions own;
    own.rim = options.cage_rim;
    return own;
  }

  /// Where the mesh around would continue, if they are to be there, else as the fairest ones.
  void put(OnMeshWhere on_mesh) {
    const bool alone = follows_ && holes_.size() == 1 && !named_, by_itself = alone && on_mesh == OnMeshWhere::run_off;
    const auto place = [&](OnMeshWhere where) {
      const Placing found = place_on_mesh(ground_, holes_[0], options_, where, cages_);
      has_other_place_ = found != Placing::nowhere;
      return placed_ = found == Placing::placed;
    };
    const bool of_many = alone && cages_.inside(0).rows() > many && on_mesh != OnMeshWhere::nowhere,
               anyway = alone && (on_mesh == OnMeshWhere::everywhere || on_mesh == OnMeshWhere::untangled);
    in_rows_ = placed_ = by_itself && place_in_rows(ground_, holes_[0], options_, cages_);
    if (!placed_ && (of_many || anyway)) {
      of_many_ = place(on_mesh == OnMeshWhere::untangled ? on_mesh : OnMeshWhere::everywhere) && of_many;
      if (!placed_) return cages_.make_fair();
    }
    likelier_ = !placed_ && by_itself && cages_.laid_out(0).layout.grown && place(OnMeshWhere::likelier);
    if (placed_) return;
    cages_.make_fair();
    if (alone) place(on_mesh);
  }

  void make_patches() {
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

  void complete() {
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
      if (kept[h]) report.folds = 0;  // of a patch that the cage is not fitted to
      complete_report(holes_[h], options_, report);
      if (named_) {
        tell_distance(cages_.tolerance(h), report);
        tell_run_off(ground_, holes_[h], cages_.laid_out(h), cages_.inside(h), options_, report);
      }
      report.cage_in_rows = in_rows_;
      if (in_rows_)
        report.method_reason = rows_reason;
      else if (placed_ && !likelier_)
        report.method_reason = of_many_ ? many_reason : placed_reason;
      else if (cages_.laid_out(h).layout.grown)
        report.method_reason = grown_reason;
      else if (holes_[h].guessed)
        report.method_reason = guessed_reason;
    }
  }

  const FillContext& ground_;
  const std::vector<SidedRim> holes_;
  const FillOptions options_;
  const bool no_harm_wanted_, named_;
  CageFill cages_;
  std::vector<Fill> fills_;
  Messages warnings_;
  std::optional<Index> folded_;
  bool exact_ = false, fair_ = false, follows_ = false;
  bool in_rows_ = false, of_many_ = false, likelier_ = false, placed_ = false, has_other_place_ = false;
  bool waits_ = false;     ///< for its patch
  bool was_seen_ = false;  ///< and does harm
};

using TriedOnes = std::unique_ptr<TriedCages>;

TriedOnes try_cages(const FillContext& context, const std::vector<SidedRim>& holes, const FillOptions& options, SeenWays* seen,
                    OnMeshWhere on_mesh = OnMeshWhere::run_off);

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
  if (other->harm_and_folds() >= before) return tried;
  other->warn({before.first ? Code::split_edge_would_cross : Code::split_edge_would_fold});
  return other;
}

/// Rows that a tolerance has asked for may turn quads over where there is no room for them.
TriedOnes without_rows_if_that_folds_less(const FillContext& context, TriedOnes tried, FillOptions options, SeenWays* seen) {
  if (options.resolution || tried->rows() == 0 || tried->is_harmless()) return tried;
  options.resolution = 0;
  TriedOnes other = try_cages(context, tried->holes(), options, seen);
  if (other->harm() >= tried->harm()) return tried;
  other->warn({Code::rows_would_cross});
  return other;
}

/// Of a hole that is alone other ways are tried where one does harm.
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
  return other->harm() < tried->harm() ? std::move(other) : std::move(tried);
}

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

/// How much less two choices of corners may turn for the one that begins first to be taken: far more than rounding, radians.
constexpr double as_much_turn = 1e-6;
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
    if (sum > most + as_much_turn) most = sum, best = k;
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

/// A cage without harm between four guessed corners, or of quads that grow in from the rim.
std::optional<Fill> harmless_without_corners(const FillContext& context, const SidedRim& hole, const FillOptions& options,
                                             SeenWays& seen) {
  std::optional<SidedRim> guess = hole.guessed ? hole : guessed_rim(context, hole.rim);
  for (const bool by_angle : {false, true}) {
    if (!guess || (hole.guessed && !by_angle)) continue;
    guess->by_angle = by_angle;
    const TriedOnes other = try_cages(context, {*guess}, options, &seen);
    if (!other->is_harmless()) continue;
    Fill fill = std::move(other->fills()[0]);
    if (is_finite(fill)) return fill;
  }
  return {};
}

}  // namespace

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

/// With as many extra rows of quads as are asked for.
std::vector<Fill> with_these_rows(const FillContext& context, const std::vector<SidedRim>& holes, const FillOptions& options) {
  const SidedRim& first = holes[0];
  const bool alone = holes.size() == 1;
  SeenWays seen;
  const TriedOnes tried = try_cages(context, holes, options, alone && first.guessed ? &seen : nullptr);
  if (alone && !first.given && !tried->is_harmless()) {
    const Fill faces = tried->faces();
    refuse_infinite(faces, first.rim);
    refuse_if_doubled(context, first, faces);
    std::optional<Fill> other;
    if (!is_named(options)) other = harmless_without_corners(context, first, options, seen);
    if (other) return {std::move(*other)};
    refuse_if_harmful(first, tried->crosses_itself(), true);
  }
  std::vector<Fill> fills = tried->fills();
  for (std::size_t h = 0; h < holes.size(); ++h) {
    const Report& report = fills[h].report;
    refuse_infinite(fills[h], holes[h].rim);
    refuse_if_doubled(context, holes[h], fills[h]);
    refuse_if_harmful(holes[h], report.crosses_itself, report.folds > 0 || report.triangles_folded > 0);
  }
  return fills;
}

/// The same, or fewer where that does less harm.
std::vector<Fill> with_rows_or_fewer(const FillContext& context, const std::vector<SidedRim>& holes, const FillOptions& options) {
  const int wanted = options.resolution.value_or(0);
  if (wanted == 0 || holes.size() > 1) return with_these_rows(context, holes, options);
  FillOptions fewer = options;
  std::optional<Fill> best;
  int most = 0;
  for (int rows = wanted; !best || harm(best->report) != Harm(false, 0); rows /= 2) {
    fewer.resolution = rows;
    try {
      Fill fill = std::move(with_these_rows(context, holes, fewer)[0]);
      if (!best || harm(fill.report) < harm(best->report)) best = std::move(fill), most = rows;
    } catch (const Harmful&) {
      if (rows == 0 && !best) throw;
    }
    if (rows == 0) break;
  }
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
