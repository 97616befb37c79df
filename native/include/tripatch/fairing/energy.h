// Fairness energies of a surface over the triangle. All carry the corner weight w(b) = (27/8) (1 - b0)(1 - b1)(1 - b2): the blends
// are homogeneous of low degree beside a corner, where third-order energies without a weight are infinite.
#pragma once

#include <string>
#include <vector>

#include "tripatch/patch/surface.h"

namespace tripatch {

/// Nodes over the triangle that converge quickly for functions that are smooth in polar coordinates about each corner, as the
/// blends are: the triangle is cut into six about its middle, each a square collapsed at its corner of the triangle.
struct Quadrature {
  Points b;                     ///< barycentric coordinates
  std::vector<double> weights;  ///< of the equilateral triangle of unit side, corner weight included
};
Quadrature corner_quadrature(int nodes_per_direction);

/// The nine derivatives of order 1 to 3 in the Cartesian coordinates (x, y) of the equilateral triangle of unit side, row by
/// row: x, y, xx, xy, yy, xxx, xxy, xyy, yyy.
using Derivatives = Eigen::Matrix<double, 9, 3, Eigen::RowMajor>;

/// Barycentric coordinates as jets in (x, y) instead of (b0, b1).
template <int N>
Barycentric<N> cartesian_barycentric(const double* b) {
  const double h = 1 / std::sqrt(3.0);
  Barycentric<N> r;
  r[0] = Jet<N>::linear(b[0], 1, -h);
  r[1] = Jet<N>::linear(b[1], 0, 2 * h);
  r[2] = Jet<N>::linear(b[2], -1, -h);
  return r;
}

std::vector<Derivatives> cartesian_derivatives(const Surface& surface, const Points& b);

/// The third-order shape of a surface at a point: the covariant derivative of its second fundamental form h. By Codazzi it is
/// symmetric, so four numbers in an orthonormal frame: 111, 112, 122, 222; here with the factors 1, sqrt 3, sqrt 3, 1, so that the
/// sum of squares is its squared norm. It vanishes on planes, spheres and cylinders.
///
/// `quadric` is what is left of it when the part that a covector theta can explain, sym(h theta), is taken away (four numbers, a
/// rotation of the rest; theta costs `flat` |theta|^2, flat a curvature squared). It vanishes on all quadrics (Maschke, Pick and
/// Berwald: the cubic form of affine differential geometry is zero on quadrics only).
struct CurvatureVariation {
  double area;  ///< |P_x x P_y|
  Eigen::Vector4d variation;
  Eigen::Vector4d quadric;
};
CurvatureVariation curvature_variation(const Derivatives& d, double flat);

/// The same and the derivatives of sqrt(area) variation and sqrt(area) quadric with respect to the 27 numbers of `d`. Those of
/// quadric are Kaufman's for a variable projection: the gradient of its square is exact.
struct CurvatureVariationRows {
  Eigen::Matrix<double, 8, 1> value;
  Eigen::Matrix<double, 8, 27, Eigen::RowMajor> derivative;
};
CurvatureVariationRows curvature_variation_rows(const Derivatives& d, double flat);

/// The curvature squared below which a surface counts as flat when quadrics are sought: (0.03 / size)^2.
inline double flat_curvature(double size) { return 9e-4 / (size * size); }

/// Of two energies, minimum_variation and ten times quadric_variation, softly the smaller: (a^-4 + b^-4)^(-1/4). On surfaces at
/// large the second is a quarter to a half of the first, so it wins only where a surface is a quadric or near one.
constexpr double quadric_ratio = 0.1;
double softly_smaller(double variation, double quadric);

/// thin_plate, third_derivative: integral of w |D^2 P|^2, w |D^3 P|^2 over the unit equilateral triangle (units: length squared).
/// minimum_variation, quadric_variation: size^2 times the integral of w |grad h|^2 over the surface, whole and what is left of it
/// (no units). auto: softly_smaller of these.
double energy(const Surface& surface, const std::string& name, double size, int nodes_per_direction = 16);

/// The largest distance between points of the sides.
double size_of(const Surface& surface);

}  // namespace tripatch
