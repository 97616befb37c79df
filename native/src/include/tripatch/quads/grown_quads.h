// All-quad layouts that grow in from a rim as a grid does: each vertex of it gets the quads that it wants, and as few vertices as possible
// inside have other than four.
#pragma once

#include <optional>
#include <vector>

#include "tripatch/quads/quad_smoothing.h"
#include "tripatch/quads/wanted_quads.h"

namespace tripatch {

/// The quads that a grid would have that begins at the rim. The rim is unrolled on the lattice of a grid: round a hole in one it closes, and what
/// was there comes back. Round a pole of 3 or 5 it closes but for a right angle, turned about a point of the lattice, which is where the
/// pole is. Else poles are planned, on the rim or inside, until it closes. rim: places in a plane; of layouts with as many poles the one
/// whose quads are the best there is taken. An odd rim gets one triangle. None where a few poles do not do.
std::optional<PlaneLayout> grown_quads(const PlanePoints& rim, const std::vector<int>& wanted);

/// The layout with so many rings of quads around it, as many in each as the rim has edges.
PlaneLayout with_rows(const PlaneLayout& layout, int rows);

}  // namespace tripatch
