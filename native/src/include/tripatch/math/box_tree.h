// Boxes in a tree: which of many meet another one.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <vector>

#include "tripatch/math/thresholds.h"

namespace tripatch {

class BoxTree {
public:
  using Box = Eigen::AlignedBox3d;

  explicit BoxTree(std::vector<Box> boxes);

  /// Calls take(number of the box) for each that meets a box.
  template <class Take>
  void each_meeting(const Box& box, const Take& take) const {
    std::array<std::size_t, max_depth> open;
    std::size_t count = 0;
    if (!nodes_.empty()) open[count++] = 0;
    while (count > 0) {
      const std::size_t at = open[--count];
      const Node& node = nodes_[at];
      if (!node.box.intersects(box)) continue;
      if (node.second > 0) {
        open[count++] = at + 1;
        open[count++] = node.second;
        continue;
      }
      for (std::size_t k = node.first; k < node.end; ++k)
        if (boxes_[k].intersects(box)) take(order_[k]);
    }
  }

private:
  static constexpr std::size_t few = count::several,
                               max_depth = count::many_places;  // each node has half the boxes of the one above it
  struct Node {
    Box box;
    std::size_t first, end, second = 0;  // the nodes after this one, and that; 0: a leaf
  };

  std::size_t build(const std::vector<Box>& boxes, std::size_t first, std::size_t end);

  std::vector<Box> boxes_;  // in the order of the leaves
  std::vector<std::size_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace tripatch
