#include "tripatch/fill.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <sstream>

#include "tripatch/boundary/mesh_sides.h"
#include "tripatch/boundary/surroundings.h"
#include "tripatch/cage/cage_fill.h"
#include "tripatch/constructions/methods.h"
#include "tripatch/hole/clear_corners.h"
#include "tripatch/hole/corners.h"
#include "tripatch/hole/outer_borders.h"
#include "tripatch/hole/rim_checks.h"
#include "tripatch/hole/rim_shape.h"
#include "tripatch/hole/sharp_sides.h"
#include "tripatch/math/angle.h"
#include "tripatch/math/parallel.h"
#include "tripatch/mesh/border_loops.h"
#include "tripatch/output/cover.h"
#include "tripatch/output/quad_cover.h"
#include "tripatch/patch/moved_surface.h"
#include "tripatch/patch_from_sides.h"
#include "tripatch/polygon_fill.h"
#include "tripatch/report/folded_triangles.h"
#include "tripatch/spline/features.h"
#include "tripatch/spline/plane_fill.h"
#include "tripatch/spline_fill.h"

namespace tripatch {
namespace {

/// Edges of a rim that a face beside it is as long as, from which on it is a strip: twice the diagonal of two squares.
constexpr double strip = 4;

/// Sizes of what is filled that it lies away from the origin, from which on coordinates have lost more than they can spare: second
/// differences of a rim of a hundred edges lose four digits more.
constexpr double far_away = 1e3;

/// Where computations are about: the middle of the rims, or of the mesh where none is given; nothing where that is near the origin.
std::optional<Vec3> local_origin(const Mesh& mesh, std::span<const std::vector<Index>> rims) {
  Vec3 low = Vec3::Constant(INFINITY), high = -low;
  const auto take = [&](Index v) {
    const Vec3 p = mesh.vertices.row(v);
    if (!p.allFinite()) return;  // named later on, where it matters
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  };
  for (const std::vector<Index>& rim : rims)
    for (Index v : rim)
      if (v >= 0 && v < mesh.vertices.rows()) take(v);
  if (rims.empty())
    for (Index v = 0; v < mesh.vertices.rows(); ++v) take(v);
  const Vec3 middle = 0.5 * (low + high);
  if (!middle.allFinite() || middle.norm() <= far_away * (high - low).norm()) return {};
  return middle;
}

/// A mesh about another origin, and the options of what is filled in it.
struct Elsewhere {
  Vec3 origin;
  Points vertices;
  FillOptions options;

  Elsewhere(const Mesh& mesh, const FillOptions& given, const Vec3& about)
      : origin(about), vertices(mesh.vertices.rowwise() - about.transpose()), options(given) {
    if (options.center) *options.center -= origin;
    for (Through& each : options.through) each.point -= origin;
  }

  void bring_back(Fill& fill) const {
    fill.vertices.rowwise() += origin.transpose();
    fill.moved_to.rowwise() += origin.transpose();
    if (fill.patch) fill.patch = moved(fill.patch, origin);
    for (Side& side : fill.sides) side.c = side.c + PiecewisePolynomial::constant(std::span<const double>(origin.data(), 3));
  }
};

class Stopwatch {
public:
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

void check_options(const FillOptions& options) {
  check(options);
  const bool triangles = options.output == Output::triangles;
  if (options.resolution && (*options.resolution < (triangles ? 1 : 0) || *options.resolution > (triangles ? 10000 : 100)))
    throw InvalidArgument(triangles ? "resolution must be from 1 to 10000" : "resolution must be from 0 to 100");
}

/// A mesh and who is beside whom in it, for one fill or for several.
class Ground {
public:
  /// For one rim, or for all of the mesh where none is given.
  Ground(const Mesh& given, const std::optional<std::vector<Index>>& rim, const FillOptions& options)
      : mesh(given), left(connectivity(given, rim, options.replaced)), is_part_(rim.has_value()) {
    if (!options.replaced.empty() && (options.surroundings == SurroundingsFrom::limit || !rim))
      all_ = connectivity(given, rim, {});
  }
  /// With the faces that are replaced.
  const Connectivity& whole() const { return all_ ? *all_ : left; }
  /// Whether the neighborhood of one rim is all that is known.
  bool is_part() const { return is_part_; }

