// A fill that unrolls with its surroundings: lengths on it are those in the plane, as on bent cloth, paper or sheet metal.
//
// Source of the bending energy: M. Bergou, M. Wardetzky, D. Harmon, D. Zorin and E. Grinspun, A quadratic bending model for inextensible
// surfaces, Symposium on Geometry Processing (2006).
#pragma once

#include <optional>

#include "tripatch/mesh/triangles.h"

namespace tripatch {

/// Triangles of a fill and of two rings or more around it.
struct Sheet {
  Points points;     ///< those that may move come first
  Index inside = 0;  ///< how many they are
  Triangles fill, around;
};

struct LeastStrain {
  Points inside;      ///< where they move
  double before = 0;  ///< root mean square strain of the fill's edges against the plane
  double after = 0;
};

/// Moves the inside so that all triangles unroll into the plane with the least strain, as a thin plate that is bent as it lies. None if the
/// triangles around do not unroll.
std::optional<LeastStrain> least_strain(const Sheet& sheet);

}  // namespace tripatch
