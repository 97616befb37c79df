#include "tripatch/fill/triangle_fill.h"

#include <algorithm>

#include "tripatch/boundary/surroundings.h"
#include "tripatch/constructions/methods.h"
#include "tripatch/fill/polygon_fill.h"
#include "tripatch/hole/sharp_sides.h"
#include "tripatch/output/cover.h"
#include "tripatch/output/quad_cover.h"
#include "tripatch/patch_from_sides.h"
#include "tripatch/report/folded_triangles.h"

namespace tripatch {

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

std::vector<double> sharp_sides_of(const Ground& ground, const Hole& hole) {
  const std::vector<double> from_first = sharp_sides(ground.mesh, ground.left, hole.rim, hole.corners);
  return {from_first[1], from_first[2], from_first[0]};  // side 2 begins at corner 0
}

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
  Cover cover = options.output == Output::quads
                    ? cover_with_quads(mesh, hole, surroundings.parameters, *fill.patch, layout_options(options), own_rim)
                    : cover_with_triangles(hole, surroundings.parameters, *fill.patch, options.resolution,
                                           own_rim ? nullptr : &ground.left);
  deliver(std::move(cover), surroundings.border, mesh.vertices.rows(), fill);
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

}  // namespace tripatch
