// The fill of method auto: all ways to fill a hole are tried, cheapest first, and the best one is used (see select.h).
#pragma once

#include "tripatch/fill/fill_context.h"
#include "tripatch/output/fill_result.h"

namespace tripatch {

/// The most accurate valid fill that is found, with all candidates in its report.
Fill fill_as_the_rim_asks(const FillContext& context, const std::vector<Index>& rim, const Corners& corners,
                          const FillOptions& options);

}  // namespace tripatch
