// All-quad layouts that grow in from a rim as a grid does: each vertex of it gets the quads that it wants, and as few vertices as possible
// inside have other than four.
#pragma once

#include <optional>
#include <vector>

#include "tripatch/mesh/connectivity.h"
#include "tripatch/quads/quad_smoothing.h"

namespace tripatch {

/// For each vertex of a rim, counterclockwise, how many quads it wants inside: 1 where the rim turns left, 2 where it runs on, 3 where it turns
/// right. Where the faces around it are quads it is what they lack to four; else what their angles leave, what is rounded at one vertex being
/// made up for at the next. Vertices that `around` does not know lie on edges.
std::vector<int> wanted_quads(const Points& vertices, const Connectivity& around, const std::vector<Index>& rim);

/// The quads that a grid would have that begins at the rim. The rim is unrolled on the lattice of a grid: round a hole in one it closes, and what
/// was there comes back; round a pole of 3 or 5 it closes but for a right angle, turned about a point of the lattice, which is where the
/// pole is. Else poles are planned, on the rim or inside, until it closes. rim: places in a plane; of layouts with as many poles the one
/// whose quads are the best there is taken. An odd rim gets one triangle. None where a few poles do not do.
std::optional<PlaneLayout> grown_quads(const PlanePoints& rim, const std::vector<int>& wanted);

}  // namespace tripatch
