#include "tripatch/fill/cage_fills.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "tripatch/cage/cage_fill.h"
#include "tripatch/fill/cage_in_rows.h"
#include "tripatch/fill/cage_on_mesh.h"
#include "tripatch/fill/polygon_fill.h"
#include "tripatch/fill/rows_fill.h"
#include "tripatch/fill/triangle_fill.h"
#include "tripatch/hole/clear_corners.h"
#include "tripatch/hole/rim_checks.h"
#include "tripatch/math/angle.h"
#include "tripatch/math/parallel.h"
#include "tripatch/math/stopwatch.h"
#include "tripatch/output/doubled_edges.h"
#include "tripatch/patch_from_sides.h"

namespace tripatch {

namespace {

/// Edges of a rim at a vertex, the shorter of both, that a face there is as long as, from which on it is a strip: twice the diagonal of two squares.
constexpr double strip = 4;

/// Of the hole's diameter: a fair cage that is farther off from where the mesh around would go on has run off, as between strips of bevels
/// or on a wave, and so much farther wherever it is. Of 566 holes in Blender's primitives, remeshes and bevels 28 are placed for it that are not
/// at 0.13, and 21 of their limit surfaces are nearer to the one that was there, by a factor of three in the mean; of coarse balls, eggs
/// and tori six of 116, all nearer. Of 639 cages in boxes, prisms and cylinders bevelled by Blender it was 68 at 0.13.
constexpr double run_off = 0.04;
/// The same between four guessed corners: quads there are as large as four corners make them, and one of them that is larger than those around has
/// its limit farther inside. A ball of eight edges around is flattened at 0.04.
constexpr double run_off_of_guess = 0.13;
constexpr double far_off = 0.25;
/// Of the hole's diameter, of where the mesh would go on: what is known better is met by the fairest cage, whose limit is fitted, two to five
/// times as nearly on balls. Else the limit is 0.53 times as far from the one that was there where the mesh goes on, in the geometric mean of 23
/// holes in Blender's heads, skins, remeshes and subdivided boxes whose quads go on, at most 2.3 times.
constexpr double well_known = 3e-4;
/// Standard deviations of where the mesh would go on: a fair cage within as many is as likely. Suzanne's jaw is at 2.9, its fair cage four
/// times nearer to the surface that was there than the other; 27 of the bevels' cages stay as they were, an eighth of the gain.
constexpr double likely = 3.5;
/// Vertices of a cage from which on it is not made fair first, which takes a second of 600 and a minute and a half of 4,400. Of 340 holes
/// in Blender's primitives, remeshes and bevels the five largest, of 100 and more faces, are two thirds as far from the limit that was
/// there; with 10 to 100 faces it is 1.1 to 1.2 times as far. Over grids on balls and waves 150 to 4,400 are 0.2 to 1 times as far.
constexpr Index many = 150;
/// If it folds or crosses itself there, it is made fair after all up to so many vertices, which takes three seconds.
constexpr Index most_fair = 1000;
constexpr const char* grown_reason = "the quads go on from those around the hole";
constexpr const char* placed_reason =
    "the fairest cage would run off: its vertices lie where the faces around the hole would go on";
constexpr const char* guessed_reason = "the rim has no clear corners: the cage lies between four of its vertices";
constexpr const char* many_reason = "so many vertices lie where the faces around the hole would go on";

/// Whether the patch's own shape is asked for.
bool is_shaped(const FillOptions& options) {
  return options.tension > 0 || options.center || options.center_offset != 0 || !options.through.empty() ||
         !options.bulge.are_all(1) ||
         std::find(options.continuity.begin(), options.continuity.end(), SideContinuity::free) != options.continuity.end();
}

/// Which cages have their vertices where the mesh around would go on.
enum class OnMeshWhere { nowhere, likelier, run_off, everywhere, untangled };

std::vector<Fill> cages_together(const Ground& ground, const std::vector<SidedRim>& holes, const FillOptions& options,
                                 OnMeshWhere on_mesh = OnMeshWhere::run_off);

/// Puts the vertices of a cage where rows of quads go on, if they do; whether they do.
bool place_in_rows(const Ground& ground, const SidedRim& hole, const FillOptions& options, CageFill& cage) {
  if (hole.given || options.cage_rim != CageRim::smooth || options.subdivision.loop || options.resolution.value_or(0) > 0)
    return false;
  const std::optional<Points> points = cage_in_rows(ground, cage.laid_out(0));
  if (points) cage.place(*points);
  return points.has_value();
}

/// Puts the vertices of a cage, if it is one of those, where the mesh around would go on; whether it was.
bool place_on_mesh(const Ground& ground, const SidedRim& hole, const FillOptions& options, OnMeshWhere where, CageFill& cage) {
  if (where == OnMeshWhere::nowhere) return false;
  if (options.cage_rim != CageRim::smooth || options.subdivision.loop || options.resolution.value_or(0) > 0) return false;
  const Points inside = cage.inside(0);
  if (inside.rows() == 0) return false;
  const Smoothed smoothed = where == OnMeshWhere::untangled  ? Smoothed::in_plane
                            : where == OnMeshWhere::likelier ? Smoothed::on_surface
                                                             : Smoothed::no;
  const std::optional<OnMesh> on_mesh = cage_on_mesh(ground, hole, cage.laid_out(0), options, smoothed);
  if (!on_mesh) return false;
  const double size = diameter(ground.mesh, hole.rim);
  if (where == OnMeshWhere::likelier && !(on_mesh->deviation > well_known * size)) return false;
  const Eigen::VectorXd across = (inside - on_mesh->points).cwiseProduct(on_mesh->normals).rowwise().sum();
  const bool goes_on = !hole.guessed || cage.laid_out(0).layout.grown;
  const double least =
      std::max((goes_on ? run_off : run_off_of_guess) * size, std::min(likely * on_mesh->deviation, far_off * size));
  if (where == OnMeshWhere::run_off && !(across.cwiseAbs().maxCoeff() > least)) return false;
  cage.place(on_mesh->points);
  return true;
}

/// A vertex on an edge of an odd rim leaves the face beside it an n-gon, whose limit goes no way along a strip as that of its neighbors
/// does: beside long strips the rim's limit is a zigzag there. A triangle in the middle leaves the rim as it is.
std::vector<Fill> with_triangle_if_that_folds_less(const Ground& ground, const std::vector<SidedRim>& holes,
                                                   const FillOptions& options, std::vector<Fill> fills) {
  const auto harm_and_folds = [](const Report& r) { return std::pair(r.crosses_itself, r.folds + r.triangles_folded); };
  const auto before = harm_and_folds(fills[0].report);
  if (holes.size() != 1 || options.odd != Odd::split || holes[0].rim.size() % 2 == 0 || before == std::pair(false, Index{0}) ||
      !may_fold_by_splitting(ground, holes[0]))
    return fills;
  FillOptions triangle = options;
  triangle.odd = Odd::triangle;
  std::vector<Fill> others = cages_together(ground, holes, triangle);
  if (harm_and_folds(others[0].report) >= before) return fills;
  others[0].report.warnings.push_back("The rim is odd, and with an edge of it split the fill would " +
                                      std::string(before.first ? "cross itself" : "fold") + ": it has a triangle instead");
  return others;
}

/// Corners that nobody gave are a person's to choose, and no reason for a cage that crosses itself; guessed ones for none that folds either.
void refuse_if_harmful(const SidedRim& hole, const Report& report) {
  const bool folds = report.folds > 0 || report.triangles_folded > 0;
  if (hole.given || !(report.crosses_itself || (hole.guessed && folds))) return;
  const std::string seen = "A cage between the " + std::to_string(hole.sides()) + " corners that the rim shows",
                    none = "Rim has no clear corners, and a cage without them";
  throw Refusal((hole.guessed ? none : seen) + " would " + (report.crosses_itself ? "cross itself" : "fold") + "; select " +
                    (hole.guessed ? "two to twelve corners" : "others"),
                at_places(hole.rim, hole.corners));
}

/// Rows that a tolerance has asked for may turn quads over where there is no room for them.
std::vector<Fill> without_rows_if_that_folds_less(const Ground& ground, const std::vector<SidedRim>& holes,
                                                  const FillOptions& options, std::vector<Fill> fills) {
  const Report& report = fills[0].report;
  if (holes.size() != 1 || options.resolution || report.rows == 0 || is_harmless(report)) return fills;
  FillOptions plain = options;
  plain.resolution = 0;
  std::vector<Fill> others = cages_together(ground, holes, plain);
  if (harm(others[0].report) >= harm(report)) return fills;
  others[0].report.warnings.emplace_back(crossing_rows);
  return others;
}

/// A cage whose vertices lie elsewhere, where the mesh around would go on or as the fairest one's.
std::vector<Fill> the_other_if_that_folds_less(const Ground& ground, const std::vector<SidedRim>& holes,
                                               const FillOptions& options, OnMeshWhere other, std::vector<Fill> fills) {
  if (holes.size() != 1 || is_harmless(fills[0].report)) return fills;
  std::vector<Fill> others = cages_together(ground, holes, options, other);
  return harm(others[0].report) < harm(fills[0].report) ? others : fills;
}

/// How much less two choices of corners may turn for the one that begins first to be taken: far more than rounding, radians.
constexpr double as_much_turn = 1e-6;
/// That of a vertex that is not to be a corner: less than of any four others.
constexpr double no_turn = -4 * std::numbers::pi;

/// Four vertices of a rim that shows no corners, as Grid Fill takes them: as many edges between opposite ones, or one more, where the rim
/// turns most at them; as few as possible have one face only, about which the limit of the open cage has no tangent plane. None of fewer than
/// four edges.
std::vector<Index> four_of(const Ground& ground, std::vector<Index> loop) {
  const std::size_t n = loop.size();
  if (n < 4) return {};
  std::rotate(loop.begin(), std::min_element(loop.begin(), loop.end()), loop.end());
  const auto at = [&](std::size_t k) -> Vec3 { return ground.mesh.vertices.row(loop[k % n]); };
  std::vector<double> turn(n);
  for (std::size_t k = 0; k < n; ++k)
    turn[k] = ground.left.at(loop[k]).size() < 2 ? no_turn : angle_between(at(k) - at(k + n - 1), at(k + 1) - at(k));
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

std::optional<SidedRim> guessed_rim(const Ground& ground, const std::vector<Index>& loop) {
  const std::vector<Index> guess = four_of(ground, loop);
  if (guess.empty()) return {};
  CorneredRim found = cornered(ground, loop, guess);
  SidedRim result;
  result.rim = std::move(found.rim);
  result.corners = std::move(found.places);
  result.guessed = true;
  return result;
}

std::vector<Fill> cages_together(const Ground& ground, const std::vector<SidedRim>& holes, const FillOptions& options,
                                 OnMeshWhere on_mesh) {
  CageOptions cage_options;
  cage_options.rim = options.cage_rim;
  CageFill cages(ground.mesh, ground.left, holes, options.subdivision, options.replaced, layout_options(options), cage_options);

  // The border of an open cage, to which an exact rim holds, is flat across and round at corners: a patch that is made fair bends
  // sharply behind it, and no cage follows. Elsewhere curvature shall vary least: in the cage, whose patch follows it, or where
  // the patch's own shape is asked for, in the patch.
  const bool exact = options.cage_rim == CageRim::exact, automatic = options.fairing == Fairing::automatic;
  const bool fair = automatic && !is_shaped(options), follows = fair && !exact;
  const bool alone = follows && holes.size() == 1,
             of_many = alone && cages.inside(0).rows() > many && on_mesh != OnMeshWhere::nowhere;
  const bool untangled = on_mesh == OnMeshWhere::untangled;
  const bool in_rows = alone && on_mesh == OnMeshWhere::run_off && place_in_rows(ground, holes[0], options, cages);
  bool placed =
      in_rows || (of_many && place_on_mesh(ground, holes[0], options, untangled ? on_mesh : OnMeshWhere::everywhere, cages));
  const bool first_placed = placed && !in_rows;
  const bool likelier = !placed && alone && on_mesh == OnMeshWhere::run_off && cages.laid_out(0).layout.grown &&
                        place_on_mesh(ground, holes[0], options, OnMeshWhere::likelier, cages);
  placed |= likelier;
  if (!placed) {
    cages.make_fair();
    placed = alone && place_on_mesh(ground, holes[0], options, on_mesh, cages);
  }
  FillOptions wanted = options;
  if (automatic && exact && options.tension == 0) wanted.fairing.reset();
  std::vector<Fill> fills(holes.size());
  std::vector<SurfacePtr> patches;
  for (std::size_t h = 0; h < holes.size(); ++h) {
    check_interruption();
    // between other than three sides the patch is that of a smooth rim in any case
    if (holes[h].is_triangle() && !options.through.empty())
      throw Refusal("A cage of three sides meets no points inside", holes[h].rim);
    MadePatch made = holes[h].is_triangle()
                         ? patch_from_sides(three_sides(cages.sides(h)), wanted, follows ? &cages.points(h) : nullptr)
                         : patch_over_polygon(cages.sides(h), cages.domain(h), options, fair ? &cages.points(h) : nullptr);
    fills[h].patch = made.patch;
    fills[h].report = std::move(made.report);
    patches.push_back(std::move(made.patch));
  }

  // The rim's limit may run along its edges at very different rates, beside strips that are long beside them: a patch that folds in
  // following the fairest cage there is worth nothing, and the cage is kept.
  std::vector<bool> kept;
  for (std::size_t h = 0; h < holes.size(); ++h)
    kept.push_back(placed || (fair && (!holes[h].is_triangle() || (follows && fills[h].report.folds > 0))));
  cages.fit(std::move(patches), kept);
  for (std::size_t h = 0; h < holes.size(); ++h) {
    cages.complete(h, fills[h]);
    if (follows) cages.report_energies(h, fills[h].report);
    if (kept[h]) fills[h].report.folds = 0;  // of a patch that the cage is not fitted to
    complete_report(holes[h], options, {}, fills[h].report);
    std::string& reason = fills[h].report.method_reason;
    if (in_rows)
      reason = rows_reason;
    else if (placed && !likelier)
      reason = first_placed ? many_reason : placed_reason;
    else if (cages.laid_out(h).layout.grown)
      reason = grown_reason;
    else if (holes[h].guessed)
      reason = guessed_reason;
  }
  if (on_mesh == OnMeshWhere::everywhere || untangled) return fills;
  fills = with_triangle_if_that_folds_less(ground, holes, options, std::move(fills));
  fills = without_rows_if_that_folds_less(ground, holes, options, std::move(fills));
  if (on_mesh == OnMeshWhere::nowhere) return fills;
  const bool too_many = first_placed && fills[0].vertices.rows() > most_fair;
  const OnMeshWhere other = too_many ? OnMeshWhere::untangled : placed ? OnMeshWhere::nowhere : OnMeshWhere::everywhere;
  return the_other_if_that_folds_less(ground, holes, options, other, std::move(fills));
}

}  // namespace

bool may_fold_by_splitting(const Ground& ground, const SidedRim& hole) {
  const Points vertices = ground.mesh.vertices(hole.rim, Eigen::all);
  const Index n = vertices.rows();
  if (n == 3) return true;
  for (Index k = 0; k < n; ++k) {
    const double edge =
        std::min((vertices.row(k) - vertices.row((k + 1) % n)).norm(), (vertices.row(k) - vertices.row((k + n - 1) % n)).norm());
    for (const Connectivity::Corner c : ground.left.at(hole.rim[k]))
      for (Index v : ground.mesh.faces[ground.left.face(c)])
        if ((ground.mesh.vertices.row(v) - vertices.row(k)).norm() > strip * edge) return true;
  }
  return false;
}

std::vector<Fill> fill_with_cages(const Ground& ground, const std::vector<SidedRim>& holes, const FillOptions& options) {
  std::vector<Fill> fills = cages_together(ground, holes, options);
  for (std::size_t h = 0; h < holes.size(); ++h) {
    const SidedRim& hole = holes[h];
    const Report& report = fills[h].report;
    refuse_infinite(fills[h], hole.rim);
    if (doubles_edges_of_mesh(ground.left, hole.rim, fills[h].faces))
      throw Refusal(
          "A cage would join two vertices of the rim by an edge that the mesh has already; choose other corners, or triangles",
          at_places(hole.rim, hole.corners));
    if (holes.size() == 1 && !hole.given && !is_harmless(report)) {
      std::optional<SidedRim> guess = hole.guessed ? hole : guessed_rim(ground, hole.rim);
      for (const bool by_angle : {false, true}) {
        if (!guess || (hole.guessed && !by_angle)) continue;
        guess->by_angle = by_angle;
        std::vector<Fill> others = cages_together(ground, {*guess}, options);
        if (is_harmless(others[0].report) && is_finite(others[0])) return others;
      }
    }
    refuse_if_harmful(hole, report);
  }
  return fills;
}

namespace {

/// A group of cages, or where one of them stands in the way of the others each by itself.
std::vector<std::variant<Fill, Refused>> fill_group(const Ground& ground, const std::vector<SidedRim>& group,
                                                    const FillOptions& options) {
  const Stopwatch watch;
  std::vector<std::variant<Fill, Refused>> results;
  try {
    for (Fill& fill : fill_with_cages(ground, group, options)) {
      fill.report.seconds = watch.seconds() / static_cast<double>(group.size());
      results.emplace_back(std::move(fill));
    }
  } catch (const Refusal& refusal) {
    if (group.size() == 1) return {refused(refusal)};
    for (const SidedRim& hole : group) results.push_back(std::move(fill_group(ground, {hole}, options)[0]));
  }
  return results;
}

}  // namespace

void fill_all_with_cages(const Ground& ground, const std::vector<std::optional<SidedRim>>& given, const FillOptions& options,
                         std::vector<std::variant<Fill, Refused>>& results, const Progress& progress) {
  std::vector<SidedRim> holes;
  std::vector<std::size_t> place;  // of each hole in the results
  for (std::size_t k = 0; k < given.size(); ++k) {
    if (!given[k]) continue;
    holes.push_back(*given[k]);
    place.push_back(k);
  }
  const std::vector<std::vector<std::size_t>> groups = cage_groups(ground.left, holes);
  std::atomic<std::size_t> done = given.size() - holes.size();
  const auto fill_one_group = [&](std::size_t g) {
    std::vector<SidedRim> together;
    for (std::size_t h : groups[g]) together.push_back(holes[h]);
    std::vector<std::variant<Fill, Refused>> made = fill_group(ground, together, options);
    for (std::size_t k = 0; k < made.size(); ++k) results[place[groups[g][k]]] = std::move(made[k]);
    done += made.size();
  };
  parallel_for_each(groups.size(), fill_one_group, [&](std::size_t) {
    if (progress) progress(done);
  });
}

namespace {

/// Corners that are given or seen, else guessed ones.
SidedRim cornered_rim_of(const Ground& ground, const std::optional<std::vector<Index>>& rim, const Corners& corners) {
  if (corners && !corners->empty()) {
    if (!makes_polygon(*corners)) return hole_of(ground, rim, corners);
    CorneredRim found = cornered(ground, rim ? *rim : loop_through(ground, *corners), *corners);
    SidedRim result;
    result.rim = std::move(found.rim);
    result.corners = std::move(found.places);
    return result;
  }
  Refusal none("A cage needs corners: two to twelve", {});
  if (!corners) {
    try {
      return hole_of(ground, rim, corners);
    } catch (const Refusal& refusal) {
      none = refusal;
    }
  }
  const std::vector<Index> loop = check_topology(ground.left, rim ? *rim : only_hole(ground));
  check_finite(ground.mesh, ground.left, loop);
  if (!corners) {
    std::vector<Index> places = corners_by_valence(ground.mesh, ground.left, loop);
    if (places.empty()) places = corners_between_sides(ground.mesh, ground.left, loop);
    const std::vector<Index> seen = at_places(loop, places);
    if (makes_polygon(seen)) return cornered_rim_of(ground, loop, seen);
  }
  const std::optional<SidedRim> guess = guessed_rim(ground, loop);
  if (!guess) throw none;
  return *guess;
}

}  // namespace

SidedRim cage_rim_of(const Ground& ground, const std::optional<std::vector<Index>>& rim, const Corners& corners) {
  SidedRim found = cornered_rim_of(ground, rim, corners);
  found.given = corners && !corners->empty();
  if (found.given || found.guessed || !grows_on(found, ground.mesh.vertices, ground.left)) return found;
  const std::vector<Index> by_valence = at_places(found.rim, corners_by_valence(ground.mesh, ground.left, found.rim));
  if (!by_valence.empty()) return cornered_rim_of(ground, found.rim, by_valence);
  return guessed_rim(ground, found.rim).value_or(found);
}

}  // namespace tripatch
