#include "tripatch/fill/automatic_fill.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "tripatch/creases/features.h"
#include "tripatch/creases/flat_walls.h"
#include "tripatch/fill/any_rim_fill.h"
#include "tripatch/fill/polygon_fill.h"
#include "tripatch/fill/rows_fill.h"
#include "tripatch/fill/triangle_fill.h"
#include "tripatch/grid/continued_quads.h"
#include "tripatch/hole/clear_corners.h"
#include "tripatch/hole/rim_checks.h"
#include "tripatch/hole/rim_shape.h"
#include "tripatch/hole/sharp_sides.h"
#include "tripatch/math/angle.h"
#include "tripatch/math/parallel.h"
#include "tripatch/mesh/vertex_normals.h"

namespace tripatch {

namespace {

/// Degrees between the tangent planes of two sides at a corner that nobody has given, from which on the surroundings are no one surface
/// there: as far as twelve edges a side are from telling those of a smooth one (2 degrees), several times over.
constexpr double one_surface = 10;

/// Where a patch folds, a spline that misses the planes of its sides by so many degrees, known so many times better there, is made to keep
/// them: between fillets of boxes and a prism that meet at cusps it is 2 to 10 times nearer then; where it missed them by 1 degree, 4 times
/// farther.
constexpr double far_off_planes = 2, worth_their_planes = 4;
/// But where the planes are not known to so many degrees the mesh is rough, and the spline knows it.
constexpr double well_known_planes = 1.5;

/// Of the hole's diameter: a patch that is known no better by its energy tells nothing, and whether it folds is rounding. Of four sides less is
/// asked: of 63 corners between fillets of three radii 14 are known no better, up to 0.04 of the diameter off, three times as far as the spline;
/// of 400 holes in smooth surfaces, stretched up to 1000 times and not, three are filled otherwise, 280 and 5 times nearer and 1.3 times
/// farther. Between more sides a patch may bend as much and be right, as where three half pipes meet (0.72), which the spline's triangles
/// do with an edge of 80 degrees.
double knows_nothing(std::size_t sides) { return sides <= 4 ? 0.12 : 1; }

/// Whether a patch leaves the hole although nobody has pulled at it.
bool runs_away(const Ground& ground, const Fill& patch, const FillOptions& options) {
  return !is_shaped_by_hand(options) && leaves_hole(ground.mesh, patch.rim, patch.vertices);
}

/// The spline of a rim, which nearly every patch is compared with: made beside the patch where a core is free for it.
class SplineBeside {
public:
  SplineBeside(const Ground& ground, const std::vector<Index>& rim, const std::vector<Index>& corners, const FillOptions& options)
      : ground_(ground), rim_(rim), corners_(corners), options_(options) {
    if (may_share() && !is_shaped_by_hand(options))
      begun_ = std::make_unique<AsyncTask<Fill>>([this] { return made(std::string()); });
  }
  Fill operator()(const std::string& reason) {
    const std::unique_ptr<AsyncTask<Fill>> begun = std::move(begun_);
    if (!begun) return made(reason);
    Fill fill = begun->get();
    fill.report.method_reason = reason;
    return fill;
  }

private:
  Fill made(const std::string& reason) const { return fill_any_rim(ground_, rim_, corners_, options_, reason); }

