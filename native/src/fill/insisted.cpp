#include "tripatch/fill/insisted.h"

#include <algorithm>
#include <string>

#include "tripatch/constructions/methods.h"
#include "tripatch/fill/any_rim_fill.h"
#include "tripatch/output/shaped.h"
#include "tripatch/report/folded_triangles.h"

namespace tripatch {
namespace {

/// Edges that are folded in vain: where sides are met in position only, what is beyond meets them at whatever angle it has.
std::vector<std::array<Index, 2>> folds_of(const Ground& ground, const Fill& fill) {
  const bool at_angles =
      std::ranges::any_of(fill.report.continuity, [](const std::string& c) { return c == "Free" || c == "G0"; });
  const std::vector<FaceBeyond> beyond =
      at_angles ? std::vector<FaceBeyond>() : faces_beyond(ground.mesh, ground.left, {fill.rim});
  return folded_edges(ground.mesh.vertices, fill.vertices, fill.faces, beyond);
}

/// The vertices of the rim nearest to the folds, each once, as the folds are met.
std::vector<Index> beside(const Ground& ground, const Fill& fill, const std::vector<std::array<Index, 2>>& folds) {
  const PointsRef& vertices = ground.mesh.vertices;
  const Index n = vertices.rows();
  const auto at = [&](Index v) { return v < n ? Vec3(vertices.row(v)) : Vec3(fill.vertices.row(v - n)); };
  std::vector<Index> out;
  for (const auto& [a, b] : folds) {
    const Index near = nearest_of(vertices, fill.rim, 0.5 * (at(a) + at(b)));
    if (std::ranges::find(out, near) == out.end()) out.push_back(near);
  }
  return out;
}

std::string near_vertex(const std::vector<Index>& where) {
  return where.empty() ? "" : " near vertex " + std::to_string(where[0]) + " of the rim";
}

/// Whether somebody shapes the patch, or wants the method's own: which energy it has, or how its sides are met, does not count.
bool is_shaped_or_plain(FillOptions options) {
  options.continuity = FillOptions().continuity;
  if (options.fairing) options.fairing = Fairing::automatic;
  return is_shaped(options) || asks_for_sides(options);
}

}  // namespace

void refuse_if_insisted(const Ground& ground, const Fill& fill, const FillOptions& options) {
  if (options.method == automatic_method || is_shaped_or_plain(options)) return;
  const Report& report = fill.report;
  const bool as_a_whole = options.method == spline_method;
  const auto refuse = [&](const std::string& what, const std::vector<Index>& where) {
    const std::string others =
        as_a_whole || options.method == rows_method ? "the method auto" : "other corners, or the method auto";
    throw Refusal("A fill by " + options.method + " would " + what + "; choose " + others, where.empty() ? fill.rim : where);
  };
  if (report.triangles_folded > report.rim_folded) {
    const bool of_limit = options.output == Output::cage;  // folds are those of its limit surface, which has other faces
    const std::vector<std::array<Index, 2>> folds = folds_of(ground, fill);
    const Index count = of_limit ? report.triangles_folded : static_cast<Index>(folds.size());
    const std::vector<Index> where = beside(ground, fill, folds);
    if (count > report.rim_folded)
      refuse("fold over itself" + near_vertex(where) + (report.rim_folded > 0 ? " more often than its rim" : "") + ", at " +
                 std::to_string(count) + (count == 1 ? " edge" : " edges"),
             where);
  }
  if (report.crosses_itself && !as_a_whole) {
    std::vector<Index> where;
    if (const auto place = place_of_crossing(ground.mesh, fill.vertices, fill.faces))
      where.push_back(nearest_of(ground.mesh.vertices, fill.rim, *place));
    refuse("cross itself" + near_vertex(where), where);
  }
}

}  // namespace tripatch
