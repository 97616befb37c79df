#include "tripatch/fill/cage_on_mesh.h"

#include <algorithm>
#include <map>
#include <string>

#include "tripatch/fill/any_rim_fill.h"
#include "tripatch/math/plane.h"
#include "tripatch/output/polygon_cover.h"
#include "tripatch/quads/quad_smoothing.h"
#include "tripatch/spline/plane_patch.h"
#include "tripatch/types.h"

namespace tripatch {
namespace {

/// Of 206 to 516 edges on balls, which cross as they are, three of five cages do not with these.
constexpr int sweeps = 20;

/// The fill of triangles, if it follows its surroundings without any reservation, but that it leaves out what meets it at an angle.
std::optional<Fill> followed(const Ground& ground, const std::vector<Index>& rim, const FillOptions& options) {
  FillOptions triangles;
  triangles.features = options.features;
  triangles.replaced = options.replaced;
  try {
    Fill fill = fill_any_rim(ground, rim, {}, triangles, "");
    const auto& warnings = fill.report.warnings;
    const auto reservations = std::ranges::count_if(warnings, [](const std::string& each) { return !is_of_sharp_sides(each); });
    if (reservations == 0 && dynamic_cast<const PlanePatch*>(fill.patch.get())) return fill;
  } catch (const Refusal&) {  // a cage needs less
  }
  return {};
}

}  // namespace

std::optional<OnMesh> cage_on_mesh(const Ground& ground, const SidedRim& hole, const CageHole& laid_out,
                                   const FillOptions& options, Smoothed smoothed) {
  const std::optional<Fill> fill = followed(ground, hole.rim, options);
  if (!fill) return {};
  std::map<Index, Index> row;
  for (std::size_t k = 0; k < fill->rim.size(); ++k) row[fill->rim[k]] = static_cast<Index>(k);
  const QuadLayout& layout = laid_out.layout;
  const std::vector<Index>& rim = laid_out.hole.rim;
  Points places = Points::Zero(layout.barycentric.rows(), 3), border(layout.rim, 3);
  for (std::size_t k = 0; k < rim.size(); ++k) {
    const auto of = [&](std::size_t j) { return fill->rim_uv.row(row.at(rim[j % rim.size()])); };
    const auto at = [&](std::size_t j) { return ground.mesh.vertices.row(rim[j % rim.size()]); };
    auto place = places.row(static_cast<Index>(k)).head<2>();
    auto point = border.row(static_cast<Index>(k));
    if (row.contains(rim[k])) {
      place = of(k);
      point = at(k);
    } else {  // in the middle of an edge that the layout splits
      place = (of(k + rim.size() - 1) + of(k + 1)) / 2;
      point = (at(k + rim.size() - 1) + at(k + 1)) / 2;
    }
  }
  spread_inside(layout.faces, layout.rim, places);
  PlaneLayout plane;
  plane.faces = layout.faces;
  plane.rim = layout.rim;
  plane.uv = places.leftCols(2);
  if (smoothed == Smoothed::in_plane) smooth_quads(plane, sweeps);
  if (smoothed == Smoothed::on_surface) smoothed_on(plane, *fill->patch, border);
  const Points on_plane = as_rows(PlanePoints(plane.uv.bottomRows(places.rows() - layout.rim)));
  const auto [points, normals] = fill->patch->positions_and_normals(on_plane);
  if (!points.allFinite() || !normals.allFinite()) return {};
  return OnMesh{points, normals, fill->report.deviation_max.value_or(0)};
}

}  // namespace tripatch
