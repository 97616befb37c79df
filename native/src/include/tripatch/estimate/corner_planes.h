// One plane of two sides at their corner, and how well all are known.
#pragma once

#include <array>

#include "tripatch/estimate/side_planes.h"

namespace tripatch {

/// Corners behind which a plane begins, as where two fillets end: it tells itself exactly, where polynomials of few facets do not.
void take_flat_corners(const LocalMesh& w, std::array<SideFit, 3>& fits, const std::array<bool, 3>& alone,
                       std::array<SideDraft, 3>& drafts);

/// Of all vertices of a side together.
double sum_of_variances(const SideFit& fit);

/// Whether two estimates of a plane are of the same one. deviations: how many standard deviations they are apart.
bool is_one_plane(double degrees, double deviations);

/// Corners: one plane, the average weighted by information, unless the two are far apart, also by what they know of themselves (a
/// cube), or one of the sides is not continued.
void settle_corners(const std::array<SideFit, 3>& fits, const std::array<bool, 3>& alone, std::array<SideDraft, 3>& drafts);

}  // namespace tripatch
