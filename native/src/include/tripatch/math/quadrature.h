// Integrals over the triangle. All carry the corner weight w(b) = (27/8) (1 - b0)(1 - b1)(1 - b2): the blends are homogeneous of low
// degree next to a corner, where third-order energies without a weight are infinite.
#pragma once

#include <vector>

#include "tripatch/types.h"

namespace tripatch {

/// Gauss-Legendre nodes and weights on [0, 1], by Newton's method on the Legendre polynomial.
struct GaussNodes {
  std::vector<double> x, w;
};
GaussNodes gauss(int n);

/// Nodes over the triangle that converge quickly for functions that are smooth in polar coordinates about each corner, as the
/// blends are: the triangle is cut into six about its center, each a square collapsed at its corner of the triangle.
struct Quadrature {
  Points b;                     ///< barycentric coordinates
  std::vector<double> weights;  ///< of the equilateral triangle of unit side, corner weight included
};
Quadrature corner_quadrature(int nodes_per_direction);

}  // namespace tripatch
