// Folds of a few triangles next to a noisy rim, where the surface passes the rim's vertices at the noise's distance.
#pragma once

#include <array>
#include <vector>

#include "tripatch/report/folded_triangles.h"

namespace tripatch {

/// Whether more than a few edges are folded, of so many triangles: then nothing is moved, and nothing flipped.
bool is_past_mending(Index folded, std::size_t triangles);

/// Moves vertices of folded edges (report/folded_triangles.h) from row `fixed` on to the middle of their neighbors until no more
/// than `allowed` edges are folded. Points stay as they are where that does not succeed, or where more than a few are folded:
/// returns how many edges are folded then.
Index untangle(Points& points, const std::vector<std::array<Index, 3>>& triangles, Index fixed, Index allowed,
               std::span<const AdjacentFace> beyond = {});

/// Flips edges of folded triangles as long as fewer are folded then: an ear at the rim that folds back over the faces beyond is no
/// matter of where vertices lie. No edge is made that is one of `joined` (rows) or in the triangles already. Where more than a few
/// are folded nothing is done. Returns how many edges are folded then.
Index flip_folded(const Points& points, std::vector<std::array<Index, 3>>& triangles,
                  std::span<const std::array<Index, 2>> joined, Index allowed, std::span<const AdjacentFace> beyond = {});

}  // namespace tripatch
