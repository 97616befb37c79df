// Triangles of a region in a plane, spread over a simpler one in which quads are laid out, and places carried back.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "tripatch/math/plane.h"
#include "tripatch/types.h"

namespace tripatch {

/// Triangles between the vertices of a plane region, spread over a convex one (Tutte 1963): no triangle is turned over there.
class SpreadTriangles {
public:
  /// count: of the vertices, the first of which are the rim; rim_at: places of these in the convex region, within the unit circle.
  SpreadTriangles(std::vector<std::array<Index, 3>> triangles, Index count, const PlanePoints& rim_at);

  /// Where a place lies among points that the triangles join, a row each: in the one that it is in, or least out of.
  Vec2 carried(const Vec2& place, const PlanePoints& to) const;

private:
  std::array<Index, 2> cell(const Eigen::RowVector2d& place) const;

  std::vector<std::array<Index, 3>> triangles_;
  Index cells_;
  PlanePoints at_;
  std::vector<std::vector<std::size_t>> in_cell_;
};

/// The same between two loops: spread over a cylinder, whose places are (turn, height), the turn up to whole numbers.
class SpreadRing {
public:
  /// points: the outer loop, the inner one, which runs against it, and what is inside, in a plane; ends_at: places of the loops' vertices on
  /// the cylinder, of heights 0 and 1.
  SpreadRing(const std::vector<std::array<Index, 3>>& triangles, const PlanePoints& points, const PlanePoints& ends_at);

  /// In the plane.
  Vec2 carried(const Vec2& place) const;

private:
  std::array<Vec2, 3> corners(const std::array<Index, 3>& triangle) const;

  std::vector<std::array<Index, 3>> triangles_;
  PlanePoints points_;
  Eigen::VectorXd turn_;  ///< of each point about the middle, in the plane
  PlanePoints at_;        ///< on the cylinder, the turns less those in the plane
};

}  // namespace tripatch
