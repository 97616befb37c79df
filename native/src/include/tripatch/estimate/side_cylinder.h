// Sides along fillets of straight edges: the faces next to them have all their vertices on one cylinder.
#pragma once

#include "tripatch/estimate/side_planes.h"

namespace tripatch {

/// Planes and second fundamental forms of a side whose faces have their vertices on a cylinder, where that tells more of itself than what
/// was found. CAD programs mesh cylinders with long triangles from border to border: across a rim that runs aslant these are twisted, and
/// polynomials of heights have next to no points, but the vertices lie on the cylinder. Strips that are about as deep as the rim's edges are
/// long are taken for a cylinder where it clearly ends behind them: polynomials look across that end, and are degrees off.
void take_cylinder(const LocalMesh& w, SideFit& fit, SideDraft& side);

}  // namespace tripatch
