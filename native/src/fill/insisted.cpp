#include "tripatch/fill/insisted.h"

#include <algorithm>

#include "tripatch/constructions/methods.h"
#include "tripatch/fill/any_rim_fill.h"
#include "tripatch/messages.h"
#include "tripatch/output/shaped.h"
#include "tripatch/report/dihedrals.h"
#include "tripatch/report/folded_triangles.h"

namespace tripatch {
namespace {

/// Edges that are folded avoidably: where sides are met in position only, what is beyond meets them at whatever angle it has.
std::vector<std::array<Index, 2>> folds_of(const FillContext& context, const Fill& fill) {
  const bool at_angles = std::ranges::any_of(fill.report.continuity, in_position);
  const std::vector<AdjacentFace> beyond =
      at_angles ? std::vector<AdjacentFace>() : faces_beyond(context.mesh, context.left, {fill.rim});
  return folded_edges(context.mesh.vertices, fill.vertices, fill.faces, beyond);
}

/// The vertices of the rim nearest to the folds, each once, as the folds are met.
std::vector<Index> beside(const FillContext& context, const Fill& fill, const std::vector<std::array<Index, 2>>& folds) {
  const PointsRef& vertices = context.mesh.vertices;
  const auto at = [&](Index v) { return place_of(context.mesh, fill, v); };
  std::vector<Index> out;
  for (const auto& [a, b] : folds) {
    const Index near = nearest_of(vertices, fill.rim, 0.5 * (at(a) + at(b)));
    if (std::ranges::find(out, near) == out.end()) out.push_back(near);
  }
  return out;
}

/// The first of the vertices that are near a defect, if there are any.
std::vector<Index> first_of(const std::vector<Index>& where) { return where.empty() ? where : std::vector<Index>{where[0]}; }

/// Whether somebody shapes the patch, or wants the method's own: which energy it has, or how its sides are met, does not count.
bool is_shaped_or_plain(FillOptions options) {
  options.continuity = FillOptions().continuity;
  if (options.fairing) options.fairing = Fairing::automatic;
  return is_shaped(options) || asks_for_sides(options);
}

}  // namespace

void refuse_if_insisted(const FillContext& context, const Fill& fill, const FillOptions& options) {
  if (options.method == automatic_method || is_shaped_or_plain(options)) return;
  const Report& report = fill.report;
  const bool as_a_whole = options.method == spline_method;
  const auto refuse = [&](Code code, const std::vector<Index>& where, Index edges) {
    std::vector<Parameter> parameters = {{"method", options.method}, {"near", first_of(where)}, {"edges", edges}};
    if (!as_a_whole && options.method != rows_method) parameters.push_back({"sided", ""});
    throw CodedRefusal(code, std::move(parameters), where.empty() ? fill.rim : where);
  };
  if (report.triangles_folded > report.rim_folded) {
    const bool of_limit = options.output == Output::cage;  // folds are those of its limit surface, which has other faces
    const std::vector<std::array<Index, 2>> folds = folds_of(context, fill);
    const Index count = of_limit ? report.triangles_folded : static_cast<Index>(folds.size());
    const std::vector<Index> where = beside(context, fill, folds);
    if (count > report.rim_folded)
      refuse(report.rim_folded > 0 ? Code::method_folds_more_than_rim : Code::method_folds, where, count);
  }
  if (report.crosses_itself && !as_a_whole) {
    std::vector<Index> where;
    if (const auto place = place_of_crossing(context.mesh, fill.vertices, fill.faces))
      where.push_back(nearest_of(context.mesh.vertices, fill.rim, *place));
    refuse(Code::method_crosses, where, 0);
  }
}

}  // namespace tripatch
