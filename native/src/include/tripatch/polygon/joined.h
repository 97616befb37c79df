// One side made of several pieces: edges of surfaces, borders of meshes, that continue from one to the next.
#pragma once

#include <vector>

#include "tripatch/math/thresholds.h"
#include "tripatch/polygon/boundary.h"

namespace tripatch {

/// Degrees by which tangents and planes may differ where pieces are one side, and where a round rim's end meets its beginning: several
/// times what planes estimated from a mesh are off.
constexpr double still_smooth = angle::bend;

struct JoinedSide {
  Side side;
  std::vector<double> parameters;  ///< of all pieces, on the whole: those of their ends once
};

/// By arc length, so that what is made of it does not know where one piece ends; across it r is a unit vector at a right angle to the
/// curve, and q is known where all pieces have one. Where planes or tangents at a joint differ by more than ten degrees, or ends do
/// not meet, a Refusal says so. One piece stays as it is, unless its speed falls below a quarter of its length.
/// parameters: of each piece, from 0 to 1; none: not wanted.
JoinedSide joined(const SideList& pieces, const std::vector<std::vector<double>>& parameters = {});

/// A side of a surface is fitted by more pieces than this where it has kinks, about which they are halved nine times.
constexpr Index smooth_pieces = count::octet;
bool is_kinked(const Side& side);

/// The sides of one patch, all by arc length where one of them changes its speed quickly, as edges of CAD programs do where faces next to
/// them end: what a side does along it the patch does far into the inside. Else as they are.
SideList evenly_run(SideList sides);

}  // namespace tripatch
