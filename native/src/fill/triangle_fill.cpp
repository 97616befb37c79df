#include "tripatch/fill/triangle_fill.h"

#include <algorithm>
#include <numeric>
#include <optional>

#include "tripatch/constructions/methods.h"
#include "tripatch/fill/any_rim_fill.h"
#include "tripatch/fill/polygon_fill.h"
#include "tripatch/fill/spline_fill.h"
#include "tripatch/hole/sharp_sides.h"
#include "tripatch/math/linear.h"
#include "tripatch/math/parallel.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/messages.h"
#include "tripatch/output/cover.h"
#include "tripatch/output/quad_cover.h"
#include "tripatch/patch_from_sides.h"
#include "tripatch/report/folded_triangles.h"

namespace tripatch {

const char* method_between(const SidedRim& hole, const FillOptions& options) {
  if (!hole.is_triangle()) return polygon_method;
  return find_method(options.method == automatic_method ? patch_method : options.method).name;
}

void complete_report(const SidedRim& hole, const FillOptions& options, Report& report) {
  const bool automatic = options.method == automatic_method, three = hole.is_triangle();
  report.method = method_between(hole, options);
  if (automatic) report.method_reason = Message{three ? Code::has_smooth_sides : Code::has_sides, {{"count", hole.sides()}}};
  take_corners(hole.rim, hole.corners, report);
  tell_corners(report);
  tell_folds(report);
}

std::vector<double> sharp_sides_of(const FillContext& context, const Hole& hole) {
  const std::vector<double> from_first = sharp_sides(context.mesh, context.left, hole.rim, hole.corners);
  return {from_first[1], from_first[2], from_first[0]};  // side 2 begins at corner 0
}

namespace {

/// Edges of a rim from which on to cover the patch takes as long as to look at its rim, some 50 us, and a thread is worth what it costs.
constexpr std::size_t long_enough = count::many_places;

/// The patch; next to a limit surface, whose slopes ripple from vertex to vertex of a cage of triangles, that which bends least where the
/// fairest one folds: no surface of another kind can take its place there.
MadePatch patch_without_folds(const Sides& sides, const FillOptions& options) {
  MadePatch made = patch_from_sides(sides, options);
  if (options.surroundings == SurroundingsFrom::mesh || options.fairing != Fairing::automatic || made.report.folds == 0)
    return made;
  FillOptions least = options;
  least.fairing = Fairing::thin_plate;
  MadePatch other = patch_from_sides(sides, least);
  if (other.report.folds >= made.report.folds) return made;
  other.report.warnings.push_back({Code::fairest_folds_least_bending});
  return other;
}

/// The limit surface around a hole as a mesh of the points that a Subdivision modifier makes, and the rim in it.
struct FineCage {
  RefinedCage refined;
  std::vector<Index> rim;
};

FineCage fine_cage(const FillContext& context, const Hole& hole, const Subdivision& settings, const Points& border) {
  FineCage out{refine_cage(context.mesh, context.left, settings, hole.rim), {}};
  for (const std::vector<Index>& edge : out.refined.along_rim) out.rim.insert(out.rim.end(), edge.begin(), edge.end());
  for (std::size_t k = 0; k < out.rim.size(); ++k) out.refined.vertices.row(out.rim[k]) = border.row(static_cast<Index>(k));
  return out;
}

/// The surface of those points over a plane, as a mesh of its own as next to any limit surface; nothing where it folds too.
std::optional<Fill> fill_over_points(const FillContext& context, const Hole& hole, const FillOptions& options,
                                     const Surroundings& surroundings) {
  const FineCage fine = fine_cage(context, hole, options.subdivision, surroundings.border);
  const Mesh own{fine.refined.vertices, fine.refined.faces};
  SplineFillOptions how;
  how.quads = options.output == Output::quads;
  if (!how.quads) how.resolution = options.resolution;
  Fill fill = fill_with_spline(own, Connectivity(own), fine.rim, {}, how);
  if (!fill.patch || fill.report.triangles_folded > fill.report.rim_folded) return {};
  const Index n = context.mesh.vertices.rows(), there = own.vertices.rows(), b = surroundings.border.rows();
  std::vector<Index> place(there, -1);
  for (Index k = 0; k < b; ++k) place[fine.rim[k]] = k;
  const auto number = [&](Index v) { return n + (v < there ? place[v] : b + v - there); };
  for (Index& v : fill.faces.corners) v = number(v);
  for (auto& [from, to] : fill.feature_edges) from = number(from), to = number(to);
  fill.border.resize(b);
  std::iota(fill.border.begin(), fill.border.end(), Index{0});
  fill.vertices = stacked(surroundings.border, fill.vertices);
  fill.normals = stacked(fill.rim_normals, fill.normals);
  fill.uv = stacked(fill.rim_uv, fill.uv);
  fill.deviation = stacked(Eigen::VectorXd(Eigen::VectorXd::Zero(b)), fill.deviation);
  std::vector<Index> corner;  // the cage's own vertices among the border's
  for (Index k = 0; k < b; k += b / static_cast<Index>(hole.rim.size())) corner.push_back(k);
  fill.rim = hole.rim;
  fill.rim_normals = Points(fill.rim_normals(corner, Eigen::all));
  fill.rim_uv = PlanePoints(fill.rim_uv(corner, Eigen::all));
  Report& report = fill.report;
  report.method_reason = Message{Code::patch_folds_over, {{"count", 3}}};
  report.corners.clear();
  for (Index k : hole.corners) report.corners.push_back(hole.rim[k]);
  report.warnings.insert(report.warnings.begin(), surroundings.warnings.begin(), surroundings.warnings.end());
  report.warnings.push_back({Code::limit_planes_fold});
  return fill;
}

/// Next to a limit surface, where nothing was asked for that only a patch has.
bool may_follow_points(const FillOptions& options) {
  return options.surroundings == SurroundingsFrom::limit && options.method == automatic_method && options.replaced.empty() &&
         options.subdivision.use_limit_surface && !is_shaped_by_hand(options);
}

}  // namespace

TriangleInput triangle_input(const FillContext& context, Hole hole, const FillOptions& options) {
  check_counts(options, 3);
  TriangleInput out;
  const std::string method = options.method == automatic_method ? patch_method : options.method;
  const bool looks_for_sharp =
      options.surroundings == SurroundingsFrom::mesh && find_method(method).continuity != SeamContinuity::g0;
  out.angles = looks_for_sharp ? sharp_sides_of(context, hole) : std::vector<double>(3, 0.0);
  SideTerms terms = terms_of_sides(options.continuity, out.angles);
  std::copy(terms.alone.begin(), terms.alone.end(), hole.alone.begin());
  out.continuity = std::move(terms.continuity);
  out.surroundings =
      surroundings_of(context.mesh, context.whole(), context.left, hole,
                      options.surroundings == SurroundingsFrom::limit ? &options.subdivision : nullptr, context.planes);
  if (std::ranges::count(hole.alone, true) == 0) out.planes_error = out.surroundings.error;
  out.hole = std::move(hole);
  return out;
}

Fill fill_with_patch(const FillContext& context, const TriangleInput& input, const FillOptions& options) {
  const auto& [hole, angles, continuity, surroundings, planes_error] = input;
  const Mesh& mesh = context.mesh;
  FillOptions own = options;
  own.continuity = BySide<SideContinuity>(continuity);
  MadePatch made = patch_without_folds(surroundings.sides, own);
  if (made.report.folds > 0 && may_follow_points(options))
    if (std::optional<Fill> other = fill_over_points(context, hole, options, surroundings)) return std::move(*other);
  Fill fill;
  fill.patch = std::move(made.patch);
  fill.report = std::move(made.report);
  fill.sides.assign(surroundings.sides.begin(), surroundings.sides.end());

  const bool own_rim = surroundings.border.rows() > 0;
  Report& report = fill.report;
  Cover cover;
  const auto cover_it = [&] {
    cover = options.output == Output::quads
                ? cover_with_quads(mesh, hole, surroundings.parameters, *fill.patch, layout_options(options), own_rim)
                : cover_with_triangles(hole, surroundings.parameters, *fill.patch, options.resolution,
                                       own_rim ? nullptr : &context.left);
  };
  const auto look_at_rim = [&] {
    fill.rim = hole.rim;
    fill.rim_barycentric = rim_barycentric(hole, surroundings);
    fill.rim_normals = fill.patch->normals(fill.rim_barycentric);
    measure_seam(*fill.patch, surroundings.sides, report);
  };
  both_at_once(cover_it, look_at_rim,
               hole.rim.size() >= long_enough || options.output != Output::triangles || options.resolution.has_value());
  deliver(std::move(cover), surroundings.border, mesh.vertices.rows(), fill);
  const bool along_rim = options.output == Output::triangles && !own_rim;
  measure_faces(mesh, fill.vertices, fill.faces, faces_beyond(mesh, context.left, {hole.rim}), report,
                along_rim ? hole.rim : std::vector<Index>());
  report.surroundings_error = surroundings.error;
  report.warnings.insert(report.warnings.begin(), surroundings.warnings.begin(), surroundings.warnings.end());
  complete_report(hole, options, report);
  tell_sharp(angles, report.warnings);
  return fill;
}

}  // namespace tripatch
