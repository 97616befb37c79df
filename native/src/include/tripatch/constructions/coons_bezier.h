// Bezier triangles from three boundary curves: the discrete Coons net, the extremals of the functional that Coons patches
// minimize, and nets made by masks. A. Arnal and A. Lluch, "Coons triangular Bezier surfaces" (section and equation numbers
// below are theirs); masks and permanence patches after G. Farin and D. Hansford 1999 (CAGD 16, 691-700).
#pragma once

#include <array>
#include <optional>

#include "tripatch/boundary/ribbon.h"
#include "tripatch/messages.h"
#include "tripatch/patch/bezier_triangle.h"

namespace tripatch {

enum class CoonsKind {
  discrete,            ///< Definition 1: the transfinite triangular Coons patch; its degree is one higher than the boundary's
  extremal,            ///< Proposition 3: least integral of |x_uv|^2; favours corner 2, whose b2 = 1 - u - v
  extremal_symmetric,  ///< the same, summed over the three pairs of coordinates
  mask,                ///< eq. 11, from Proposition 4; favours corner 2 as well
  permanence,          ///< eq. 9 for any alpha, 3 alpha + 6 beta = 1
};

/// Three (n + 1) x 3 Bezier curves, curve i along side i (from corner i + 1 to corner i + 2), the ends shared.
using BoundaryCurves = std::array<Points, 3>;

constexpr int max_boundary_degree = 20;  ///< with 171 unknowns, for which the systems are dense
/// The paper's alpha: in degree 3 it gives the Coons patch.
constexpr double coons_alpha = -2.0 / 3.0;

/// Some mask and permanence systems are singular (mask: n = 6, 8, 10, ...; permanence: some alphas of every degree from 4 up).
/// They give the solution nearest to the Coons net of the boundary polygons, with a warning. Without a solution a Refusal names
/// degree and alpha. alpha: for permanence only (none: -2/3). The extremals warn above degree 12, where their systems are
/// ill-conditioned. Throws InvalidArgument for curves of different or too high degree, that do not meet, or that are not finite.
BezierTriangle coons_bezier(const BoundaryCurves& boundary, CoonsKind kind, std::optional<double> alpha = {},
                            Messages* warnings = nullptr);

/// The matrix C of Proposition 2: the functional of a net P is trace(P^T C P). Rows in the net's order; symmetric.
Eigen::MatrixXd coons_form(int degree, bool symmetric = false);

/// The functional (4), integral of |x_uv|^2 over the unit triangle, u = b0, v = b1; or its sum over the three pairs.
double coons_energy(const BezierTriangle& triangle, bool symmetric = false);

/// The equations of a mask on the interior of a net: (identity - mask) P = 0, one row for each interior point, all points of the
/// net as columns. kind: mask or permanence.
Eigen::MatrixXd mask_equations(int degree, CoonsKind kind, double alpha = coons_alpha);

/// The sides of a hole as Bezier curves of one degree, at most 12: the curve itself where it is such a polynomial, else the one
/// through its rim vertices. Throws a Refusal where neither exists.
BoundaryCurves bezier_sides(const Boundary& boundary);

/// coons_bezier on the sides of a hole. The mask takes the next odd degree, where its system is regular.
SurfacePtr coons_fill(const Boundary& boundary, CoonsKind kind, std::optional<double> alpha = {}, Messages* warnings = nullptr);

}  // namespace tripatch
