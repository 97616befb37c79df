// The rim of a cage's hole, of three sides or of any other number, and the patch over its sides.
#pragma once

#include <optional>
#include <vector>

#include "tripatch/boundary/side.h"
#include "tripatch/hole/hole.h"
#include "tripatch/patch/surface.h"
#include "tripatch/polygon/domain.h"
#include "tripatch/quads/grown_quads.h"
#include "tripatch/quads/polygon_layout.h"
#include "tripatch/quads/quad_layout.h"

namespace tripatch {

/// As Hole, with any number of corners. Of three sides, side i is opposite corner i; of others it runs from corner i to corner i + 1.
struct SidedRim {
  std::vector<Index> rim;
  std::vector<Index> corners;  ///< places in `rim`, increasing, the first 0
  bool guessed = false;        ///< the rim shows no corners, or none that its quads keep to: four places were taken as such
  bool by_angle = false;       ///< if guessed: the quads grow in from the rim, as its angles have it
  bool given = false;          ///< the corners are those that were asked for

  SidedRim() = default;
  SidedRim(const Hole& hole)  // NOLINT(google-explicit-constructor): a hole has a rim
      : rim(hole.rim), corners(hole.corners.begin(), hole.corners.end()) {}

  int sides() const { return static_cast<int>(corners.size()); }
  bool is_triangle() const { return sides() == 3; }
  /// Of three corners.
  Hole hole() const;
  /// Vertices of side i, both corners included.
  std::vector<Index> side(int i) const;
};

/// Places in a rim at which the faces of a cage make a corner: three or more quads about it, where others have two. None where a face is
/// no quad, a vertex has but one (the rim bends inwards there), or the corners are not three to twelve.
std::vector<Index> corners_by_valence(const Mesh& mesh, const Connectivity& left, const std::vector<Index>& rim);

using CageSides = std::vector<Side>;
/// Of three.
Sides three_sides(const CageSides& sides);

/// The domain of a patch in a hole of other than three sides: a polygon with the angles and lengths of the rim.
PolygonDomain cage_domain(const SidedRim& rim, const Points& vertices, const Connectivity& left);

/// The layout of a hole of other than three sides, its coordinates (u, v, 0) in the domain, where each edge of a side takes an equal
/// share of it, as of the limit rim. Corners get as many quads as they lack to four.
QuadLayout polygon_cage_layout(const SidedRim& rim, const Points& vertices, const PolygonDomain& domain, const Connectivity& left,
                               int rows);

/// The layout of quads that continue from the faces around (quads/grown_quads.h), coordinates (u, v, 0) of the rim as it is seen along its
/// vector area; none where none is found.
std::optional<QuadLayout> grown_layout(const std::vector<Index>& rim, const Points& vertices, const Connectivity& left,
                                       WantedQuads which = WantedQuads::by_number);
/// Whether quads that continue from the faces around leave fewer irregular vertices, on the rim and inside, than ones between the corners must on
/// the rim alone. Not where the rim shows its corners and the faces around are not all quads.
bool grows_on(const SidedRim& rim, const Points& vertices, const Connectivity& left);

/// Coordinates where a patch is nearest to points: over a triangle or a polygon, from where they are. Returns the distances.
Eigen::VectorXd nearest_on(const Surface& patch, const Points& points, Points& coordinates);

}  // namespace tripatch
