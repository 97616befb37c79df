#include "tripatch/fill.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>

#include "tripatch/annulus/annulus_patch.h"
#include "tripatch/boundary/shared_planes.h"
#include "tripatch/cage_fills/cage_fills.h"
#include "tripatch/constructions/methods.h"
#include "tripatch/fill/any_rim_fill.h"
#include "tripatch/fill/elsewhere.h"
#include "tripatch/fill/fill_context.h"
#include "tripatch/fill/insisted.h"
#include "tripatch/fill/merged_rims.h"
#include "tripatch/fill/requested_fill.h"
#include "tripatch/fill/rows_fill.h"
#include "tripatch/fill/select.h"
#include "tripatch/fill/triangle_fill.h"
#include "tripatch/fill_checks.h"
#include "tripatch/hole/extra_face.h"
#include "tripatch/hole/near_duplicate_borders.h"
#include "tripatch/hole/rim_shape.h"
#include "tripatch/isometry/isometric_fill.h"
#include "tripatch/math/angle.h"
#include "tripatch/math/parallel.h"
#include "tripatch/math/stopwatch.h"
#include "tripatch/output/leaned.h"
#include "tripatch/output/shaped.h"
#include "tripatch/report/dihedrals.h"
#include "tripatch/report/folded_triangles.h"
#include "tripatch/spline/plane_fill.h"
#include "tripatch/spline/small_fill.h"

