// Walls around a hole, flat as those of a box or curved: where they continue until they meet, the hole is known, edges and corners with
// it; between flat ones exactly.
#pragma once

#include <array>
#include <map>
#include <numbers>
#include <optional>
#include <vector>

#include "tripatch/creases/wall_meeting.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/mesh/connectivity.h"

namespace tripatch {

/// Between the faces at a sharp edge at least, of the holes in features.cpp: the sides of a cylinder of 14 corners stay below it (-12%,
/// 127%; with 35 degrees 26%). Of 89 holes in scanned and modelled meshes, with edges of 15 degrees and more at the rim, half of it fills
/// one otherwise, 12% farther.
inline constexpr double min_crease_angle = radians(angle::crease);

/// Walls that close a hole, one or more. Corners are numbered: places in the rim, then nodes.
struct Walls {
  std::vector<Vec3> nodes;                ///< inside the hole
  std::vector<double> deviation;          ///< of the nodes, scene units
  std::vector<std::vector<Index>> parts;  ///< corners around each, as new faces traverse it
  std::map<std::array<Index, 2>, WallCrease>
      creases;                            ///< by corners, the lower first: steps around parts that are no edges of the rim
  std::vector<std::vector<Index>> faces;  ///< of the surroundings, for each part those of its wall
  bool are_flat = true;                   ///< all that were looked at
};

/// rim: as new faces traverse it, `across` in diameter. Walls are planes of the faces next to the rim, and a few of which no face is left,
/// as the edges of the rim tell them. None if there are too many planes, or they do not meet in the hole. None also if a wall seems to
/// have lost nothing, or a crease between two of them does not show at the rim, as an edge that ends there or as a corner of a third
/// wall. Of a flat rim one wall, which continues next to all or some of it and ends at the rest or near by, else none: a cap may lie
/// on it. Faces are sought among those whose vertices are all `near`, sorted. sharp: edges, the lower vertex first, sorted; with them, where
/// planes do not meet, walls are the smooth pieces between these edges. None if such a piece does not tell how it continues.
std::optional<Walls> find_walls(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim, double across,
                                const std::vector<Index>& near, const std::vector<std::array<Index, 2>>* sharp = nullptr);

/// Whether the rim is flat, and the faces next to it are walls that end there at an angle, each with the next or round a straight tube: what is
/// lost is another wall of the solid.
bool walls_end_at_flat_rim(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim, double across);

}  // namespace tripatch
