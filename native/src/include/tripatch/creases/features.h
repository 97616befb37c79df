// Creases of the surroundings that end at the rim, and which of them continue across the hole.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "tripatch/creases/walls.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/mesh/connectivity.h"

namespace tripatch {

/// Of the hole's diameter: as far as creases are followed, and so over so many rings at most. Found as the shares in features.cpp: 46%, 0%
/// and 0%, 0%.
inline constexpr double crease_reach = share::most;
inline constexpr int max_crease_rings = count::rings;

/// A crease that ends at the rim.
struct CreaseEnd {
  Index place = 0;           ///< in the rim
  std::vector<Index> chain;  ///< vertices of the mesh along it, the rim's first
  Vec3 into;                 ///< unit: how it continues into the hole
  Vec3 left, right;          ///< unit normals of the faces on both sides, seen in that direction
  double angle = 0;          ///< radians between these, positive where they turn away from each other
};

/// Ends that belong together: two see each other across the hole, three or more meet at a point in it.
struct Crease {
  std::vector<CreaseEnd> ends;  ///< in the order of the rim
  Vec3 node;                    ///< where three or more meet
};

struct Features {
  std::optional<Walls> walls;                ///< where walls around the hole meet in it
  std::vector<Crease> creases;               ///< as their ends say, none crosses another
  std::vector<Index> vertices;               ///< of the surroundings that were looked at, sorted
  std::vector<std::array<Index, 2>> barred;  ///< their sharp edges, lower vertex first, sorted: surfaces end there

  /// Whether anything continues across the hole.
  bool found() const { return walls || !creases.empty(); }
};

/// Whether a crease or a wall ends at the rim: at most holes none does, which the faces next to it say.
bool may_have_features(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim);

/// rim: as new faces traverse it. An edge is sharp where its faces are 25 degrees or more apart, and three times as much as at
/// ordinary edges of the surroundings and at those next to it: smooth meshes, however coarse, and noisy ones have no crease.
Features find_features(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim);

}  // namespace tripatch