namespace tripatch {
namespace {

/// Whether a method is requested that fills between three sides and nothing else.
bool wants_three(const FillOptions& options) {
  return options.method != automatic_method && find_method(options.method).sides == std::array{3, 3};
}

/// Throws a Refusal where such a method is given other corners.
void check_three(const FillOptions& options, const Corners& corners) {
  if (!corners || corners->size() == 3 || !wants_three(options)) return;
  if (corners->empty()) throw CodedRefusal(Code::method_takes_three_not_round, {{"method", options.method}});
  throw CodedRefusal(Code::method_takes_three, {{"method", options.method}, {"count", corners->size()}}, *corners);
}

/// A limit surface is continued between three sides only.
Hole hole_of_limit(const FillContext& context, const std::optional<std::vector<Index>>& rim, const Corners& corners) {
  try {
    return hole_of(context, rim, corners);
  } catch (const CodedRefusal& refusal) {
    const std::vector<Index>& seen = refusal.message().where;
    const Code code = refusal.message().code;
    if (code != Code::no_clear_corners && code != Code::too_many_corners && code != Code::not_three_corners) throw;
    const bool none = code == Code::no_clear_corners;
    const Message reason = none ? Message{Code::no_smooth_sides} : Message{Code::has_sides, {{"count", seen.size()}}};
    throw CodedRefusal(Code::limit_needs_three_corners, {{"reason", reason}}, seen);
  }
}

Fill fill_one_hole(const Mesh& mesh, const FillOptions& options);

/// Of what vertices are moved in, and of cages, which are not.
FillOptions to_be_moved(FillOptions options) {
  if (options.fairing == Fairing::isometric) options.fairing = Fairing::automatic;
  return options;
}

Fill fill_as_asked(const FillContext& context, const std::optional<std::vector<Index>>& rim, const Corners& corners,
                   const FillOptions& options) {
  const bool of_mesh = options.surroundings == SurroundingsFrom::mesh;  // a cage's limit surface has three sides only
  const bool automatic = options.method == automatic_method && of_mesh;
  const bool any_rim = options.method == spline_method || options.method == rows_method || options.method == annulus_method;
  if (!automatic && !any_rim) {
    check_three(options, corners);
    if (of_mesh && (options.method == polygon_method || !options.through.empty()))
      if (std::optional<Fill> fill = fill_with_many_sides(context, rim, corners, options)) return std::move(*fill);
    const Hole hole = of_mesh ? hole_of(context, rim, corners) : hole_of_limit(context, rim, corners);
    return fill_with_patch(context, triangle_input(context, hole, options), options);
  }
  const std::vector<Index> loop = rim                            ? *rim
                                  : corners && !corners->empty() ? loop_through(context, *corners)
                                                                 : only_hole(context);
  if (!rim && has_edges_of_no_length(context.mesh.vertices, loop)) {
    FillOptions with_rim = options;
    with_rim.rim = loop;
    return fill_one_hole(context.mesh, with_rim);
  }
  if (automatic) return fill_and_shape(context, loop, corners, options);
  Fill fill = options.method == rows_method      ? fill_with_rows_only(context, loop, corners, options)
              : options.method == annulus_method ? fill_ring(context, loop, options)
                                                 : fill_any_rim(context, loop, corners, options);
  shape(context.mesh, context.left, sizes_of(options.islands), options, fill);
  return fill;
}

/// Tells where no edge of an odd rim was split although that was asked for.
void tell_odd(const FillOptions& options, Fill& fill) {
  if (options.output != Output::quads || options.odd != Odd::split || fill.rim.size() % 2 == 0 || !fill.split_edges.empty())
    return;
  Index triangles = 0;
  for (Index f = 0; f < fill.faces.size(); ++f) triangles += fill.faces[f].size() == 3 ? 1 : 0;
  if (triangles == 1) fill.report.warnings.push_back({Code::one_triangle});
}

/// Vertices of the mesh, or the fill's own where it meets a limit surface.
Points border_of(const Mesh& mesh, const Fill& fill) {
  return fill.border.empty() ? Points(mesh.vertices(fill.rim, Eigen::all)) : Points(fill.vertices(fill.border, Eigen::all));
}

/// A patch that nobody shapes by hand states its expected error: the root mean square of deviations that grow with the distance from the
/// border.
void state_deviation(const Mesh& mesh, const FillOptions& options, Fill& fill) {
  const bool tells = options.fairing == Fairing::automatic && !fill.report.fairing.empty() && !is_shaped_by_hand(options);
  if (fill.deviation.size() > 0 || fill.vertices.rows() == 0 || !fill.patch || !tells) return;
  const double size = diameter(mesh, fill.rim);
  Eigen::VectorXd away(fill.vertices.rows());  // of a triangle the height over the nearest side, else over the diameter
  if (fill.barycentric.rows() == away.size()) {
    away = fill.barycentric.rowwise().minCoeff().cwiseMax(0);
  } else {
    const Eigen::MatrixXd border = border_of(mesh, fill) / std::max(size, tolerance::tiny);
    for (Index k = 0; k < away.size(); ++k) {
      const Eigen::RowVector3d at = fill.vertices.row(k) / std::max(size, tolerance::tiny);
      away[k] = std::sqrt((border.rowwise() - at).rowwise().squaredNorm().minCoeff());
    }
  }
  fill.deviation = expected_error(fill, size) / std::max(root_mean_square(away), tolerance::tiny) * away;
  fill.report.deviation_max = fill.deviation.maxCoeff();
}

/// How far the patch is from the vertices of the border that it is to meet. Told if that turns its edges by more than the surroundings are
/// known. A surface that continues all of them states its error instead.
void measure_gap(const Mesh& mesh, Fill& fill) {
  const bool own = !fill.border.empty(), plane = fill.rim_barycentric.rows() == 0;
  const Points met = border_of(mesh, fill);
  const Points places = plane ? as_rows(own ? PlanePoints(fill.uv(fill.border, Eigen::all)) : fill.rim_uv)
                        : own ? Points(fill.barycentric(fill.border, Eigen::all))
                              : fill.rim_barycentric;
  Report& report = fill.report;
  report.boundary_gap = (fill.patch->positions(places) - met).rowwise().norm().maxCoeff();
  const double edge = (met.bottomRows(met.rows() - 1) - met.topRows(met.rows() - 1)).rowwise().norm().mean();
  const bool is_known = report.boundary_gap > report.surroundings_error * std::numbers::pi / 180 * edge;
  if (!fill.sides.empty() && is_known) tell_gap(diameter(mesh, fill.rim), report);
}

/// Tells of what lies on the mesh, in the border of a flat sheet: that folds, as the border could stay open.
void tell_covering(const FillContext& context, Fill& fill) {
  const Mesh& mesh = context.mesh;
  const std::vector<AdjacentFace> beyond = faces_beyond(mesh, context.left, {fill.rim});
  const auto covers = [&](const Vec3& normal) {  // one without an area lies on anything
    return std::ranges::all_of(beyond, [&](const AdjacentFace& face) {
      return !(normal.norm() > 0) || !(face.normal.norm() > 0) || degrees_between(normal, face.normal) > angle::reversed;
    });
  };
  for (Index f = 0; f < fill.faces.size(); ++f)
    if (!covers(area_of(mesh, fill, f))) return;
  fill.report.rim_folded = 0;
  fill.report.warnings.push_back({Code::lies_on_mesh});
}

/// Tells of folds between new faces that the rim forces, unless the fill has sharp edges there.
void tell_folded_inside(const Mesh& mesh, Fill& fill) {
  Report& report = fill.report;
  if (report.triangles_folded > report.rim_folded || !fill.feature_edges.empty() || fill.report.method != spline_method) return;
  for (const auto& [a, b] : folded_edges(mesh.vertices, fill.vertices, fill.faces, {})) {
    const Vec3 middle = 0.5 * (place_of(mesh, fill, a) + place_of(mesh, fill, b));
    const Index near = nearest_of(mesh.vertices, fill.rim, middle);
    report.warnings.push_back({Code::boundary_folds, {}, {near}});
    return;
  }
}

Fill fill_by_method(const FillContext& context, const std::optional<std::vector<Index>>& rim, const Corners& corners,
                    const FillOptions& options) {
  Fill fill = fill_as_asked(context, rim, corners, to_be_moved(options));
  lean(context.planes, fill);
  if (options.fairing == Fairing::isometric) make_isometric(context.mesh, context.left, sizes_of(options.islands), fill);
  refuse_infinite(fill, fill.rim);
  Report& report = fill.report;
  if (report.triangles_folded > 0 && report.method != spline_method)
    report.rim_folded = folds_of_rim(context.mesh, context.left, {fill.rim});
  refuse_if_insisted(context, fill, options);
  tell_odd(options, fill);
  if (fill.patch) measure_gap(context.mesh, fill);
  state_deviation(context.mesh, options, fill);
  if (report.triangles_folded > 0) {
    tell_covering(context, fill);
    tell_turned_over(context.mesh, context.left, fill.rim, report);
    tell_folded_inside(context.mesh, fill);
  }
  if (report.crosses_itself)
    if (const auto where = place_of_crossing(context.mesh, fill.vertices, fill.faces))
      tell_crossing(context.mesh.vertices, fill.rim, *where, report, Code::crosses_itself);
  return fill;
}

using Results = std::vector<std::variant<Fill, Refused>>;

/// Whether a rim is taken as it comes, its edges of no length too: cages, and single methods that are requested, ask for a clean one.
bool takes_any_rim(const FillOptions& options) {
  const bool any_rim = options.method == automatic_method || options.method == spline_method || options.method == rows_method ||
                       options.method == annulus_method;
  return any_rim && options.output != Output::cage && options.surroundings == SurroundingsFrom::mesh;
}

/// Sets Fill::passes_through. What the method is automatic of is filled again first, where that counts.
///
/// again: makes the k-th fill once more.
template <class Again>
void keep_clear(FillContext& context, const FillOptions& options, std::span<Fill* const> fills, const Again& again) {
  std::vector<const Fill*> all(fills.begin(), fills.end());
  const std::vector<std::optional<Vec3>> places = context.passages_of(all, options);
  context.keeps_clear = options.method == automatic_method;
  for (std::size_t k = 0; k < fills.size(); ++k) {
    fills[k]->passes_through = places[k];
    if (!places[k] || !context.keeps_clear) continue;
    try {
      Fill other = again(k);
      all[k] = &other;
      if (!context.passages_of(all, options)[k]) *fills[k] = std::move(other);
    } catch (const CodedRefusal&) {  // there is a fill
    }
    all[k] = fills[k];
  }
}

/// The rim of a cage's hole, which has three corners where the method wants that.
SidedRim cage_rim_for(const FillContext& context, const std::optional<std::vector<Index>>& rim, const Corners& corners,
                      const FillOptions& options) {
  check_three(options, corners);
  SidedRim found = cage_rim_of(context, rim, corners);
  if (wants_three(options) && !found.is_triangle())
    throw found.guessed
        ? CodedRefusal(Code::method_needs_three_rim_shows_none, {{"method", options.method}}, found.rim)
        : CodedRefusal(Code::method_needs_three, {{"method", options.method}, {"count", found.sides()}}, found.rim);
  return found;
}

/// A cage is fitted to the patch of one boundary.
bool fits_cages(const FillOptions& options) {
  return options.output == Output::cage && options.islands.empty() && options.method != annulus_method;
}

/// Between boundaries the quads on a surface through the mesh's control points are a cage.
FillOptions with_quads_for_cages(FillOptions options) {
  if (options.output == Output::cage) options.output = Output::quads;
  return options;
}

/// A hole of a mesh near the origin.
Fill fill_as_it_is(const Mesh& mesh, const FillOptions& options) {
  FillContext context(mesh, options.rim, options);
  if (fits_cages(options))
    return std::move(
        fill_with_cages(context, {cage_rim_for(context, options.rim, options.corners, options)}, to_be_moved(options))[0]);
  const FillOptions of_faces = with_quads_for_cages(options);
  const auto filled = [&] { return fill_by_method(context, options.rim, options.corners, of_faces); };
  Fill fill = filled();
  Fill* const only = &fill;
  keep_clear(context, options, {&only, 1}, [&](std::size_t) { return filled(); });
  return fill;
}

/// With vertices of the rim merged that lie at one place; nothing where there are none, or where that leads to no fill.
std::optional<Fill> fill_merged(const Mesh& mesh, const FillOptions& options) {
  if (!options.rim || !takes_any_rim(options)) return {};
  std::vector<std::vector<Index>> rims = options.islands;
  rims.push_back(*options.rim);
  const MergedRims merged(mesh, rims, options);
  if (!merged.any()) return {};
  try {
    Fill fill = fill_as_it_is(merged.mesh(), merged.options());
    if (merged.bring_back(fill)) return fill;
  } catch (const Refusal&) {  // what is said of the mesh as it is, is said of vertices that its user sees
  }
  return {};
}

Fill fill_one_hole(const Mesh& mesh, const FillOptions& options) {
  const Stopwatch watch;
  check_for_holes(options);
  const std::span<const std::vector<Index>> given =
      options.rim ? std::span<const std::vector<Index>>(&*options.rim, 1) : std::span<const std::vector<Index>>();
  check_named(mesh, given, options.corners, options);
  if (const std::optional<Vec3> origin = local_origin(mesh, given)) {
    const Elsewhere near(mesh, options, *origin);
    Fill result = fill_one_hole({near.vertices, mesh.faces}, near.options);
    near.bring_back(result);
    return result;
  }
  std::optional<Fill> merged = fill_merged(mesh, options);
  Fill result = merged ? std::move(*merged) : fill_as_it_is(mesh, options);
  result.report.seconds = watch.seconds();
  return result;
}

Results fill_every_hole(const Mesh& mesh, const std::vector<std::vector<Index>>& rims, const FillOptions& options,
                        const std::vector<Corners>& corners, const Progress& progress, const Connectivity* connected = nullptr);

/// The same of every hole: those that it leads to no fill of are filled as they are.
Results fill_every_merged(const Mesh& mesh, const MergedRims& merged, const std::vector<std::vector<Index>>& rims,
                          const FillOptions& options, const std::vector<Corners>& corners, const Progress& progress) {
  std::vector<std::vector<Index>> merged_rims;
  std::vector<Corners> merged_corners;
  for (const std::vector<Index>& rim : rims) merged_rims.push_back(merged.merged(rim));
  for (const Corners& each : corners) merged_corners.push_back(merged.merged(each));
  Results results = fill_every_hole(merged.mesh(), merged_rims, merged.options(), merged_corners, progress);
  for (std::size_t k = 0; k < rims.size(); ++k) {
    Fill* const fill = std::get_if<Fill>(&results[k]);
    if (fill ? merged.bring_back(*fill) : merged_rims[k].size() == rims[k].size()) continue;
    FillOptions one = options;
    one.rim = rims[k];
    if (k < corners.size() && corners[k]) one.corners = corners[k];
    try {
      results[k] = fill_as_it_is(mesh, one);
    } catch (const CodedRefusal& refusal) {
      results[k] = refused(refusal);
    }
  }
  return results;
}

Results fill_every_hole(const Mesh& mesh, const std::vector<std::vector<Index>>& rims, const FillOptions& options,
                        const std::vector<Corners>& corners, const Progress& progress, const Connectivity* connected) {
  check_for_holes(options);
  check_named(mesh, rims, {}, options);
  for (const Corners& each : corners) check_named(mesh, {}, each, options);
  Results results(rims.size());
  if (rims.empty()) return results;
  if (const std::optional<Vec3> origin = local_origin(mesh, rims)) {
    const Elsewhere near(mesh, options, *origin);
    results = fill_every_hole({near.vertices, mesh.faces}, rims, near.options, corners, progress, connected);
    for (std::variant<Fill, Refused>& result : results)
      if (Fill* fill = std::get_if<Fill>(&result)) near.bring_back(*fill);
    return results;
  }
  if (takes_any_rim(options))
    if (const MergedRims merged(mesh, rims, options); merged.any())
      return fill_every_merged(mesh, merged, rims, options, corners, progress);
  std::optional<std::vector<Index>> only;
  if (rims.size() == 1) only = rims[0];
  FillContext context(mesh, only, options, connected);
  if (options.surroundings == SurroundingsFrom::mesh)
    context.planes = shared_planes(mesh, context.left, rims, fills_small(options) ? planes_of_small : nullptr);
  const auto report_progress = [&](std::size_t done) {
    if (progress) progress(done);
  };
  const auto corners_at = [&](std::size_t k) { return k < corners.size() ? corners[k] : Corners(); };
  if (fits_cages(options)) {
    std::vector<std::optional<SidedRim>> holes(rims.size());
    for (std::size_t k = 0; k < rims.size(); ++k) {
      try {
        holes[k] = cage_rim_for(context, rims[k], corners_at(k), options);
      } catch (const CodedRefusal& refusal) {
        results[k] = refused(refusal);
      }
    }
    fill_all_with_cages(context, holes, to_be_moved(options), results, progress);
    return results;
  }
  const FillOptions of_faces = with_quads_for_cages(options);
  const auto filled = [&](std::size_t k) { return fill_by_method(context, rims[k], corners_at(k), of_faces); };
  const auto fill_one = [&](std::size_t k) {
    const Stopwatch watch;
    try {
      Fill fill = filled(k);
      fill.report.seconds = watch.seconds();
      results[k] = std::move(fill);
    } catch (const CodedRefusal& refusal) {
      results[k] = refused(refusal);
    }
  };
  parallel_for_each(rims.size(), fill_one, report_progress);
  std::vector<Fill*> fills;
  std::vector<std::size_t> of;
  for (std::size_t k = 0; k < results.size(); ++k) {
    Fill* const fill = std::get_if<Fill>(&results[k]);
    if (!fill) continue;
    fills.push_back(fill);
    of.push_back(k);
  }
  keep_clear(context, options, fills, [&](std::size_t k) { return filled(of[k]); });
  return results;
}

/// What a report tells of each fill, whatever made it.
void complete_report(const Mesh& mesh, const FillOptions& options, Fill& fill) {
  list_used(mesh, options, fill);
  Report& report = fill.report;
  for (Message& said : told_of_not_taken(options, report.method)) report.warnings.push_back(std::move(said));
  report.not_applied.merge(not_applied(options, fill));
  const auto bulge = report.not_applied.find("bulge");
  const bool differs = std::ranges::any_of(options.bulge.values(), [](double each) { return each != 1; });
  if (options.bulge.values().size() > 1 && differs && bulge != report.not_applied.end() && bulge->second == "sides")
    report.warnings.push_back(
        {Code::options_need_smooth_sides, {{"options", std::vector<std::string>{"bulge"}}, {"method", report.method}}});
}

/// For each rim what is wrong with the mesh there; else nothing.
std::vector<std::optional<Message>> told_of_rims(const Mesh& mesh, std::span<const std::vector<Index>> rims) {
  std::vector<std::optional<Message>> told = told_of_near_duplicate_borders(mesh, rims), extra = told_of_extra_faces(mesh, rims);
  for (std::size_t k = 0; k < rims.size(); ++k)
    if (!told[k]) told[k] = std::move(extra[k]);
  return told;
}

}  // namespace

Fill fill(const Mesh& mesh, const FillOptions& options) {
  check_creases(mesh, options.subdivision.crease_edges);
  try {
    Fill result = fill_one_hole(mesh, options);
    complete_report(mesh, options, result);
    if (std::optional<Message> told = told_of_rims(mesh, {&result.rim, 1})[0]) result.report.warnings.push_back(std::move(*told));
    return result;
  } catch (const CodedRefusal& refusal) {
    const std::vector<Index> rim = options.rim ? *options.rim : refusal.where();
    const std::optional<Message> told = told_of_rims(mesh, {&rim, 1})[0];
    if (!told) throw;
    throw CodedRefusal(refusal.message(), {*told});
  }
}

std::vector<std::variant<Fill, Refused>> fill_all(const Mesh& mesh, const std::vector<std::vector<Index>>& rims,
                                                  const FillOptions& options,
                                                  const std::vector<std::optional<std::vector<Index>>>& corners,
                                                  const Progress& progress, const Connectivity* connected) {
  check_creases(mesh, options.subdivision.crease_edges);
  check_several(rims, options, corners);
  Results results = fill_every_hole(mesh, rims, options, corners, progress, connected);
  const std::vector<std::optional<Message>> told = told_of_rims(mesh, rims);
  for (std::size_t k = 0; k < results.size(); ++k) {
    Fill* const fill = std::get_if<Fill>(&results[k]);
    if (fill) complete_report(mesh, options, *fill);
    if (!told[k]) continue;
    if (fill)
      fill->report.warnings.push_back(*told[k]);
    else
      std::get<Refused>(results[k]).also.push_back(*told[k]);
  }
  return results;
}

}  // namespace tripatch
