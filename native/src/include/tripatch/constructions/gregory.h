// Convex combination of three interpolants, each to the two sides at one corner, without twist constraints: G1 along all sides for
// any data, reproduces cubics. Gregory 1974 (Smooth interpolation without twist constraints, in Computer Aided Geometric Design,
// Academic Press, 71-87), with its polynomial weights b_i^2 (3 - 2 b_i + 6 b_j b_k). The form of Gregory 1983 and Charrot and
// Gregory 1984 differs in the weights only (b_i^2 over the sum of squares).
#pragma once

#include "tripatch/boundary/ribbon.h"
#include "tripatch/patch/surface.h"

namespace tripatch {

SurfacePtr gregory(const Boundary& boundary);

}  // namespace tripatch
