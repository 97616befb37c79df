// Mixed differences of positions in a mesh of quads, wherever its rows continue.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "tripatch/mesh/connectivity.h"

namespace tripatch {

constexpr int max_difference_order = 3;  ///< of differences
/// Of differences of order 1, 2 and 3 along a row.
constexpr std::array<std::array<double, max_difference_order + 1>, max_difference_order> difference_weights = {
    {{-1, 1}, {1, -2, 1}, {-1, 3, -3, 1}}};

/// The sum of weights times positions of vertices.
using Difference = std::vector<std::pair<Index, double>>;

/// All of order 1, 2 or 3, along rows and across them, in a mesh: over blocks of as many quads each way, around whose inner vertices four
/// quads lie. Over blocks whose rows meet a pole in between, or a border, there is none.
std::vector<Difference> mixed_differences(const Connectivity& mesh, int order);

}  // namespace tripatch