  const Ground& ground_;
  const std::vector<Index>& rim_;
  const std::vector<Index>& corners_;
  const FillOptions& options_;
  std::unique_ptr<AsyncTask<Fill>> begun_;  // the last: it ends before what it reads
};

/// The exact patch between two sides or four and more where they are smooth, else the surface over a plane. given: the corners are a person's.
Fill fill_between_many(const Ground& ground, const std::vector<Index>& rim, const std::vector<Index>& corners, bool given,
                       FillOptions options) {
  options.cross_boundary = CrossBoundary::consistent;  // of three sides
  check_counts(options, corners.size());
  SplineBeside any_rim(ground, rim, corners, options);
  const std::string smooth = "the rim has " + std::to_string(corners.size()) + " smooth sides";
  CorneredRim found;
  std::string reason;
  std::optional<Fill> patch;
  try {
    found = cornered(ground, rim, corners);
    if (zigzag(ground.mesh, found.rim, found.places) > smooth_sides) return any_rim("the sides between the corners zigzag");
    PolygonFill made = fill_with_polygon(ground.mesh, ground.left, found.rim, found.places, options, false);
    made.fill.report.method_reason = smooth;
    const std::vector<std::string>& kept = made.fill.report.continuity;
    const bool beside_sharp = std::find(kept.begin(), kept.end(), "Free") != kept.end();
    if (!given && beside_sharp && corners.size() == 2 && !is_shaped_by_hand(options))
      return any_rim("two sides that are not continued tell less than the rim as a whole");
    if (!given && !beside_sharp && made.planes_apart_deg > one_surface)
      return any_rim("the tangent planes of the " + std::to_string(corners.size()) + " sides differ at the corners");
    const double size = diameter(ground.mesh, rim);
    const bool unknown =
        !given && !is_shaped_by_hand(options) && off_by_energy(made.fill, size) > knows_nothing(corners.size()) * size;
    if (!unknown && !made.crumpled && !runs_away(ground, made.fill, options)) {
      if (is_shaped_by_hand(options) || beside_sharp) return std::move(made.fill);
      Fill spline = any_rim("the surroundings as a whole tell of another surface than their " + std::to_string(corners.size()) +
                            " sides alone");
      return excluded_by(made.fill, spline, size) ? spline : std::move(made.fill);
    }
    reason = "a patch between " + std::to_string(corners.size()) +
             (unknown ? " corners would bend too much to tell of a surface" : " corners would fold, crumple or leave the hole");
    patch = std::move(made.fill);
  } catch (const Refusal& refusal) {
    reason = "no patch fits between " + std::to_string(corners.size()) + " sides: " + refusal.what();
  }
  Fill other = any_rim(reason);
  if (patch && !asks_for_sides(options) && keeps_better_planes(*patch, other)) {
    Fill planar = fill_with_planes_of(ground, *patch, options, reason);
    if (planar.patch && harm(planar.report) <= harm(other.report)) return planar;
  }
  if (!patch || is_harmless(other.report)) return other;
  if (patch->report.folds > 0) {  // its mesh too is needed now
    patch = fill_with_polygon(ground.mesh, ground.left, found.rim, found.places, options).fill;
    patch->report.method_reason = smooth;
  }
  return runs_away(ground, *patch, options) || harm(other.report) <= harm(patch->report) ? other : std::move(*patch);
}

const std::string round_of_revolution = "the rim is round, and what surrounds it of revolution";

/// Where a cap of revolution that goes on as its surroundings bend leaves the hole: one that is tangent to them only or, where that one does
/// too, a flat one.
std::optional<Fill> lower_cap(const Ground& ground, const std::vector<Index>& rim, FillOptions options) {
  if (!is_continuity_open(options)) return {};
  for (const SideContinuity less : {SideContinuity::g1, SideContinuity::free}) {
    options.continuity = less;
    PolygonFill made = fill_round(ground.mesh, ground.left, rim, options, false);
    if (!made.of_revolution || made.crumpled || leaves_hole(ground.mesh, rim, made.fill.vertices)) continue;
    made.fill.report.method_reason = round_of_revolution + "; as these bend it would leave the hole";
    if (less == SideContinuity::free) made.fill.report.warnings.push_back(flat_all_around);
    return std::move(made.fill);
  }
  return {};
}

/// The patch over a disc where the rim is smooth all around, else the surface over a plane. rim: as new faces take it.
Fill fill_round_rim(const Ground& ground, const std::vector<Index>& rim, FillOptions options, const std::string& otherwise) {
  options.cross_boundary = CrossBoundary::consistent;  // of three sides
  const auto any_rim = [&](const std::string& reason) {
    return fill_any_rim(ground, rim, std::vector<Index>(), options, reason);
  };
  if (!is_round(ground.mesh, ground.left, rim)) return any_rim(otherwise);
  check_counts(options, 1);
  try {
    check_positions(ground.mesh, ground.left, rim);
    PolygonFill made = fill_round(ground.mesh, ground.left, rim, options, false);
    made.fill.report.method_reason = made.of_revolution ? round_of_revolution : "the rim is round";
    if (made.of_revolution && runs_away(ground, made.fill, options))
      if (std::optional<Fill> lower = lower_cap(ground, rim, options)) return std::move(*lower);
    if (made.crumpled || runs_away(ground, made.fill, options))
      return any_rim("a patch over the round rim would fold, crumple or leave the hole");
    if (made.of_revolution || is_shaped_by_hand(options)) return std::move(made.fill);
    Fill spline = any_rim("the surroundings as a whole tell of another surface than the round rim alone");
    return excluded_by(made.fill, spline, diameter(ground.mesh, rim)) ? spline : std::move(made.fill);
  } catch (const Refusal& refusal) {
    return any_rim(std::string("no patch fits the round rim: ") + refusal.what());
  }
}

/// The same between three sides, whose patch takes more: in Suzanne, holes of 10 to 16 edges, the spline was the nearer one from here on,
/// 1.3 times in the geometric mean of nine, and neither was with less.
constexpr double no_surface = 45;
/// Of fewer edges no rim was looked at: they tell nothing of a surface but their planes.
constexpr std::size_t least_edges_apart = 9;

/// What a refusal says, as part of a sentence, without what to do about it, which a fill that was made does not ask for.
std::string without_advice(std::string said) {
  said = said.substr(0, said.find("; "));
  said[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(said[0])));
  return said;
}

/// Whether the hole has lost a flat wall, and no sides are found which by themselves continue none of those that are left.
bool lost_a_wall(const Ground& ground, const std::vector<Index>& rim, std::vector<Index> corners, const FillOptions& options) {
  if (is_shaped_by_hand(options) || !is_continuity_open(options)) return false;
  if (!walls_end_at_flat_rim(ground.mesh, ground.left, rim, diameter(ground.mesh, rim))) return false;
  if (corners.empty()) corners = at_places(rim, corners_between_sharp(ground.mesh, ground.left, rim));
  if (corners.size() < 2 || corners.size() > static_cast<std::size_t>(most_sides)) return true;
  const std::vector<double> angles = sharp_sides(ground.mesh, ground.left, rim, places_in(rim, corners));
  return !std::ranges::all_of(angles, [](double angle) { return angle > 0; });
}

/// Degrees between the tangent planes of three sides at their corners, the most.
double planes_apart_at_corners(const SideList& sides) {
  double most = 0;
  for (int k = 0; k < 3; ++k) most = std::max(most, degrees_between(sides[(k + 1) % 3].normal(1), sides[(k + 2) % 3].normal(0)));
  return most;
}

}  // namespace

