// The path of a hole in rows of quads: they continue across it.
#pragma once

#include <optional>
#include <vector>

#include "tripatch/fill/fill_context.h"
#include "tripatch/output/fill_result.h"
#include "tripatch/quads/quad_layout.h"

namespace tripatch {

/// Quads, or halves of these, as many as the rim's edges ask for: of a block (see quad_rows) on a surface through all rows, of other outlines
/// (see go_on) without one. rim: in the direction of new faces. None where no rows continue, where the surroundings meet the rim at an angle,
/// or an edge of the mesh would be doubled. `deviation` is what the rim's own sides are missed by where they are continued in this way
/// (see continued_rows, continued_quads). features: whether creases that continue are reported.
std::optional<Fill> fill_with_rows(const FillContext& context, const std::vector<Index>& rim, Output output,
                                   bool features = true);

/// The same over a layout of quads, rim: its first vertices. None where rows do not continue in it (see go_on).
std::optional<Fill> fill_with_rows_over(const FillContext& context, const std::vector<Index>& rim, const QuadLayout& layout,
                                        Output output, bool features = true);

/// The same, requested; a Refusal says what it needs. corners: none, or those of the block.
Fill fill_with_rows_only(const FillContext& context, const std::vector<Index>& rim, const Corners& corners,
                         const FillOptions& options);

}  // namespace tripatch
