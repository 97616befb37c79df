// Sides from vertex normals: a curve over each edge of a triangle that is orthogonal to the normals at its ends, and the normal
// field that two triangles share along it. B. Smits 2000, "Boundary curves" (equation numbers are that page's).
#pragma once

#include <array>

#include "tripatch/boundary/side.h"

namespace tripatch {

enum class NormalCurve {
  hermite,  ///< cubic; end tangents are the chord turned into the vertices' planes, as long as the arc
  smits,    ///< eqs. 4-9: heights over the chord along the mixed normals; degree 4
};

/// The side over the edge from p to q. The normal field is the mix of the end normals, made orthogonal to the curve: a function of
/// the edge's own data, the same bits from both directions. Throws a Refusal (where: 0 for p, 1 for q) for edges without length, for
/// normals that are zero, not finite, along the edge, or opposite.
Side side_from_normals(const Vec3& p, const Vec3& normal_p, const Vec3& q, const Vec3& normal_q, NormalCurve curve);

/// The three sides of a triangle whose outer normals at the corners are given (of any length).
Sides sides_from_normals(const std::array<Vec3, 3>& points, const std::array<Vec3, 3>& normals,
                         NormalCurve curve = NormalCurve::hermite);

}  // namespace tripatch
