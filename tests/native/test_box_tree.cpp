// A tree of boxes finds those that each of them meets by itself.
#include <algorithm>
#include <catch2/catch.hpp>
#include <random>
#include <vector>

#include "tripatch/math/box_tree.h"

using namespace tripatch;

namespace {

std::vector<BoxTree::Box> some_boxes(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<> place(0, 1), size(0, 0.2);
  std::vector<BoxTree::Box> boxes;
  for (int k = 0; k < count; ++k) {
    const Eigen::Vector3d low(place(random), place(random), place(random));
    boxes.emplace_back(low, low + Eigen::Vector3d(size(random), size(random), size(random)));
  }
  return boxes;
}

}  // namespace

TEST_CASE("a tree of boxes finds those that meet another one, and no other", "[box_tree]") {
  const int count = GENERATE(0, 1, 4, 5, 300);
  const std::vector<BoxTree::Box> boxes = some_boxes(count, 1);
  const BoxTree tree(boxes);
  for (const BoxTree::Box& asked : some_boxes(50, 2)) {
    std::vector<std::size_t> found, expected;
    tree.each_meeting(asked, [&](std::size_t k) { found.push_back(k); });
    std::sort(found.begin(), found.end());
    for (std::size_t k = 0; k < boxes.size(); ++k)
      if (boxes[k].intersects(asked)) expected.push_back(k);
    CHECK(found == expected);
  }
}

TEST_CASE("boxes at one place are all found", "[box_tree]") {
  const BoxTree tree(std::vector<BoxTree::Box>(100, BoxTree::Box(Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones())));
  std::size_t found = 0;
  tree.each_meeting(BoxTree::Box(Eigen::Vector3d::Constant(0.5)), [&](std::size_t) { ++found; });
  CHECK(found == 100);
}
