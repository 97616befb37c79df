#include "tripatch/fill/cage_in_rows.h"

#include <algorithm>
#include <vector>

#include "tripatch/fill/any_rim_fill.h"
#include "tripatch/fill/rows_fill.h"
#include "tripatch/grid/quad_rows.h"

namespace tripatch {
namespace {

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

bool surface_tells_more(const Ground& ground, const Fill& rows, const std::vector<Index>& replaced) {
  if (are_sure(ground.mesh, rows)) return false;
  try {
    FillOptions triangles;
    triangles.replaced = replaced;
    return !rows_are_nearer(ground.mesh, rows, fill_any_rim(ground, rows.rim, {}, triangles, ""));
  } catch (const Refusal&) {
    return false;
  }
}

}  // namespace

std::optional<Points> cage_in_rows(const Ground& ground, const CageHole& laid_out, const std::vector<Index>& replaced) {
  const std::vector<Index>& rim = laid_out.hole.rim;
  const Index known = ground.mesh.vertices.rows();
  // no row goes on at the middle of an edge that the cage splits, and the mesh has no such vertex
  if (std::ranges::any_of(rim, [&](Index v) { return v >= known; })) return {};
  try {
    const bool is_block = quad_rows(ground.left, rim).has_value();
    const std::optional<Fill> fill = is_block ? fill_with_rows(ground, rim, Output::quads, false)
                                              : fill_with_rows_over(ground, rim, laid_out.layout, Output::quads, false);
    if (!fill || !is_harmless(fill->report)) return {};
    std::optional<Points> points = is_block ? as_laid_out(*fill, laid_out) : fill->vertices;
    return points && surface_tells_more(ground, *fill, replaced) ? std::nullopt : std::move(points);
  } catch (const Refusal&) {  // another way may be open
    return {};
  }
}

}  // namespace tripatch
