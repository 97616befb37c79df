// Quads from pairs of triangles.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "tripatch/types.h"

namespace tripatch {

/// As in Blender's Tris to Quads, whose defaults these are.
struct PairQuadsOptions {
  double largest_fold = 40;    ///< degrees between the normals of the two triangles
  double largest_corner = 40;  ///< degrees by which a corner of a quad may differ from a right angle
  /// The same of corners that are not between two edges of the border, where the quads will be smoothed; none: as of the others.
  std::optional<double> largest_free_corner = {};
};

/// Joins triangles by twos into quads where these are good: the best pairs first, then triangles left over change partners where
/// that makes one pair more. No edge of `kept` (pairs of rows of the points) goes. Returns quads and the triangles left, each in
/// the place of its first triangle, with its direction; quads begin at an end of the edge that is gone. points: n x 3. The same input
/// gives the same faces.
Faces pair_quads(const PointsRef& points, const std::vector<std::array<Index, 3>>& triangles,
                 const PairQuadsOptions& options = {}, const std::vector<std::array<Index, 2>>& kept = {});

}  // namespace tripatch
