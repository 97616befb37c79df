// What a caller of fill and fill_all gets wrong, whatever the mesh: each throws InvalidArgument.
#pragma once

#include <span>
#include <vector>

#include "tripatch/fill/fill_context.h"
#include "tripatch/options.h"
#include "tripatch/types.h"

namespace tripatch {

/// Of one hole, or of each of several.
void check_for_holes(const FillOptions& options);
/// Of several holes. corners: by rim.
void check_several(const std::vector<std::vector<Index>>& rims, const FillOptions& options, const std::vector<Corners>& corners);
/// Vertices that are named exist. To be called before anything is refused that names them.
void check_named(const Mesh& mesh, std::span<const std::vector<Index>> rims, const Corners& corners, const FillOptions& options);
/// Creases that are given lie on edges of the mesh.
void check_creases(const Mesh& mesh, const std::vector<std::array<Index, 2>>& creases);

}  // namespace tripatch
