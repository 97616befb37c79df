// From a side to a ribbon: the derivative that the patch takes across its side. mathematics of Liu, Ma and Cheng (2008), with
// the corner equations corrected: at each corner the full 2 x 2 normal equations for (alpha, beta), both linear in between.
#pragma once

#include <array>
#include <string>

#include "tripatch/boundary/side.h"
#include "tripatch/choices.h"

namespace tripatch {

/// The boundary data of a patch along one side: position and the derivative of the patch in the outward direction -delta_i
/// (b_i falls by 1, the two others rise by 1/2), which is alpha(t) r(t) + beta(t) c'(t), alpha > 0.
struct Ribbon {
  PiecewisePolynomial c;
  PiecewisePolynomial d;
  PiecewisePolynomial alpha;  ///< scalar
  PiecewisePolynomial beta;   ///< scalar
  std::vector<double> rim;    ///< parameters of the rim vertices, as in Side
};

/// Three ribbons and, at smooth corners (the rim turns by less than about 25 degrees), the inward part of the derivative at the
/// corner that keeps the parameterisation open there (zero at ordinary corners).
struct Boundary {
  std::array<Ribbon, 3> ribbons;
  std::array<Vec3, 3> inward = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  std::array<double, 3> turn_deg = {0, 0, 0};             ///< how much the rim turns at corner i, degrees
  std::array<double, 3> corner_mismatch_deg = {0, 0, 0};  ///< angle between the tangent planes of the two sides at corner i
  double size = 0;
};

/// How much of the floor of alpha a corner takes: all where the rim turns by 5 degrees or less (or backwards), none from 25 on.
double floor_share(double turn_deg);

/// The derivative across a side at a corner.
struct CornerSlope {
  double alpha, beta;
  Vec3 lifted;  ///< what the floor added, as a vector
};

/// The corrected corner equations: (alpha, beta) such that alpha r + beta c' is nearest to tau; alpha kept above the given share of
/// what a regular patch of this height has.
CornerSlope corner_slope(const Vec3& r, const Vec3& dc, const Vec3& tau, double height, double share);

struct RibbonOptions {
  CrossBoundary cross_boundary = CrossBoundary::consistent;
  std::array<double, 3> bulge = {1, 1, 1};           ///< > 0; scales the slopes inside each side, corners kept
  std::array<bool, 3> tangent = {true, true, true};  ///< false: position only (G0); the slope follows from the three curves
};

Boundary make_boundary(const Sides& sides, const RibbonOptions& options = {});

}  // namespace tripatch
