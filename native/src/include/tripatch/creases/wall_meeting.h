// How the walls around a hole meet in it: each covers the hole next to its runs of the rim, two meet along creases, three in corners.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <vector>

#include "tripatch/creases/wall.h"
#include "tripatch/math/piecewise_polynomial.h"

namespace tripatch {

/// A smooth curve over [0, 1] through points that are even along it: two or more.
PiecewisePolynomial smooth_through(const Points& points);

/// Where two walls meet.
struct WallCrease {
  Points points;              ///< even along it, both ends included: two of a straight one
  Eigen::VectorXd deviation;  ///< standard deviations across, scene units
  std::array<std::size_t, 2> walls = {};
};

/// Corners are numbered: places in the rim, then nodes.
struct WallMeeting {
  std::vector<Vec3> nodes;                ///< inside the hole
  std::vector<double> deviation;          ///< of the nodes
  std::vector<std::vector<Index>> parts;  ///< corners around each, as new faces traverse it
  std::map<std::array<Index, 2>, WallCrease>
      creases;                    ///< by corners, the lower first: steps around parts that are no edges of the rim
  std::vector<std::size_t> wall;  ///< for each part
  std::size_t runs = 0;           ///< of the rim along one wall each
  double area = 0;                ///< of all parts
};

/// wall: of each edge of the rim (k x 3, as new faces traverse it, `across` in diameter), or empty. Of all ways in which the runs meet in
/// threes, which are the triangulations of their cycle, the one with the least area; of many runs, or if a wall has no faces, of those in
/// which one run meets all others. None where every way has a part that is turned over or crosses itself.
std::optional<WallMeeting> least_meeting(const std::vector<Wall>& walls, const Points& rim, const std::vector<std::size_t>& wall,
                                         double across);

}  // namespace tripatch
