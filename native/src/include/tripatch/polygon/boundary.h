// What a patch over a polygon takes along its sides: the domain that follows the hole, and the derivative across each side.
#pragma once

#include <vector>

#include "tripatch/boundary/side.h"
#include "tripatch/choices.h"
#include "tripatch/polygon/domain.h"

namespace tripatch {

/// Sides in rim order, n of them; side i runs from corner i to corner i + 1 (mod n).
using SideList = std::vector<Side>;

/// As Ribbon, but d is the derivative of the patch along the inward normal of the domain's side: -(alpha r + beta c'), alpha > 0.
struct PolygonRibbon {
  PiecewisePolynomial c, d, alpha, beta;
};

struct PolygonBoundary {
  PolygonDomain domain;
  std::vector<PolygonRibbon> ribbons;
  std::vector<double> turn_deg;             ///< how much the rim turns at corner i, degrees
  std::vector<double> corner_mismatch_deg;  ///< angle between the tangent planes of the two sides at corner i
  double size = 0;                          ///< scene units: the largest distance between points of the sides
  bool past_hooks = false;                  ///< as asked for
};

struct PolygonRibbonOptions {
  std::vector<double> bulge = {};  ///< by side, > 0; empty: 1
  std::vector<bool> tangent = {};  ///< by side, false: position only; empty: all true
  /// Sides hook: they turn within a small part of their length next to a corner, as edges of CAD programs do where fillets of three radii
  /// meet. Then the derivative across them turns evenly, and what they twist by in the hook is kept next to the corner.
  bool past_hooks = false;
};

/// Sides must meet: else a Refusal that names the corner and the gap. Ends within 1e-6 of the size are moved together.
SideList closed(SideList sides);

/// domain: none: made for these sides.
PolygonBoundary polygon_boundary(const SideList& sides, const PolygonRibbonOptions& options = {},
                                 const PolygonDomain* domain = nullptr);

}  // namespace tripatch
