// A side of the hole and its surroundings. Conventions: side i is opposite corner i and runs, t from 0 to 1, from corner
// i + 1 to corner i + 2 (mod 3), in the direction in which the new faces traverse the rim.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "tripatch/math/piecewise_polynomial.h"

namespace tripatch {

struct Side {
  PiecewisePolynomial c;  ///< position, scene units
  PiecewisePolynomial r;  ///< derivative of the surrounding surface across the side, away from the hole, units per parameter
  PiecewisePolynomial q;  ///< optional (empty: unknown): second derivative of the surrounding surface in the direction of r
  /// Parameters of the rim vertices on the side, from 0 to 1; empty where the side comes from no mesh. Methods that replace c by
  /// a curve of their own keep it at these.
  std::vector<double> rim = {};
  double curvature_error = 0;  ///< how well q is known: standard deviation of the normal curvature across, rms, 1 / length

  /// Unit normal on the outer side of the mesh, r x c' (zero where they are parallel).
  Vec3 normal(double t) const;
};

using Sides = std::array<Side, 3>;

/// The piece of a side from one parameter to another, backwards where to < from. On a closed side (its ends meet, and its
/// derivatives) the larger of the two may lie beyond 1, up to a whole turn on. The derivatives across stay as they are.
Side piece_of(const Side& side, double from, double to);
/// The side with its ends moved, and all between in proportion.
Side moved_ends(Side side, const Vec3& start, const Vec3& end);

/// Sides in rim order of which some are not continued: those take nothing from what lies beyond them. Between the vertices of a rim
/// they run as these alone tell, not as the faces next to them bend. Their planes are spanned by what the rim itself says: at a corner
/// the plane of a neighbor that is continued, else that of the two sides' tangents; in between they turn evenly from one to the other.
/// No curvature across them is known. The others stay as they are, bit for bit.
std::vector<Side> planes_from_rim(std::vector<Side> sides, const std::vector<bool>& continued);
Sides planes_from_rim(const Sides& sides, const std::array<bool, 3>& continued);

/// Sides must meet: the end of each is the start of the next, within 1e-6 of the size; throws a Refusal that names the corner
/// and the gap otherwise. Returns the size: the largest distance between two corners or side points.
double check_sides(const Sides& sides);
/// The same for three curves alone.
double check_curves(const std::array<PiecewisePolynomial, 3>& curves);

}  // namespace tripatch
