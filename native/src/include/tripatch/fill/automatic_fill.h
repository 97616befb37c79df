// Which path a hole takes: rows of quads that go on where it was a block of them, the exact patch where its sides are smooth, else the
// surface over a plane.
#pragma once

#include "tripatch/fill/ground.h"
#include "tripatch/output/fill_result.h"

namespace tripatch {

/// Whether a spline in place of a patch that folds is made again such that it keeps the planes of the patch's sides: they are well known,
/// and it misses them.
bool keeps_better_planes(const Fill& patch, const Fill& spline);

Fill fill_as_the_rim_asks(const Ground& ground, const std::vector<Index>& rim, const Corners& corners,
                          const FillOptions& options);

}  // namespace tripatch
