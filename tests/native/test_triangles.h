// What tests ask of lists of triangles.
#pragma once

#include <algorithm>

#include "tripatch/mesh/triangles.h"

namespace tripatch::testing {

inline bool has_edge(const Triangles& triangles, Index a, Index b) {
  return std::any_of(triangles.begin(), triangles.end(), [=](const std::array<Index, 3>& t) {
    return std::count(t.begin(), t.end(), a) && std::count(t.begin(), t.end(), b);
  });
}

}  // namespace tripatch::testing
