// How a rim runs in the surface that it borders: its edge lengths and where it turns; and how large it is.
#pragma once

#include <span>
#include <vector>

#include "tripatch/math/thresholds.h"
#include "tripatch/mesh/connectivity.h"

namespace tripatch {

/// Of the rim's length, to either side of a vertex: what is looked at together where corners are sought.
constexpr double window_share = 1.0 / 24;

struct RimShape {
  std::vector<double> length;  ///< of the edges; the longest coordinate of an edge is 1
  std::vector<double> turn;    ///< at the vertices, radians, positive at a convex corner of the hole
  bool without_area = false;   ///< the faces around have none, the turns mean nothing
};

/// The turns are angles between rim edges in the tangent plane of the faces around.
RimShape measure(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim);

/// The same by the rim alone, whatever the faces around it do: the turns are angles in space, negative where the rim turns back as it is
/// seen along its vector area.
RimShape measure_alone(const Mesh& mesh, const std::vector<Index>& rim);

/// How far the sides are from smooth curves, judged by the rim alone: the distance of a unit edge direction from the mean of the
/// directions before and after it, exceeded at two thirds of the inner edges of the sides. Of smooth sides it falls with the square
/// of the edge length, and kinks here and there do not count; where a rim zigzags between irregular triangles it is a third or more.
/// 0 where no side has three edges. places: of the corners in the rim, in rim order; none: it is one
/// side, which goes round.
double zigzag(const Mesh& mesh, const std::vector<Index>& rim, std::span<const Index> places);
/// Sides up to here are smooth. Coarse sides of the smooth surfaces that were tried (8 edges) stay below 0.16, rims of deleted
/// irregular triangles begin at 0.3.
constexpr double smooth_sides = share::fifth;

/// The size of a hole: the largest distance between two points of its rim (k x 3), in their units, whichever is the first; NaN where one
/// is not finite.
double diameter(const Points& rim);
double diameter(const Mesh& mesh, const std::vector<Index>& rim);

/// Whether one of these points is farther from the rim's vertices than the hole is large: nobody expects a fill there.
bool exceeds_hole_bounds(const Mesh& mesh, const std::vector<Index>& rim, const Points& inside);

}  // namespace tripatch