bool keeps_better_planes(const Fill& patch, const Fill& spline) {
  return patch.report.surroundings_error < well_known_planes &&
         misses_known_planes(patch, spline, far_off_planes, worth_their_planes);
}

namespace {

/// Whether all that is asked for by hand is that the sides meet the mesh in position only.
bool asks_for_positions_only(FillOptions options) {
  const bool all = std::ranges::all_of(options.continuity,
                                       [](SideContinuity c) { return c == SideContinuity::free || c == SideContinuity::g0; });
  options.continuity = FillOptions().continuity;
  return all && !is_shaped_by_hand(options);
}

/// Without a look at rows of quads.
Fill fill_by_sides(const Ground& ground, const std::vector<Index>& rim, const Corners& corners, FillOptions options) {
  const auto any_rim = [&](const std::string& reason) { return fill_any_rim(ground, rim, corners, options, reason); };
  if (!options.islands.empty()) return any_rim("the hole has islands");
  std::vector<Index> checked = check_topology(ground.left, rim);
  if (corners && corners->empty())
    return fill_round_rim(ground, checked, options, "a round rim was asked for, and this one is not smooth");
  if (corners && lost_a_wall(ground, checked, *corners, options)) {
    options.continuity = SideContinuity::free;
    Fill fill = fill_by_sides(ground, rim, corners, options);
    fill.report.warnings.push_back(flat_all_around);
    return fill;
  }
  const bool inner = !options.through.empty();  // the patch of three sides meets none: one over a polygon is made
  if (corners && (makes_polygon(*corners) || (inner && corners->size() == 3)))
    return fill_between_many(ground, rim, *corners, true, options);
  if (corners && corners->size() != 3) return any_rim(std::to_string(corners->size()) + " corners are given");
  Hole hole;
  if (!corners)  // wherever the rim is begun, the same corners are found, in the same order
    std::rotate(checked.begin(), std::min_element(checked.begin(), checked.end()), checked.end());
  check_finite(ground.mesh, ground.left, checked);
  std::vector<Index> found;
  if (!corners) found = at_places(checked, corners_between_sides(ground.mesh, ground.left, checked));
  if (options.features) {
    const Features near = find_features(ground.mesh, ground.left, checked);
    const auto goes_on = [&](const Connectivity& around) { return find_features(ground.mesh, around, checked).found(); };
    if (near.found() && (!ground.is_part() || goes_on(Connectivity(ground.mesh, options.replaced))))
      return any_rim(near.walls && near.walls->first.size() == 1 ? "a flat wall goes on over the hole"
                     : near.walls                                ? "flat walls around the hole meet in it"
                                                                 : "a crease of the surroundings goes on across the hole");
    const auto is_known = [&](Index v) { return ground.left.knows(v); };
    // what is not there need not be sought again
    options.features = near.found() || !std::all_of(near.vertices.begin(), near.vertices.end(), is_known);
  }
  if (!corners && lost_a_wall(ground, checked, found, options)) return fill_flat(ground, checked, options);
  if (makes_polygon(found) || (inner && found.size() == 3)) return fill_between_many(ground, rim, found, false, options);
  try {
    hole = make_hole(ground.mesh, ground.left, rim, three(corners));
  } catch (const Refusal& refusal) {
    if (corners) throw;
    const std::string otherwise = "no smooth sides were found: " + without_advice(refusal.what());
    const std::vector<Index> sharp = at_places(checked, corners_between_sharp(ground.mesh, ground.left, checked));
    if (sharp.empty()) return fill_round_rim(ground, checked, options, otherwise);
    const bool sided = makes_polygon(sharp) && (!asks_for_sides(options) || asks_for_positions_only(options));
    return sided ? fill_between_many(ground, rim, sharp, false, options) : any_rim(otherwise);
  }
  check_counts(options, 3);
  if (zigzag(ground.mesh, hole.rim, hole.corners) > smooth_sides) return any_rim("the sides between the corners zigzag");
  std::string reason;
  std::optional<Fill> patch;
  bool apart = false, away = false;
  try {
    patch = fill_with_patch(ground, hole, options);
    const bool own_choice = !corners && hole.rim.size() >= least_edges_apart && !asks_for_sides(options);
    const double planes_apart = own_choice ? planes_apart_at_corners(patch->sides) : 0;
    const bool no_one_surface = planes_apart > one_surface && !any_sharp(sharp_sides_of(ground, hole));
    apart = no_one_surface && planes_apart > no_surface;
    const bool folds = patch->report.folds > 0 || folds_in_vain(ground.mesh, ground.left, *patch),
               crosses = patch->report.crosses_itself;
    away = runs_away(ground, *patch, options);
    if (!folds && !crosses && !apart && !away) {
      if (!no_one_surface || is_shaped_by_hand(options)) return std::move(*patch);
      Fill spline = any_rim("the surroundings as a whole tell of another surface than their three sides alone");
      return excluded_by(*patch, spline, diameter(ground.mesh, hole.rim)) ? spline : std::move(*patch);
    }
    reason = folds     ? "a patch between three corners would fold"
             : crosses ? "a patch between three corners would cross itself"
             : away    ? "a patch between three corners would leave the hole"
                       : "the tangent planes of the three sides differ at the corners";
  } catch (const Refusal& refusal) {
    reason = std::string("no patch fits between three sides: ") + refusal.what();
  }
  Fill other = any_rim(reason);
  const bool better = !patch || harm(other.report) < harm(patch->report) ||
                      (harm(other.report) == harm(patch->report) && (patch->report.folds > 0 || apart || away));
  return better ? other : std::move(*patch);
}

/// Rows of quads, where faces are asked for as they come, quads or in a mesh of quads, and such rows end at the hole.
std::optional<Fill> rows_across(const Ground& ground, const std::vector<Index>& rim, const Corners& corners,
                                const FillOptions& options) {
  const bool as_they_come = !corners && options.resolution.value_or(0) == 0;
  if (!as_they_come || !options.islands.empty() || !options.through.empty() || meets_position_only(options)) return {};
  try {
    const std::vector<Index> checked = check_topology(ground.left, rim);
    if (options.output == Output::triangles && !is_among_quads(ground.left, checked)) return {};
    return fill_with_rows(ground, checked, options.output, options.features);
  } catch (const Refusal&) {  // another way may be open
    return {};
  }
}

/// As its surroundings have it.
Fill fill_as_they_go_on(const Ground& ground, const std::vector<Index>& rim, const Corners& corners, const FillOptions& options) {
  std::optional<Fill> rows = rows_across(ground, rim, corners, options);
  if (!rows) return fill_by_sides(ground, rim, corners, options);
  rows->report.method_reason = rows_reason;
  const bool quads = options.output == Output::quads;
  if (quads && are_sure(ground.mesh, *rows)) return std::move(*rows);
  try {
    Fill other = fill_by_sides(ground, rim, corners, options);
    if (!quads && other.patch && other.deviation.size() == 0) return other;  // exact, and as fine as triangles can be
    if (other.deviation.size() > 0 || rows->vertices.rows() == 0)
      return rows_are_nearer(ground.mesh, *rows, other) ? std::move(*rows) : std::move(other);
    if (sides_tell_more(*rows, other)) return other;
    const Fill spline = fill_any_rim(ground, rim, corners, options, "");
    const bool by_energy = other.sides.empty() || off_by_rows(*rows) < off_by_energy(other, diameter(ground.mesh, rim));
    return by_energy && rows_are_nearer(ground.mesh, *rows, spline) ? std::move(*rows) : std::move(other);
  } catch (const Refusal&) {
    return std::move(*rows);
  }
}

/// A lid in the plane of the rim, or as near to it as the rim is, or a dome that is tangent to its surroundings.
Fill fill_with_cap(const Ground& ground, const std::vector<Index>& rim, FillOptions options) {
  const std::vector<Index> checked = check_topology(ground.left, rim);
  check_finite(ground.mesh, ground.left, checked);
  const std::string reason = std::string("a ") + name_of(options.cap) + " cap was asked for";
  if (options.cap == Cap::flat) {
    Fill lid = fill_flat(ground, checked, options);
    lid.report.warnings.clear();
    lid.report.method_reason = reason;
    return lid;
  }
  if (is_continuity_open(options)) options.continuity = SideContinuity::g1;
  options.cross_boundary = CrossBoundary::consistent;  // of three sides
  try {
    check_positions(ground.mesh, ground.left, checked);
    PolygonFill made = fill_round(ground.mesh, ground.left, checked, options, false);
    made.fill.report.method_reason = reason;
    if (!made.crumpled && !runs_away(ground, made.fill, options)) return std::move(made.fill);
  } catch (const Refusal&) {  // a rim of few edges, or with corners
  }
  return fill_any_rim(ground, checked, std::vector<Index>(), options, reason);
}

/// The edges of the rim at which a fill meets the mesh at an angle.
std::vector<std::array<Index, 2>> sharp_rim_edges(const Ground& ground, const Fill& fill) {
  const Index n = ground.mesh.vertices.rows();
  const auto at = [&](Index v) -> Vec3 { return v < n ? Vec3(ground.mesh.vertices.row(v)) : Vec3(fill.vertices.row(v - n)); };
  std::vector<std::array<Index, 2>> edges;
  for (Index f = 0; f < fill.faces.size(); ++f) {
    const std::span<const Index> face = fill.faces[f];
    Vec3 area = Vec3::Zero();
    for (std::size_t k = 2; k < face.size(); ++k) area += (at(face[k - 1]) - at(face[0])).cross(at(face[k]) - at(face[0]));
    for (std::size_t k = 0; k < face.size(); ++k) {
      const Index a = face[k], b = face[(k + 1) % face.size()];
      const auto beyond = a < n && b < n ? ground.left.edge(b, a) : std::nullopt;
      if (beyond && angle_between(area, area_vector(ground.mesh, ground.left.face(*beyond))) > least_crease_angle)
        edges.push_back({a, b});
    }
  }
  return edges;
}

/// Whether nobody has asked for anything but that a wall that is lost comes back.
bool is_lid(const Ground& ground, const Fill& fill, const FillOptions& options) {
  if (options.cap != Cap::automatic || !options.islands.empty()) return options.cap == Cap::flat;
  return is_continuity_open(options) &&
         walls_end_at_flat_rim(ground.mesh, ground.left, fill.rim, diameter(ground.mesh, fill.rim));
}

}  // namespace

Fill fill_as_the_rim_asks(const Ground& ground, const std::vector<Index>& rim, const Corners& corners,
                          const FillOptions& options) {
  const bool as_they_go_on = options.cap == Cap::automatic || !options.islands.empty();
  Fill fill = as_they_go_on ? fill_as_they_go_on(ground, rim, corners, options) : fill_with_cap(ground, rim, options);
  if (!is_lid(ground, fill, options)) return fill;
  const std::vector<std::array<Index, 2>> edges = sharp_rim_edges(ground, fill);
  fill.feature_edges.insert(fill.feature_edges.end(), edges.begin(), edges.end());
  return fill;
}

}  // namespace tripatch
