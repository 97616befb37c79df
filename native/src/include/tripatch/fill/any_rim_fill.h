// The path of any rim: the surface over a plane, as the options ask for it.
#pragma once

#include <optional>

#include "tripatch/fill/fill_context.h"
#include "tripatch/output/fill_result.h"

namespace tripatch {

/// Whether something is asked of the patch that only one between sides has.
bool asks_for_sides(const FillOptions& options);
/// Whether somebody shapes the fill: then the patch is made wherever it lies well.
bool is_shaped_by_hand(const FillOptions& options);
/// Whether it is left to the fill which of its surroundings it continues from.
bool is_continuity_open(const FillOptions& options);

/// The spline of the rim alone with the normals that a patch has along it, where that patch knows the planes there but folds inside.
Fill fill_with_planes_of(const FillContext& context, const Fill& patch, const FillOptions& options);

Fill fill_any_rim(const FillContext& context, const std::vector<Index>& rim, const Corners& corners, const FillOptions& options);

/// The ring between the rim and its only island; a Refusal else.
Fill fill_ring(const FillContext& context, const std::vector<Index>& rim, const FillOptions& options);
/// A hole with islands: a ring where there is one island, unless the whole surrounding surface suggests another surface.
Fill fill_around_islands(const FillContext& context, const std::vector<Index>& rim, const FillOptions& options);

/// The quads of rows on the surface of another fill of the same hole: its vertices nearest to theirs. Nothing where these are no good quads, or
/// the fill has creases.
std::optional<Fill> rows_on_surface(const FillContext& context, const Fill& rows, const Fill& fill);

/// A fill of four edges that lies in their plane gets two triangles.
void close_if_flat(const FillContext& context, const FillOptions& options, Fill& fill);
/// In the plane of a flat rim.
Fill fill_flat(const FillContext& context, const std::vector<Index>& rim, const FillOptions& options);

}  // namespace tripatch
