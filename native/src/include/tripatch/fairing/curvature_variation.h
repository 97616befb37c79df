// Derivatives of a surface up to the third, and how its curvature varies.
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "tripatch/patch/surface.h"

namespace tripatch {

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
/// The same, to the last bit, of many points: four at a time where the machine can.
void curvature_variations(std::span<const Derivatives> d, double flat, CurvatureVariation* out);

/// The same and the derivatives of sqrt(area) variation and sqrt(area) quadric with respect to the 27 numbers of `d`. Those of
/// quadric are Kaufman's for a variable projection: the gradient of its square is exact.
struct CurvatureVariationRows {
  Eigen::Matrix<double, 8, 1> value;
  Eigen::Matrix<double, 8, 27, Eigen::RowMajor> derivative;
};
CurvatureVariationRows curvature_variation_rows(const Derivatives& d, double flat);
void curvature_variation_rows(std::span<const Derivatives> d, double flat, CurvatureVariationRows* out);

/// The curvature squared below which a surface counts as flat when quadrics are sought: (0.03 / size)^2.
inline double flat_curvature(double size) { return 9e-4 / (size * size); }

}  // namespace tripatch
