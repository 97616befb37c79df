#include "tripatch/quads/row_widths.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "tripatch/math/interruption.h"

namespace tripatch {

RowWidths::RowWidths(const Faces& faces, Index rim) : rim_(rim), edge_(faces.corners.size()) {
  check_interruption();
  const Index vertices = faces.corners.empty() ? 0 : *std::ranges::max_element(faces.corners) + 1;
  std::vector<Index> newest(vertices, -1), before;  // edges by their lower vertex, each with the one before it
  for (Index f = 0; f < faces.size(); ++f)
    for (std::size_t k = 0, m = faces[f].size(); k < m; ++k) {
      const auto [low, high] = std::minmax(faces[f][k], faces[f][(k + 1) % m]);
      Index e = newest[low];
      while (e >= 0 && edges_[e][1] != high) e = before[e];
      if (e < 0) {
        e = static_cast<Index>(edges_.size());
        edges_.push_back({low, high});
        before.push_back(newest[low]);
        newest[low] = e;
      }
      edge_[faces.offsets[f] + static_cast<Index>(k)] = e;
    }
  row_.resize(edges_.size());
  std::iota(row_.begin(), row_.end(), Index{0});
  const auto find = [&](Index e) {
    while (row_[e] != e) e = row_[e] = row_[row_[e]];
    return e;
  };
  for (Index f = 0; f < faces.size(); ++f)
    for (Index k = faces.offsets[f]; faces[f].size() == 4 && k < faces.offsets[f] + 2; ++k)
      row_[find(edge_[k])] = find(edge_[k + 2]);
  for (Index& row : row_) row = find(row);
}

void RowWidths::measure(const Points& positions, std::optional<double> round) {
  std::vector<double> sum(edges_.size(), 0), all(edges_.size(), 0);
  std::vector<Index> ends(edges_.size(), 0), edges(edges_.size(), 0);
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    const auto [a, b] = edges_[e];
    const double length = (positions.row(a) - positions.row(b)).norm();
    const Index row = row_[e];
    all[row] += length;
    ++edges[row];
    if (b >= rim_ || (b - a != 1 && b - a != rim_ - 1)) continue;
    sum[row] += std::log(length);
    ++ends[row];
  }
  width_.assign(edges_.size(), 0);
  for (std::size_t row = 0; row < edges_.size(); ++row) {
    if (ends[row] > 0)
      width_[row] = std::exp(sum[row] / static_cast<double>(ends[row]));
    else if (edges[row] > 0)
      width_[row] = round.value_or(all[row] / static_cast<double>(edges[row]));
  }
}

}  // namespace tripatch
