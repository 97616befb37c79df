// The surroundings of a hole in a subdivision cage, known exactly: three sides on the limit surface of the cage.
#pragma once

#include "tripatch/boundary/limit_surface.h"
#include "tripatch/boundary/mesh_sides.h"
#include "tripatch/messages.h"

namespace tripatch {

struct LimitSides {
  Sides sides;
  /// Parameter on its side of every point that a Subdivision modifier of the level makes along the rim, 2^level an edge: the
  /// limit rim is a spline over the cage's edges, so each edge takes an equal share of t.
  std::array<std::vector<double>, 3> parameters;
  Messages warnings;
  double surroundings_error = 0;  ///< degrees; 0 but for refined points without limit
  Points border;                  ///< those points, from corner 0 along side 2, 0 and 1, without repeat
};

/// whole: of the cage, as far as limit_rings around the rim; around: the same without faces to be replaced, which stay in place: the
/// surroundings' limit is that of the whole cage. The rim must be one of make_hole. Takes time by the hole.
/// Refusal: a corner where the limit has no tangent plane.
LimitSides limit_sides(const Mesh& cage, const Connectivity& whole, const Connectivity& around, const Hole& hole,
                       const Subdivision& settings);

/// Whether the derivatives at a place span a tangent plane: the sine between them is more than a millionth. In the cages of the tests it is
/// 1e-12 or less at corners of smooth rims, where a quad's two edges run into one line, and 1e-5 or more wherever else sides are read.
bool spans_plane(const LimitJet& jet);

/// The side along these vertices of the rim, from a corner to the next one.
Side side_on(const LimitSurface& surface, const Connectivity& around, const std::vector<Index>& along, double tolerance);
/// The sides alone, on a limit surface of the cage that is at hand. tolerance: of their polynomials, of their largest value.
Sides sides_on(const LimitSurface& surface, const Connectivity& around, const Hole& hole, double tolerance);
Sides sides_on(const LimitSurface& surface, const Mesh& cage, const Hole& hole, const std::vector<Index>& replaced,
               double tolerance);

}  // namespace tripatch
