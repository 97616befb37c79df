#include "tripatch/grid/quad_rows.h"

#include <algorithm>

namespace tripatch {
namespace {

/// Places of the rim where three faces meet, as rows turn there; none where not all is known.
std::vector<Index> corners_of_rows(const Connectivity& around, const std::vector<Index>& rim) {
  std::vector<Index> corners;
  for (std::size_t k = 0; k < rim.size(); ++k) {
    if (!around.knows(rim[k])) return {};
    if (around.at(rim[k]).size() == 3) corners.push_back(static_cast<Index>(k));
  }
  return corners;
}

}  // namespace

std::vector<Index> row_beyond(const Connectivity& around, const std::vector<Index>& row) {
  std::vector<Index> next(row.size(), -1);
  for (std::size_t k = 0; k + 1 < row.size(); ++k) {
    if (!around.knows(row[k]) || !around.knows(row[k + 1])) return {};
    const std::optional<Connectivity::Corner> corner = around.edge(row[k + 1], row[k]);
    if (!corner) return {};
    const IndicesRef face = around.faces()[around.face(*corner)];
    if (face.size() != 4) return {};
    const Index place = around.place(*corner);
    const Index beyond_this = face[(place + 2) % 4], beyond_next = face[(place + 3) % 4];
    if (next[k] >= 0 && next[k] != beyond_this) return {};
    next[k] = beyond_this;
    next[k + 1] = beyond_next;
  }
  return next;
}

std::vector<std::array<Index, 2>> QuadRows::outermost(int side) const {
  std::vector<std::array<Index, 2>> places;
  const int along = side < 2 ? 1 : 0;
  const Index across = side % 2 == 0 ? first(1 - along) : last(1 - along);
  for (Index k = first(along); k <= last(along); ++k)
    places.push_back(along == 0 ? std::array{k, across} : std::array{across, k});
  if (side == 0 || side == 3) std::reverse(places.begin(), places.end());
  return places;
}

void QuadRows::grow(const Connectivity& around, int side) {
  if (beyond_[side] == max_beyond) return;
  const std::vector<std::array<Index, 2>> places = outermost(side);
  std::vector<Index> row;
  for (const auto& [i, j] : places) row.push_back(at(i, j));
  const std::vector<Index> next = row_beyond(around, row);
  if (next.empty()) return;
  const std::array<Index, 2> step = {side == 0 ? -1 : side == 1 ? 1 : 0, side == 2 ? -1 : side == 3 ? 1 : 0};
  for (std::size_t k = 0; k < places.size(); ++k)
    vertex_(places[k][0] + step[0] + max_beyond, places[k][1] + step[1] + max_beyond) = next[k];
  ++beyond_[side];
}

std::optional<QuadRows> quad_rows(const Connectivity& around, const std::vector<Index>& rim) {
  const std::vector<Index> corners = corners_of_rows(around, rim);
  if (corners.size() != 4) return {};
  const Index edges = static_cast<Index>(rim.size());
  const auto length = [&](std::size_t k) { return (corners[(k + 1) % 4] - corners[k] + edges) % edges; };
  if (length(0) != length(2) || length(1) != length(3)) return {};
  QuadRows rows(length(0), length(1));
  Index place = corners[0];
  for (int side : {2, 1, 3, 0}) {
    const std::vector<std::array<Index, 2>> along = rows.outermost(side);
    for (std::size_t k = 0; k + 1 < along.size(); ++k, ++place)
      rows.vertex_(along[k][0] + QuadRows::max_beyond, along[k][1] + QuadRows::max_beyond) = rim[place % edges];
  }
  for (Index round = 0; round < QuadRows::max_beyond; ++round)
    for (int side = 0; side < 4; ++side) rows.grow(around, side);
  if (rows.beyond() == std::array<Index, 4>{0, 0, 0, 0}) return {};
  return rows;
}

}  // namespace tripatch
