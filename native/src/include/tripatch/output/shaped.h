// Bulge, tension and the middle of a fill that has no patch between sides to shape: its vertices are displaced within the tangent planes
// along the rim.
//
// Sources: M. S. Floater, Mean value coordinates, Computer Aided Geometric Design 20 (2003); C. Dyken and M. S. Floater, Transfinite mean
// value interpolation, Computer Aided Geometric Design 26 (2009), for the distance from the rim that the weights' sum gives.
#pragma once

#include <span>
#include <vector>

#include "tripatch/mesh/connectivity.h"
#include "tripatch/options.h"
#include "tripatch/output/fill_result.h"

namespace tripatch {

/// Whether bulge, tension, center or center_offset are asked for.
bool is_shaped(const FillOptions& options);
/// The same without them.
FillOptions unshaped(FillOptions options);

/// Refuses what is out of all proportion to a hole of this size, near a point.
void check_reach(double size, const Vec3& near, const FillOptions& options);
/// Whether there is anything to displace: new vertices at places in a plane domain.
bool can_be_shaped(const Fill& fill);
/// The loops of a rim, from the sizes of those after the first.
std::vector<std::vector<Index>> loops_of(const std::vector<Index>& rim, std::span<const std::size_t> islands);
/// Displaces the new vertices of a fill as bulge, tension and the center ask for; its patch with them. The rim and the tangent planes there
/// stay. islands: sizes of the loops after the first of fill.rim. Values of bulge by side go by report.corners; as many as there are sides.
void shape(const Mesh& mesh, const Connectivity& around, std::span<const std::size_t> islands, const FillOptions& options,
           Fill& fill);

}  // namespace tripatch
