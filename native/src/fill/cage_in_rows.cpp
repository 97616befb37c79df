#include "tripatch/fill/cage_in_rows.h"

#include <algorithm>
#include <map>
#include <vector>

#include "tripatch/fill/any_rim_fill.h"
#include "tripatch/fill/rows_fill.h"
#include "tripatch/grid/quad_rows.h"
#include "tripatch/hole/rim_checks.h"

namespace tripatch {
namespace {

/// Rows of the layout's vertices, from the rim's first side to the one opposite; empty where its faces are no such rows. first: of the
/// rim's first side.
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

bool surface_tells_more(const Ground& ground, const Fill& rows) {
  if (are_sure(ground.mesh, rows)) return false;
  try {
    return !rows_are_nearer(rows, fill_any_rim(ground, rows.rim, {}, FillOptions(), ""));
  } catch (const Refusal&) {
    return false;
  }
}

}  // namespace

std::optional<Points> cage_in_rows(const Ground& ground, const SidedRim& hole, const CageHole& laid_out) {
  const QuadLayout& layout = laid_out.layout;
  std::optional<Fill> fill;
  try {
    fill = fill_with_rows(ground, check_topology(ground.left, hole.rim), Output::quads);
  } catch (const Refusal&) {  // another way may be open
  }
  if (!fill || !is_harmless(fill->report) || layout.faces.size() != fill->faces.size()) return {};
  std::map<Index, Index> row;  // of the layout
  for (std::size_t k = 0; k < laid_out.hole.rim.size(); ++k) row[laid_out.hole.rim[k]] = static_cast<Index>(k);
  const auto corner = [&](std::size_t k) { return std::ranges::find(fill->rim, fill->report.corners[k]) - fill->rim.begin(); };
  const Index n = corner(1), m = corner(2) - n;
  std::vector<Index> first;
  for (Index i = 0; i <= n; ++i) {
    const auto at = row.find(fill->rim[static_cast<std::size_t>(i)]);
    if (at == row.end()) return {};
    first.push_back(at->second);
  }
  const std::vector<std::vector<Index>> rows = rows_of_layout(layout, first, m);
  const Index inside = layout.barycentric.rows() - layout.rim;
  if (rows.empty() || inside != fill->vertices.rows() || surface_tells_more(ground, *fill)) return {};
  Points points(inside, 3);
  for (Index i = 1; i < n; ++i)
    for (Index j = 1; j < m; ++j) {
      const Index at = rows[static_cast<std::size_t>(j)][static_cast<std::size_t>(n - i)] - layout.rim;
      if (at < 0) return {};
      points.row(at) = fill->vertices.row((i - 1) * (m - 1) + j - 1);
    }
  return points;
}

}  // namespace tripatch
