// Vertices inside a loop spread evenly: those of layouts, and those of triangles, over a simpler region in which quads are laid out.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "tripatch/math/plane.h"
#include "tripatch/quads/quad_smoothing.h"
#include "tripatch/types.h"

namespace tripatch {

/// Inside vertices at weighted means of their neighbors (Tutte 1963), so that in a convex domain no face is turned over. Edges across
/// the same row of quads weigh the same, the less the longer the row's ends on the rim are.
void embed(PlaneLayout& layout);
/// The same in space: the first `rim` rows stay.
void spread_inside(const Faces& faces, Index rim, Points& rows);

/// Triangles of a plane that carry values at their vertices.
class PlaneTriangles {
public:
  PlaneTriangles(std::vector<std::array<Index, 3>> triangles, PlanePoints at);

  /// Values at places, of values at the vertices, a row each: linearly in the triangle that a place is in, or least out of.
  Eigen::MatrixXd carried(const PlanePoints& places, const Eigen::MatrixXd& values) const;

private:
  std::array<Index, 2> cell(const Eigen::RowVector2d& place) const;

  std::vector<std::array<Index, 3>> triangles_;
  PlanePoints at_;
  Index cells_;
  Eigen::RowVector2d lowest_;
  double cell_;  ///< its size
  std::vector<std::vector<std::size_t>> in_cell_;
};

/// Triangles between the vertices of a plane region, spread over a convex one (Tutte 1963): no triangle is turned over there. count: of the
/// vertices, the first of which are the rim; rim_at: places of these in the convex region.
PlaneTriangles spread_triangles(const std::vector<std::array<Index, 3>>& triangles, Index count, const PlanePoints& rim_at);

/// The same between two loops: spread over a cylinder, whose places are (turn, height), the turn up to whole numbers.
class SpreadRing {
public:
  /// points: one loop, the other one, which runs against it, and what is between them, in a plane, where either is the outer one; ends_at: places
  /// of the loops' vertices on the cylinder, of heights 0 and 1.
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
