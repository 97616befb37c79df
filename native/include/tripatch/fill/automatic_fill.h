// Which path a hole takes: the exact patch where its sides are smooth, else the surface over a plane.
#pragma once

#include "tripatch/fill/ground.h"
#include "tripatch/output/fill_result.h"

namespace tripatch {

Fill fill_as_the_rim_asks(const Ground& ground, const std::vector<Index>& rim, const Corners& corners,
                          const FillOptions& options);

}  // namespace tripatch