  const Mesh& mesh;
  Connectivity left;  ///< without the faces that are replaced

private:
  static Connectivity connectivity(const Mesh& mesh, const std::optional<std::vector<Index>>& rim,
                                   const std::vector<Index>& replaced) {
    return rim ? Connectivity::around(mesh, *rim, most_rings, replaced) : Connectivity(mesh, replaced);
  }
  std::optional<Connectivity> all_;
  bool is_part_;
};

using Corners = std::optional<std::vector<Index>>;

/// Of a method that takes three sides only.
std::optional<std::array<Index, 3>> three(const Corners& corners) {
  if (!corners) return {};
  if (corners->size() == 3) return std::array<Index, 3>{(*corners)[0], (*corners)[1], (*corners)[2]};
  throw Refusal("This method fills between three corners; " + std::to_string(corners->size()) +
                    " are given. The methods auto and polyharmonic_spline take any number",
                *corners);
}

std::vector<Index> loop_through(const Ground& ground, const std::vector<Index>& corners) {
  for (std::vector<Index>& loop : border_loops(ground.whole()))
    if (!corners.empty() && std::find(loop.begin(), loop.end(), corners[0]) != loop.end()) return std::move(loop);
  throw Refusal("The corner is not on the border of the mesh", corners);
}

/// The only hole of the mesh, of any rim; of several the only one with three corners.
std::vector<Index> only_hole(const Ground& ground) {
  std::vector<std::vector<Index>> loops;
  for (Border& border : borders_of(ground.mesh, ground.whole()))
    if (!border.outer) loops.push_back(std::move(border.loop));
  return loops.size() == 1 ? loops[0] : find_hole(ground.mesh, ground.whole()).rim;
}

Hole hole_of(const Ground& ground, const std::optional<std::vector<Index>>& rim, const Corners& corners) {
  if (rim) return make_hole(ground.mesh, ground.left, *rim, three(corners));
  if (!corners) return find_hole(ground.mesh, ground.whole());
  return make_hole(ground.mesh, ground.left, loop_through(ground, *corners), three(corners));
}

std::vector<Index> at_places(const std::vector<Index>& loop, const std::vector<Index>& places) {
  std::vector<Index> vertices;
  for (Index place : places) vertices.push_back(loop[place]);
  return vertices;
}

/// What is said of every fill, whatever it is made of.
void complete_report(const SidedRim& hole, const FillOptions& options, const std::vector<double>& corner_mismatch_deg,
                     Report& report) {
  const bool automatic = options.method == automatic_method, three = hole.is_triangle();
  report.method = three ? find_method(automatic ? patch_method : options.method).name : polygon_method;
  report.method_reason = !automatic ? "it was asked for"
                         : three    ? "the rim has three smooth sides"
                                    : "the rim has " + std::to_string(hole.sides()) + " sides";
  report_corners(hole.rim, hole.corners, corner_mismatch_deg, report);
  tell_folds(report);
}

/// Angles by side of a hole with three corners, as of sharp_sides.
std::vector<double> sharp_sides_of(const Ground& ground, const Hole& hole) {
  const std::vector<double> from_first = sharp_sides(ground.mesh, ground.left, hole.rim, hole.corners);
  return {from_first[1], from_first[2], from_first[0]};  // side 2 begins at corner 0
}

void check_counts(const FillOptions& options, std::size_t sides) {
  check_count(options.continuity, sides, "continuity");
  check_count(options.bulge, sides, "bulge");
}

/// The path of three sides: what surrounds them, the patch between them, the faces on it, and how well all that fits.
Fill fill_with_patch(const Ground& ground, Hole hole, const FillOptions& options) {
  check_counts(options, 3);
  const Mesh& mesh = ground.mesh;
  const std::string method = options.method == automatic_method ? patch_method : options.method;
  const bool looks_for_sharp =
      options.surroundings == SurroundingsFrom::mesh && std::string(find_method(method).continuity) != "G0";
  std::vector<double> angles = looks_for_sharp ? sharp_sides_of(ground, hole) : std::vector<double>(3, 0.0);
  SideTerms terms = terms_of_sides(options.continuity, angles);
  std::copy(terms.alone.begin(), terms.alone.end(), hole.alone.begin());
  FillOptions own = options;
  own.continuity = BySide<SideContinuity>(std::move(terms.continuity));
  const Surroundings surroundings = surroundings_of(
      mesh, ground.whole(), ground.left, hole, options.surroundings == SurroundingsFrom::limit ? &options.subdivision : nullptr);

  MadePatch made = patch_from_sides(surroundings.sides, own);
  Fill fill;
  fill.patch = std::move(made.patch);
  fill.report = std::move(made.report);
  fill.sides.assign(surroundings.sides.begin(), surroundings.sides.end());

  const bool own_rim = surroundings.border.rows() > 0;
  const Cover cover = options.output == Output::quads
                          ? cover_with_quads(mesh, hole, surroundings.parameters, *fill.patch, layout_options(options), own_rim)
                          : cover_with_triangles(hole, surroundings.parameters, *fill.patch, options.resolution,
                                                 own_rim ? nullptr : &ground.left);
  deliver(cover, surroundings.border, mesh.vertices.rows(), fill);
  fill.rim = hole.rim;
  fill.rim_barycentric = rim_barycentric(hole, surroundings);
  fill.rim_normals = fill.patch->normals(fill.rim_barycentric);

  Report& report = fill.report;
  measure_seam(*fill.patch, surroundings.sides, report);
  report.triangles_folded =
      count_folded_edges(mesh.vertices, fill.vertices, fill.faces, faces_beyond(mesh, ground.left, {hole.rim}));
  report.surroundings_error = surroundings.error;
  report.warnings.insert(report.warnings.begin(), surroundings.warnings.begin(), surroundings.warnings.end());
  complete_report(hole, options, {made.corner_mismatch_deg.begin(), made.corner_mismatch_deg.end()}, report);
  tell_sharp(angles, report.warnings);
  return fill;
}

/// Whether the patch's own shape is asked for.
bool is_shaped(const FillOptions& options) {
  return options.tension > 0 || options.center || options.center_offset != 0 || !options.through.empty() ||
         !options.bulge.are_all(1) ||
         std::find(options.continuity.begin(), options.continuity.end(), SideContinuity::free) != options.continuity.end();
}

std::vector<Fill> fill_with_cages(const Ground& ground, const std::vector<SidedRim>& holes, const FillOptions& options);

/// Whether faces beside the hole are many times as long as its rim's edges, or its sides have an edge each, of which one split leaves
/// no even way from side to side.
bool may_fold_by_splitting(const Ground& ground, const SidedRim& hole) {
  const Points vertices = ground.mesh.vertices(hole.rim, Eigen::all);
  const Index n = vertices.rows();
  if (n == 3) return true;
  for (Index k = 0; k < n; ++k) {
    const double edge = (vertices.row(k) - vertices.row((k + 1) % n)).norm();
    for (const Connectivity::Corner c : ground.left.at(hole.rim[k]))
      for (Index v : ground.mesh.faces[ground.left.face(c)])
        if ((ground.mesh.vertices.row(v) - vertices.row(k)).norm() > strip * edge) return true;
  }
  return false;
}

/// A vertex on an edge of an odd rim leaves the face beside it an n-gon, whose limit goes no way along a strip as that of its neighbors
/// does: beside long strips the rim's limit is a zigzag there. A triangle in the middle leaves the rim as it is.
std::vector<Fill> with_triangle_if_that_folds_less(const Ground& ground, const std::vector<SidedRim>& holes,
                                                   const FillOptions& options, std::vector<Fill> fills) {
  const auto folds = [](const Fill& fill) { return fill.report.folds + fill.report.triangles_folded; };
  if (holes.size() != 1 || options.odd != Odd::split || holes[0].rim.size() % 2 == 0 || folds(fills[0]) == 0 ||
      !may_fold_by_splitting(ground, holes[0]))
    return fills;
  FillOptions triangle = options;
  triangle.odd = Odd::triangle;
  std::vector<Fill> others = fill_with_cages(ground, holes, triangle);
  if (folds(others[0]) >= folds(fills[0])) return fills;
  others[0].report.warnings.push_back(
      "The rim is odd, and with an edge of it split the fill would fold: it has a triangle instead");
  return others;
}

/// Rows that a tolerance has asked for may turn quads over where there is no room for them.
std::vector<Fill> without_rows_if_that_folds_less(const Ground& ground, const std::vector<SidedRim>& holes,
                                                  const FillOptions& options, std::vector<Fill> fills) {
  const Report& report = fills[0].report;
  if (holes.size() != 1 || holes[0].is_triangle() || options.resolution || report.rows == 0 || report.triangles_folded == 0)
    return fills;
  FillOptions plain = options;
  plain.resolution = 0;
  std::vector<Fill> others = fill_with_cages(ground, holes, plain);
  if (others[0].report.triangles_folded >= report.triangles_folded) return fills;
  others[0].report.warnings.emplace_back("With the rows that the tolerance asks for the cage would fold: it has none");
  return others;
}

/// The path of cages, fitted together: layouts, the fairest cages on them, patches between their sides, the cages fitted to these.
std::vector<Fill> fill_with_cages(const Ground& ground, const std::vector<SidedRim>& holes, const FillOptions& options) {
  CageOptions cage_options;
  cage_options.rim = options.cage_rim;
  CageFill cages(ground.mesh, ground.left, holes, options.subdivision, options.replaced, layout_options(options), cage_options);

  // The border of an open cage, to which an exact rim holds, is flat across and round at corners: a patch that is made fair bends
  // sharply behind it, and no cage follows. Elsewhere curvature shall vary least: in the cage, whose patch follows it, or where
  // the patch's own shape is asked for, in the patch.
  const bool exact = options.cage_rim == CageRim::exact, automatic = options.fairing == Fairing::automatic;
  const bool fair = automatic && !is_shaped(options), follows = fair && !exact;
  FillOptions wanted = options;
  if (automatic && exact && options.tension == 0) wanted.fairing.reset();
  std::vector<Fill> fills(holes.size());
  std::vector<SurfacePtr> patches;
  for (std::size_t h = 0; h < holes.size(); ++h) {
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

  cages.fit(std::move(patches), fair);
  for (std::size_t h = 0; h < holes.size(); ++h) {
    cages.complete(h, fills[h]);
    if (follows) cages.report_energies(h, fills[h].report);
    if (fair && !holes[h].is_triangle()) fills[h].report.folds = 0;  // of a patch that the cage is not fitted to
    complete_report(holes[h], options, {}, fills[h].report);
  }
  fills = with_triangle_if_that_folds_less(ground, holes, options, std::move(fills));
  return without_rows_if_that_folds_less(ground, holes, options, std::move(fills));
}

Refused refused(const Refusal& refusal) { return {refusal.what(), refusal.where()}; }

using Results = std::vector<std::variant<Fill, Refused>>;

/// Cages for several holes: those whose surroundings overlap are fitted together. given: those of the rims that are no refusals.
void fill_all_with_cages(const Ground& ground, const std::vector<std::optional<SidedRim>>& given, const FillOptions& options,
                         Results& results) {
  std::vector<SidedRim> holes;
  std::vector<std::size_t> place;  // of each hole in the results
  for (std::size_t k = 0; k < given.size(); ++k) {
    if (!given[k]) continue;
    holes.push_back(*given[k]);
    place.push_back(k);
  }
  for (const std::vector<std::size_t>& group : cage_groups(ground.left, holes)) {
    std::vector<SidedRim> together;
    for (std::size_t h : group) together.push_back(holes[h]);
    const Stopwatch watch;
    try {
      std::vector<Fill> fills = fill_with_cages(ground, together, options);
      for (std::size_t k = 0; k < group.size(); ++k) {
        fills[k].report.seconds = watch.seconds() / static_cast<double>(group.size());
        results[place[group[k]]] = std::move(fills[k]);
      }
    } catch (const Refusal& refusal) {
      if (group.size() == 1) results[place[group[0]]] = refused(refusal);
      for (std::size_t h = 0; group.size() > 1 && h < group.size(); ++h) {  // one of them stands in the way of the others
        const Stopwatch own;
        Results::value_type& result = results[place[group[h]]];
        try {
          Fill alone = std::move(fill_with_cages(ground, {together[h]}, options)[0]);
          alone.report.seconds = own.seconds();
          result = std::move(alone);
        } catch (const Refusal& alone) {
          result = refused(alone);
        }
      }
    }
  }
}

// ------------------------------------------------------------------------------------------------------ rims of any kind

/// Options that a fill over a plane domain does not take, of those that are not as they come.
std::string not_taken(const FillOptions& options) {
  std::string names;
  const auto add = [&](bool given, const char* name) {
    if (given) names += (names.empty() ? "" : ", ") + std::string(name);
  };
  const auto plain = [](SideContinuity c) { return c == SideContinuity::automatic || c == SideContinuity::g1; };
  add(!std::all_of(options.continuity.begin(), options.continuity.end(), plain), "continuity");
  add(options.fairing != Fairing::automatic, "fairing");
  add(!options.bulge.are_all(1), "bulge");
  add(options.tension > 0, "tension");
  add(options.center.has_value(), "center");
  add(options.center_offset != 0, "center_offset");
  add(!options.through.empty(), "through");
  return names;
}

/// The spline, which does not continue what meets the hole at an angle. given: corners of the rim, in its order; none: as detected.
Fill fill_beside_sharp_sides(const Ground& ground, const Connectivity& around, const std::vector<Index>& rim,
                             const std::vector<Index>& given, SplineFillOptions options) {
  std::vector<Index> places;
  for (std::size_t k = 0; k < rim.size(); ++k)
    if (std::find(given.begin(), given.end(), rim[k]) != given.end()) places.push_back(static_cast<Index>(k));
  try {
    if (given.empty()) places = detect_corners(ground.mesh, around, rim);
  } catch (const Refusal&) {  // faces without area tell nothing
  }
  std::vector<double> angles;
  if (places.size() >= 2 && places.size() <= static_cast<std::size_t>(most_sides))
    angles = sharp_sides(ground.mesh, around, rim, places);
  if (!any_sharp(angles)) return fill_with_spline(ground.mesh, around, rim, {}, options);
  const std::vector<Index> beyond = not_continued(ground.mesh, around, rim, places, angles);
  const Connectivity continued(ground.mesh, beyond);
  options.continued = &continued;
  Fill fill = fill_with_spline(ground.mesh, around, rim, {}, options);
  const auto sharp = std::count_if(angles.begin(), angles.end(), [](double angle) { return angle > 0; });
  fill.report.warnings.push_back("The mesh meets the hole at an angle along " + std::to_string(sharp) + " of its " +
                                 std::to_string(angles.size()) + " sides: the fill is not continued there");
  return fill;
}

/// The path of any rim.
Fill fill_any_rim(const Ground& ground, const std::vector<Index>& rim, const Corners& corners, const FillOptions& options,
                  const std::string& reason) {
  const std::string ignored = not_taken(options);
  const bool insisted = options.method == spline_method;
  if (insisted && !ignored.empty()) throw InvalidArgument(std::string(spline_method) + " does not take " + ignored);
  if (options.surroundings == SurroundingsFrom::limit)
    throw Refusal("Limit surroundings are read for holes with three corners only: " + reason, {});
  std::vector<std::string> warnings;
  const auto ordered = [&](const std::vector<Index>& loop) {
    std::vector<Index> checked = check_topology(ground.left, loop);
    std::rotate(checked.begin(), std::min_element(checked.begin(), checked.end()), checked.end());
    check_finite(ground.mesh, ground.left, checked);
    try {
      check_positions(ground.mesh, ground.left, checked);
    } catch (const Refusal& refusal) {  // no hindrance to triangles
      warnings.push_back(std::string(refusal.what()) + ": Merge by Distance may be what the mesh needs");
    }
    return checked;
  };
  std::vector<std::vector<Index>> islands;
  for (const std::vector<Index>& island : options.islands) islands.push_back(ordered(island));
  const SplineFillOptions own = {options.resolution, options.output == Output::quads, options.features, nullptr};
  // A neighborhood that was enough for three sides is not for this: rings are taken as far as half the hole's diameter.
  const std::optional<Connectivity> all =
      ground.is_part() ? std::optional<Connectivity>(Connectivity(ground.mesh, options.replaced)) : std::nullopt;
  std::vector<Index> loop = ordered(rim), at;  // from the first corner on; the others as the rim meets them
  if (corners && !corners->empty()) {
    const auto first = std::find(loop.begin(), loop.end(), (*corners)[0]);
    if (first != loop.end()) std::rotate(loop.begin(), first, loop.end());
    for (Index v : loop)
      if (std::find(corners->begin(), corners->end(), v) != corners->end()) at.push_back(v);
    for (Index v : *corners)
      if (std::find(loop.begin(), loop.end(), v) == loop.end())
        throw Refusal("Corner vertex " + std::to_string(v) + " is not on the rim", {v});
    if (at.size() != corners->size()) throw InvalidArgument("A corner is given twice");
  }
  const Connectivity& around = all ? *all : ground.left;
  const bool looks_for_sharp =
      islands.empty() && (!corners || !corners->empty()) && ignored.find("continuity") == std::string::npos;
  Fill fill = looks_for_sharp ? fill_beside_sharp_sides(ground, around, loop, at, own)
                              : fill_with_spline(ground.mesh, around, loop, islands, own);
  fill.report.method_reason = reason;
  fill.report.warnings.insert(fill.report.warnings.begin(), warnings.begin(), warnings.end());
  fill.report.corners = std::move(at);
  if (!insisted && !ignored.empty())
    fill.report.warnings.push_back("For " + ignored +
                                   " smooth sides are needed, between which a patch lies without folds: not applied");
  return fill;
}

/// A rim from its first corner on, with the places of the corners.
struct CorneredRim {
  std::vector<Index> rim, places;
};
CorneredRim cornered(const Ground& ground, const std::vector<Index>& rim, const std::vector<Index>& corners) {
  CorneredRim out;
  out.rim = check_topology(ground.left, rim);
  check_finite(ground.mesh, ground.left, out.rim);
  check_positions(ground.mesh, ground.left, out.rim);
  for (Index v : corners)
    if (std::find(out.rim.begin(), out.rim.end(), v) == out.rim.end())
      throw Refusal("Corner vertex " + std::to_string(v) + " is not on the rim", {v});
  std::rotate(out.rim.begin(), std::find(out.rim.begin(), out.rim.end(), corners[0]), out.rim.end());
  for (std::size_t k = 0; k < out.rim.size(); ++k)
    if (std::find(corners.begin(), corners.end(), out.rim[k]) != corners.end()) out.places.push_back(static_cast<Index>(k));
  if (out.places.size() != corners.size()) throw InvalidArgument("A corner is given twice");
  return out;
}

/// Numbers of corners that a patch over a polygon or a lens takes: not three.
bool makes_polygon(const std::vector<Index>& corners) {
  return corners.size() >= 2 && corners.size() != 3 && corners.size() <= static_cast<std::size_t>(most_sides);
}

/// The rim of a cage's hole: of the corners that are given, else of three where they are found, else of those that its quads make or that
/// are clear.
SidedRim cage_rim_of(const Ground& ground, const std::optional<std::vector<Index>>& rim, const Corners& corners) {
  if (!corners) {
    try {
      return hole_of(ground, rim, corners);
    } catch (const Refusal&) {
      const std::vector<Index> loop = check_topology(ground.left, rim ? *rim : only_hole(ground));
      check_finite(ground.mesh, ground.left, loop);
      std::vector<Index> places = corners_by_valence(ground.mesh, ground.left, loop);
      if (places.empty()) places = corners_between_sides(ground.mesh, ground.left, loop);
      const std::vector<Index> found = at_places(loop, places);
      if (!makes_polygon(found)) throw;
      return cage_rim_of(ground, loop, found);
    }
  }
  if (!makes_polygon(*corners)) return hole_of(ground, rim, corners);
  CorneredRim found = cornered(ground, rim ? *rim : loop_through(ground, *corners), *corners);
  SidedRim result;
  result.rim = std::move(found.rim);
  result.corners = std::move(found.places);
  return result;
}

/// Degrees between the tangent planes of two sides at a corner that nobody has given, from which on the surroundings are no one surface
/// there: as far as twelve edges a side are from telling those of a smooth one (2 degrees), several times over.
constexpr double one_surface = 10;

/// The exact patch between two sides or four and more where they are smooth, else the surface over a plane. given: the corners are a person's.
Fill fill_between_many(const Ground& ground, const std::vector<Index>& rim, const std::vector<Index>& corners, bool given,
                       const FillOptions& options) {
  const auto any_rim = [&](const std::string& reason) { return fill_any_rim(ground, rim, corners, options, reason); };
  check_counts(options, corners.size());
  std::string reason;
  std::optional<Fill> patch;
  try {
    const CorneredRim found = cornered(ground, rim, corners);
    if (zigzag(ground.mesh, found.rim, found.places) > smooth_sides) return any_rim("the sides between the corners zigzag");
    PolygonFill made = fill_with_polygon(ground.mesh, ground.left, found.rim, found.places, options);
    made.fill.report.method_reason = "the rim has " + std::to_string(corners.size()) + " smooth sides";
    const std::vector<std::string>& kept = made.fill.report.continuity;
    const bool beside_sharp = std::find(kept.begin(), kept.end(), "Free") != kept.end();
    if (!given && beside_sharp && corners.size() == 2 && not_taken(options).empty())
      return any_rim("two sides that are not continued tell less than the rim as a whole");
    if (!given && !beside_sharp && made.planes_apart_deg > one_surface)
      return any_rim("the tangent planes of the " + std::to_string(corners.size()) + " sides differ at the corners");
    if (!made.crumpled) {
      if (!not_taken(options).empty() || beside_sharp) return std::move(made.fill);
      Fill spline = any_rim("the surroundings as a whole tell of another surface than their " + std::to_string(corners.size()) +
                            " sides alone");
      return excluded_by(made.fill, spline, diameter(ground.mesh, rim)) ? spline : std::move(made.fill);
    }
    reason = "a patch between " + std::to_string(corners.size()) + " corners would fold or crumple";
    patch = std::move(made.fill);
  } catch (const Refusal& refusal) {
    reason = "no patch fits between " + std::to_string(corners.size()) + " sides: " + refusal.what();
  }
  Fill other = any_rim(reason);
  const bool better = !patch || other.report.triangles_folded <= patch->report.triangles_folded;
  return better ? other : std::move(*patch);
}

/// The corners of a rim, as detected, where the mesh meets the hole at an angle between them: there the rim alone tells its sides.
std::vector<Index> corners_between_sharp(const Ground& ground, const std::vector<Index>& rim) {
  try {
    const std::vector<Index> places = detect_corners(ground.mesh, ground.left, rim);
    if (places.size() <= static_cast<std::size_t>(most_sides) && any_sharp(sharp_sides(ground.mesh, ground.left, rim, places)))
      return at_places(rim, places);
  } catch (const Refusal&) {  // faces without area
  }
  return {};
}

/// The patch over a disc where the rim is smooth all around, else the surface over a plane. rim: as new faces take it.
Fill fill_round_rim(const Ground& ground, const std::vector<Index>& rim, const FillOptions& options,
                    const std::string& otherwise) {
  const auto any_rim = [&](const std::string& reason) {
    return fill_any_rim(ground, rim, std::vector<Index>(), options, reason);
  };
  if (!is_round(ground.mesh, ground.left, rim)) return any_rim(otherwise);
  check_counts(options, 1);
  try {
    check_positions(ground.mesh, ground.left, rim);
    PolygonFill made = fill_round(ground.mesh, ground.left, rim, options);
    made.fill.report.method_reason =
        made.of_revolution ? "the rim is round, and what surrounds it of revolution" : "the rim is round";
    if (made.crumpled) return any_rim("a patch over the round rim would fold or crumple");
    if (made.of_revolution || !not_taken(options).empty()) return std::move(made.fill);
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

/// Degrees between the tangent planes of three sides at their corners, the most.
double planes_apart(const SideList& sides) {
  double most = 0;
  for (int k = 0; k < 3; ++k) most = std::max(most, degrees_between(sides[(k + 1) % 3].normal(1), sides[(k + 2) % 3].normal(0)));
  return most;
}

/// The exact patch between three smooth sides, else the surface over a plane.
Fill fill_as_the_rim_asks(const Ground& ground, const std::vector<Index>& rim, const Corners& corners,
                          const FillOptions& options) {
  const auto any_rim = [&](const std::string& reason) { return fill_any_rim(ground, rim, corners, options, reason); };
  if (!options.islands.empty()) return any_rim("the hole has islands");
  if (corners && corners->empty())
    return fill_round_rim(ground, check_topology(ground.left, rim), options,
                          "a round rim was asked for, and this one is not smooth");
  const bool inner = !options.through.empty();  // the patch of three sides meets none: one over a polygon is made
  if (corners && (makes_polygon(*corners) || (inner && corners->size() == 3)))
    return fill_between_many(ground, rim, *corners, true, options);
  if (corners && corners->size() != 3) return any_rim(std::to_string(corners->size()) + " corners are given");
  Hole hole;
  const std::vector<Index> checked = check_topology(ground.left, rim);
  check_finite(ground.mesh, ground.left, checked);
  std::vector<Index> found;
  if (!corners) found = at_places(checked, corners_between_sides(ground.mesh, ground.left, checked));
  const auto creases_in = [&](const Connectivity& around) {
    return !find_features(ground.mesh, around, checked).creases.empty();
  };
  if (options.features && creases_in(ground.left) &&
      (!ground.is_part() || creases_in(Connectivity(ground.mesh, options.replaced))))
    return any_rim("a crease of the surroundings goes on across the hole");
  if (makes_polygon(found) || (inner && found.size() == 3)) return fill_between_many(ground, rim, found, false, options);
  try {
    hole = make_hole(ground.mesh, ground.left, rim, three(corners));
  } catch (const Refusal& refusal) {
    if (corners) throw;
    const std::string otherwise = std::string("three sides were not found: ") + refusal.what();
    const std::vector<Index> sharp = corners_between_sharp(ground, checked);
    if (sharp.empty()) return fill_round_rim(ground, checked, options, otherwise);
    const bool sided = makes_polygon(sharp) && not_taken(options).empty();
    return sided ? fill_between_many(ground, rim, sharp, false, options) : any_rim(otherwise);
  }
  check_counts(options, 3);
  if (zigzag(ground.mesh, hole.rim, hole.corners) > smooth_sides) return any_rim("the sides between the corners zigzag");
  std::string reason;
  std::optional<Fill> patch;
  bool apart = false;
  try {
    patch = fill_with_patch(ground, hole, options);
    apart = !corners && hole.rim.size() >= least_edges_apart && not_taken(options).empty() &&
            planes_apart(patch->sides) > no_surface && !any_sharp(sharp_sides_of(ground, hole));
    const bool folds = patch->report.folds > 0 || patch->report.triangles_folded > 0;
    if (!folds && !apart) return std::move(*patch);
    reason = folds ? "a patch between three corners would fold" : "the tangent planes of the three sides differ at the corners";
  } catch (const Refusal& refusal) {
    reason = std::string("no patch fits between three sides: ") + refusal.what();
  }
  Fill other = any_rim(reason);
  const bool better = !patch || other.report.triangles_folded < patch->report.triangles_folded ||
                      (other.report.triangles_folded == patch->report.triangles_folded && (patch->report.folds > 0 || apart));
  return better ? other : std::move(*patch);
}

/// The patch over a polygon or a disc, insisted on; nothing where the rim has three sides. Corners that are not given are detected.
std::optional<Fill> fill_with_many_sides(const Ground& ground, const std::optional<std::vector<Index>>& rim,
                                         const Corners& corners, const FillOptions& options) {
  const bool inner = !options.through.empty();
  if (corners && !corners->empty() && !makes_polygon(*corners) && !inner) return {};
  if (!corners && options.method != polygon_method && !inner) return {};
  std::vector<Index> given = corners.value_or(std::vector<Index>());
  std::vector<Index> loop = rim ? *rim : given.empty() ? only_hole(ground) : loop_through(ground, given);
  loop = check_topology(ground.left, loop);
  check_finite(ground.mesh, ground.left, loop);
  if (!corners) {
    given = at_places(loop, corners_between_sides(ground.mesh, ground.left, loop));
    if ((given.size() == 3 && !inner) || (given.empty() && !is_round(ground.mesh, ground.left, loop))) return {};
  }
  check_counts(options, std::max<std::size_t>(given.size(), 1));
  Fill fill;
  if (given.empty()) {
    check_positions(ground.mesh, ground.left, loop);
    fill = std::move(fill_round(ground.mesh, ground.left, loop, options).fill);
  } else {
    const CorneredRim found = cornered(ground, loop, given);
    fill = std::move(fill_with_polygon(ground.mesh, ground.left, found.rim, found.places, options).fill);
  }
  fill.report.method_reason = "it was asked for";
  return fill;
}

Fill fill_as_asked(const Ground& ground, const std::optional<std::vector<Index>>& rim, const Corners& corners,
                   const FillOptions& options) {
  const bool of_mesh = options.surroundings == SurroundingsFrom::mesh;  // a cage's limit surface has three sides only
  const bool automatic = options.method == automatic_method && of_mesh;
  if (!automatic && options.method != spline_method) {
    const bool polygon = options.method == polygon_method || options.method == patch_method;
    if (polygon && of_mesh)
      if (std::optional<Fill> fill = fill_with_many_sides(ground, rim, corners, options)) return std::move(*fill);
    return fill_with_patch(ground, hole_of(ground, rim, corners), options);
  }
  const std::vector<Index> loop = rim ? *rim : corners && !corners->empty() ? loop_through(ground, *corners) : only_hole(ground);
  if (!automatic) return fill_any_rim(ground, loop, corners, options, "it was asked for");
  return fill_as_the_rim_asks(ground, loop, corners, options);
}

Fill fill_by_method(const Ground& ground, const std::optional<std::vector<Index>>& rim, const Corners& corners,
                    const FillOptions& options) {
  Fill fill = fill_as_asked(ground, rim, corners, options);
  Report& report = fill.report;
  if (report.triangles_folded > 0 && report.method != spline_method)
    report.rim_folded = folds_of_rim(ground.mesh, ground.left, {fill.rim});
  return fill;
}

void check_for_holes(const FillOptions& options) {
  check_options(options);
  if (options.corners && options.corners->size() == 1)
    throw InvalidArgument("corners must be two vertices of the rim or more, or none for a round rim; one is given");
  if (options.method != automatic_method && !find_method(options.method).fills_holes)
    throw InvalidArgument(options.method + " joins three given surfaces; it does not fill a hole in a mesh");
  const bool patch = options.method == automatic_method || options.method == polygon_method || options.method == patch_method;
  if (!options.through.empty() && (!patch || options.surroundings != SurroundingsFrom::mesh))
    throw InvalidArgument("through is met by the methods auto and " + std::string(polygon_method) +
                          ", beside surroundings that are a mesh");
  if (options.method == spline_method && options.output == Output::cage)
    throw InvalidArgument(std::string(spline_method) + " makes no cages; choose another method, or triangles or quads");
}

/// Before anything is refused that names them.
void check_named(const Mesh& mesh, std::span<const std::vector<Index>> rims, const Corners& corners, const FillOptions& options) {
  const Index n = mesh.vertices.rows();
  for (const std::vector<Index>& rim : rims) check_vertices(rim, n, "Rim");
  for (const std::vector<Index>& island : options.islands) check_vertices(island, n, "Island");
  if (corners) check_vertices(*corners, n, "Corner");
}

}  // namespace

Fill fill(const Mesh& mesh, const FillOptions& options) {
  const Stopwatch watch;
  check_for_holes(options);
  const std::span<const std::vector<Index>> given =
      options.rim ? std::span<const std::vector<Index>>(&*options.rim, 1) : std::span<const std::vector<Index>>();
  check_named(mesh, given, options.corners, options);
  if (const std::optional<Vec3> origin = local_origin(mesh, given)) {
    const Elsewhere near(mesh, options, *origin);
    Fill result = fill({near.vertices, mesh.faces}, near.options);
    near.bring_back(result);
    return result;
  }
  const Ground ground(mesh, options.rim, options);
  Fill result = options.output == Output::cage
                    ? std::move(fill_with_cages(ground, {cage_rim_of(ground, options.rim, options.corners)}, options)[0])
                    : fill_by_method(ground, options.rim, options.corners, options);
  result.report.seconds = watch.seconds();
  return result;
}

std::vector<std::variant<Fill, Refused>> fill_all(const Mesh& mesh, const std::vector<std::vector<Index>>& rims,
                                                  const FillOptions& options,
                                                  const std::vector<std::optional<std::vector<Index>>>& corners,
                                                  const Progress& progress) {
  if (options.center && rims.size() > 1)
    throw InvalidArgument("center is the middle of one hole; center_offset moves the middles of several");
  check_for_holes(options);
  check_named(mesh, rims, {}, options);
  for (const Corners& each : corners) check_named(mesh, {}, each, options);
  Results results(rims.size());
  if (rims.empty()) return results;
  if (const std::optional<Vec3> origin = local_origin(mesh, rims)) {
    const Elsewhere near(mesh, options, *origin);
    results = fill_all({near.vertices, mesh.faces}, rims, near.options, corners, progress);
    for (std::variant<Fill, Refused>& result : results)
      if (Fill* fill = std::get_if<Fill>(&result)) near.bring_back(*fill);
    return results;
  }
  std::optional<std::vector<Index>> only;
  if (rims.size() == 1) only = rims[0];
  const Ground ground(mesh, only, options);
  const auto report_progress = [&](std::size_t done) {
    if (progress) progress(done);
  };
  const auto corners_at = [&](std::size_t k) { return k < corners.size() ? corners[k] : Corners(); };
  if (options.output == Output::cage) {
    std::vector<std::optional<SidedRim>> holes(rims.size());
    for (std::size_t k = 0; k < rims.size(); ++k) {
      try {
        holes[k] = cage_rim_of(ground, rims[k], corners_at(k));
      } catch (const Refusal& refusal) {
        results[k] = refused(refusal);
      }
    }
    fill_all_with_cages(ground, holes, options, results);
    report_progress(rims.size());
    return results;
  }
  const auto fill_one = [&](std::size_t k) {
    const Stopwatch watch;
    try {
      Fill fill = fill_by_method(ground, rims[k], corners_at(k), options);
      fill.report.seconds = watch.seconds();
      results[k] = std::move(fill);
    } catch (const Refusal& refusal) {
      results[k] = refused(refusal);
    }
  };
  parallel_for_each(rims.size(), fill_one, report_progress);
  return results;
}

}  // namespace tripatch
