// Fairing "isometric": an ordinary fill becomes one that unrolls with its surroundings.
#pragma once

#include <span>

#include "tripatch/mesh/connectivity.h"
#include "tripatch/output/fill_result.h"

namespace tripatch {

/// Moves the new vertices of a fill (see least_strain), which has no patch then. Where the surroundings do not unroll, or the fill would fold, it
/// stays as it is, and that is reported. islands: sizes of the loops after the first of fill.rim.
void make_isometric(const Mesh& mesh, const Connectivity& around, std::span<const std::size_t> islands, Fill& fill);

}  // namespace tripatch
