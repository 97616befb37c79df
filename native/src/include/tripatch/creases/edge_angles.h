// How sharp the edges around a hole are: which of them are creases, and which are only those of a coarse or noisy mesh.
#pragma once

#include <array>
#include <numbers>
#include <utility>
#include <vector>

#include "tripatch/mesh/connectivity.h"

namespace tripatch {

/// Between the faces at a sharp edge at least, of the holes in features.cpp: the sides of a cylinder of 14 corners stay below it (-12%,
/// 127%; with 35 degrees 26%). Of 89 holes in scanned and modelled meshes, with edges of 15 degrees and more at the rim, half of it fills
/// one otherwise, 12% farther.
inline constexpr double least_crease_angle = 25 * std::numbers::pi / 180;

Vec3 face_normal(const Mesh& mesh, Index face);

/// The angles at the edges of the surroundings. An edge is sharp where its faces are 25 degrees or more apart, and three times as much
/// as at ordinary edges around: smooth meshes, however coarse, and noisy ones have no crease.
class EdgeAngles {
public:
  /// So many times what ordinary edges have: noise of a tenth of an edge, and coarse triangles of anything round, stay below that (-2%,
  /// 29%, as the shares in features.cpp).
  static constexpr double above_noise = 3;
  /// Faces whose ordinary edges have less are smooth (40%, 0%).
  static constexpr double smooth_angle = 5 * std::numbers::pi / 180;

  /// Of all edges at the vertices, sorted.
  EdgeAngles(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& vertices);

  /// -1 where the edge has not two faces, or lies farther off.
  double at(Index a, Index b) const;
  /// What three quarters of the edges stay below.
  double ordinary() const { return ordinary_; }
  bool sharp(Index a, Index b) const;
  /// Whether ordinary edges turn so much that not all of 25 degrees are sharp.
  bool are_rough() const { return threshold_ > least_crease_angle; }
  /// Whether a crease that is sharp at the rim continues at an edge.
  bool still_sharp(Index a, Index b) const;
  /// Lower vertex first, sorted.
  std::vector<std::array<Index, 2>> all_sharp() const;

private:
  std::vector<std::pair<std::array<Index, 2>, double>> edges_;
  double ordinary_ = 0, threshold_ = least_crease_angle;
};

}  // namespace tripatch
