// Triangles for any polygon of a plane domain, well shaped on the surface over it.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <vector>

#include "tripatch/patch/surface.h"
#include "tripatch/types.h"

namespace tripatch {

/// A polygon with holes, triangulated somehow. Rows 0 .. rim - 1 are the vertices of all its border loops, in any order; further
/// rows are points inside that stay (ends and points of creases).
struct PlanePolygon {
  Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor> uv;  ///< n x 2
  Points points;  ///< n x 3: where these vertices are in space, whatever the surface says
  Index rim = 0;
  double unit = 1;                              ///< how long in space what has length 1 in the plane is, about
  int sides = 3;                                ///< for which edges a side are counted
  std::vector<std::array<Index, 3>> triangles;  ///< cover it once, all positively oriented in (u, v), every row in one at least
  std::vector<std::array<Index, 2>> creases;    ///< edges of these triangles that stay; halved where they are too long
  std::vector<std::array<Index, 2>> joined;     ///< pairs of rim vertices that the mesh joins already: no inner edge joins them
  double size = 0;                              ///< of the hole that it is a part of, scene units; less than its own: that
};

struct PlaneTriangulation {
  Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor> uv;  ///< the polygon's rows come first, unchanged
  Points points;                                                 ///< the polygon's rows as given, the others on the surface
  std::vector<std::array<Index, 3>> triangles;                   ///< all positively oriented in (u, v)
  std::vector<std::array<Index, 2>> creases;                     ///< the edges that the polygon's creases have become
  bool doubles_edges = false;  ///< an inner edge that the mesh has already is left: it could not be halved
  bool unfinished = false;     ///< it came to more than was allowed
};

/// Where a triangulation has both more triangles and a larger area in space than this it ends, for nobody takes it.
struct MostTriangles {
  std::size_t count = std::numeric_limits<std::size_t>::max();
  double area = 0;
};

/// Makes a place inside a row that stays, and splits the triangles that it lies in. A row that lies there already is moved to the point.
/// False, and all as it was, for a place outside, on an edge of the border, which must not be split, where triangles lie over each other,
/// or so near to another row that this would be left without triangles.
bool insert_row(PlanePolygon& polygon, const Eigen::RowVector2d& uv, const Vec3& point);

/// How many triangles remesh() aims at: 2.3 to a squared edge length. Costs no more than the size of the polygon times some 200.
double triangles_wanted(const PlanePolygon& polygon, std::optional<int> resolution);

/// Isotropic remeshing with lengths, angles and sizes measured in space (`surface` reads u and v from the first two numbers of each
/// row). Edges are as long as the rim's around them, each weighted by its length over its squared distance (in a circle: the
/// harmonic interpolation of the logarithms); with a resolution a third of the rim over it, and finer where the rim is. Delaunay
/// flips by the sum of the angles in space. What is given must be a triangulation of the polygon with every triangle positively
/// oriented; everything that follows is one too. The rim's vertices stay, and no vertex is added to it.
/// The same input gives the same bits. Throws InvalidArgument for triangles that are turned over, and rows that do not fit.
PlaneTriangulation remesh(const PlanePolygon& polygon, std::optional<int> resolution, const Surface& surface,
                          const MostTriangles& most = {});

}  // namespace tripatch
