#include "tripatch/math/box_tree.h"

#include <algorithm>
#include <numeric>

namespace tripatch {

BoxTree::BoxTree(std::vector<Box> boxes) : order_(boxes.size()) {
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  if (boxes.empty()) return;
  build(boxes, 0, boxes.size());
  boxes_.reserve(boxes.size());
  for (const std::size_t k : order_) boxes_.push_back(boxes[k]);
}

/// Halves boxes across their longest side until few are left.
std::size_t BoxTree::build(const std::vector<Box>& boxes, std::size_t first, std::size_t end) {
  const std::size_t at = nodes_.size();
  Box around;
  for (std::size_t k = first; k < end; ++k) around.extend(boxes[order_[k]]);
  nodes_.push_back({around, first, end});
  if (end - first <= few) return at;
  Eigen::Index axis = 0;
  around.sizes().maxCoeff(&axis);
  const std::size_t middle = (first + end) / 2;
  const auto place = [&](std::size_t k) { return boxes[k].min()[axis] + boxes[k].max()[axis]; };
  const auto begin = order_.begin();
  std::nth_element(begin + static_cast<std::ptrdiff_t>(first), begin + static_cast<std::ptrdiff_t>(middle),
                   begin + static_cast<std::ptrdiff_t>(end), [&](std::size_t a, std::size_t b) { return place(a) < place(b); });
  build(boxes, first, middle);
  const std::size_t second = build(boxes, middle, end);
  nodes_[at].second = second;
  return at;
}

}  // namespace tripatch
