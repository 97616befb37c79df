#include "tripatch/cage_fills/cage_inside.h"

#include <algorithm>
#include <map>
#include <vector>

#include "tripatch/fill/any_rim_fill.h"
#include "tripatch/fill/rows_fill.h"
#include "tripatch/fill/select.h"
#include "tripatch/grid/quad_rows.h"
#include "tripatch/hole/rim_shape.h"
#include "tripatch/math/plane.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/messages.h"
#include "tripatch/quads/quad_smoothing.h"
#include "tripatch/quads/spread.h"
#include "tripatch/spline/plane_patch.h"
#include "tripatch/types.h"

namespace tripatch {
namespace {

/// Of 206 to 516 edges on balls, which cross as they are, three of five cages do not with these.
constexpr int sweeps = count::sweeps;

/// The fill of triangles, if it follows its surroundings without any reservation, but that it leaves out what meets it at an angle.
std::optional<Fill> followed(const FillContext& context, const std::vector<Index>& rim, const FillOptions& options) {
  FillOptions triangles;
  triangles.features = options.features;
  triangles.replaced = options.replaced;
  try {
    Fill fill = fill_any_rim(context, rim, {}, triangles);
    const auto& warnings = fill.report.warnings;
    const auto reservations = std::ranges::count_if(warnings, [](const Message& each) { return each.code != Code::sharp_sides; });
    if (reservations == 0 && dynamic_cast<const PlanePatch*>(fill.patch.get())) return fill;
  } catch (const CodedRefusal&) {  // a cage needs less
  }
  return {};
}

/// Rows of the layout of a block, as long as its rim's first side, up to the one opposite; empty where its faces are no such rows. first: of
/// the rim's first side.
std::vector<std::vector<Index>> rows_of_layout(const QuadLayout& layout, const std::vector<Index>& first, Index count) {
  const Connectivity faces(layout.faces, layout.barycentric.rows());
  std::vector<std::vector<Index>> rows = {{first.rbegin(), first.rend()}};  // as faces beyond it would traverse it
  while (static_cast<Index>(rows.size()) <= count) {
    std::vector<Index> next = row_beyond(faces, rows.back());
    if (next.empty()) return {};
    rows.push_back(std::move(next));
  }
  return rows;
}

/// The new vertices of a block in the order of a layout.
std::optional<Points> as_laid_out(const Fill& block, const CageHole& laid_out) {
  const QuadLayout& layout = laid_out.layout;
  const Index r = layout.rim, inside = layout.barycentric.rows() - r;
  if (layout.faces.size() != block.faces.size() || inside != block.vertices.rows()) return {};
  const std::vector<Index>& rim = laid_out.hole.rim;
  const Index from = std::ranges::find(rim, block.rim[0]) - rim.begin();
  const auto place = [&](std::size_t corner) {
    return std::ranges::find(block.rim, block.report.corners[corner]) - block.rim.begin();
  };
  const Index n = place(1), m = place(2) - n;
  std::vector<Index> first;
  for (Index i = 0; i <= n; ++i) first.push_back((from + i) % r);
  const std::vector<std::vector<Index>> rows = rows_of_layout(layout, first, m);
  if (rows.empty()) return {};
  Points points(inside, 3);
  for (Index i = 1; i < n; ++i)
    for (Index j = 1; j < m; ++j) {
      const Index at = rows[static_cast<std::size_t>(j)][static_cast<std::size_t>(n - i)] - r;
      if (at < 0) return {};
      points.row(at) = block.vertices.row((i - 1) * (m - 1) + j - 1);
    }
  return points;
}

/// Whether a surface around the rows is expected to be more accurate.
bool surface_tells_more(const FillContext& context, const Fill& rows, double error, double size,
                        const std::vector<Index>& replaced) {
  if (is_negligible(error, size)) return false;
  try {
    FillOptions triangles;
    triangles.replaced = replaced;
    const Fill surface = fill_any_rim(context, rows.rim, {}, triangles);
    return is_harmless(surface.report) && expected_error(surface, size) < error;
  } catch (const CodedRefusal&) {
    return false;
  }
}

}  // namespace

std::optional<OnMesh> cage_on_mesh(const FillContext& context, const SidedRim& hole, const CageHole& laid_out,
                                   const FillOptions& options, Smoothed smoothed) {
  const std::optional<Fill> fill = followed(context, hole.rim, options);
  if (!fill) return {};
  std::map<Index, Index> row;
  for (std::size_t k = 0; k < fill->rim.size(); ++k) row[fill->rim[k]] = static_cast<Index>(k);
  const QuadLayout& layout = laid_out.layout;
  const std::vector<Index>& rim = laid_out.hole.rim;
  Points places = Points::Zero(layout.barycentric.rows(), 3), border(layout.rim, 3);
  for (std::size_t k = 0; k < rim.size(); ++k) {
    const auto of = [&](std::size_t j) { return fill->rim_uv.row(row.at(rim[j % rim.size()])); };
    const auto at = [&](std::size_t j) { return context.mesh.vertices.row(rim[j % rim.size()]); };
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
  return OnMesh{points, normals, fill->report.deviation_max.value_or(0), expected_error(*fill, diameter(context.mesh, hole.rim))};
}

std::variant<InRows, Code> cage_in_rows(const FillContext& context, const CageHole& laid_out,
                                        const std::vector<Index>& replaced) {
  const std::vector<Index>& rim = laid_out.hole.rim;
  const Index known = context.mesh.vertices.rows();
  // no row continues at the middle of an edge that the cage splits, and the mesh has no such vertex
  if (std::ranges::any_of(rim, [&](Index v) { return v >= known; })) return Code::rows_do_not_continue;
  try {
    const bool is_block = quad_rows(context.left, rim).has_value();
    const std::optional<Fill> fill = is_block ? fill_with_rows(context, rim, Output::quads, false)
                                              : fill_with_rows_over(context, rim, laid_out.layout, Output::quads, false);
    if (!fill || !is_harmless(fill->report)) return Code::rows_do_not_continue;
    std::optional<Points> points = is_block ? as_laid_out(*fill, laid_out) : fill->vertices;
    if (!points) return Code::rows_do_not_continue;
    const double size = diameter(context.mesh, fill->rim), error = expected_error(*fill, size);
    if (surface_tells_more(context, *fill, error, size, replaced)) return Code::surface_tells_more;
    return InRows{std::move(*points), error};
  } catch (const CodedRefusal&) {  // another way may be open
    return Code::rows_do_not_continue;
  }
}

}  // namespace tripatch
