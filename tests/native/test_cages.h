// Cages that several tests use.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "tripatch/hole/hole.h"

namespace tripatch::testing {

/// Three grids of n x n quads around a vertex of valence 3, as at the corner of a cube, laid into the plane and raised by `height`,
/// without the 3 rings^2 quads in the middle.
struct CubeCorner {
  Points vertices;
  Faces faces;
  std::vector<Index> gone;  ///< of `whole`
  Faces whole;
  Hole hole;

  template <class F>
  CubeCorner(int n, int rings, const F& height) {
    std::map<std::array<int, 3>, Index> index;
    std::vector<Vec3> points;
    const auto vertex = [&](int axis, int a, int b) {
      std::array<int, 3> key = {0, 0, 0};
      key[axis] = a;
      key[(axis + 1) % 3] = b;
      const auto [place, fresh] = index.try_emplace(key, static_cast<Index>(points.size()));
      if (fresh) {
        Vec3 p = Vec3::Zero();
        for (int k = 0; k < 3; ++k)
          p += key[k] * Vec3(std::cos(2 * std::numbers::pi * k / 3), std::sin(2 * std::numbers::pi * k / 3), 0);
        p[2] = height(p[0], p[1]);
        points.push_back(p);
      }
      return place->second;
    };
    for (int axis = 0; axis < 3; ++axis)
      for (int a = 0; a < n; ++a)
        for (int b = 0; b < n; ++b) {
          const std::array<Index, 4> quad = {vertex(axis, a, b), vertex(axis, a + 1, b), vertex(axis, a + 1, b + 1),
                                             vertex(axis, a, b + 1)};
          if (std::max(a, b) < rings) gone.push_back(whole.size());
          if (std::max(a, b) >= rings) faces.add(quad);
          whole.add(quad);
        }
    vertices.resize(static_cast<Index>(points.size()), 3);
    for (std::size_t k = 0; k < points.size(); ++k) vertices.row(static_cast<Index>(k)) = points[k];
    const std::vector<std::vector<Index>> loops = find_holes(faces);
    const auto rim = std::find_if(loops.begin(), loops.end(), [&](const auto& loop) { return loop.size() == 6U * rings; });
    hole =
        make_hole(mesh(), *rim, std::array<Index, 3>{vertex(0, rings, rings), vertex(1, rings, rings), vertex(2, rings, rings)});
  }
  Mesh mesh() const { return {vertices, faces}; }
};

}  // namespace tripatch::testing
