// What a rim asks for, shaped as it is requested.
#pragma once

#include <optional>
#include <vector>

#include "tripatch/fill/fill_context.h"

namespace tripatch {

/// The patch over a polygon or a disc, requested, or that of three sides which meets points inside; nothing where the rim has three sides
/// and no such points. Corners that are not given are detected.
std::optional<Fill> fill_with_many_sides(const FillContext& context, const std::optional<std::vector<Index>>& rim,
                                         const Corners& corners, const FillOptions& options);

/// Whether holes of few edges are closed by few triangles, without a surface.
bool fills_small(const FillOptions& options);

/// What the rim asks for, shaped as asked: shape changes nothing in what is chosen.
Fill fill_and_shape(const FillContext& context, const std::vector<Index>& loop, const Corners& corners,
                    const FillOptions& options);

/// Sizes of the loops after the rim.
std::vector<std::size_t> sizes_of(const std::vector<std::vector<Index>>& islands);

}  // namespace tripatch
