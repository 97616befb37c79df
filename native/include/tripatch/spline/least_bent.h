// Triangles that bend least, measured on themselves: the Gaussian field of order 2 in its Markov form, on the surface instead of the
// plane (Lindgren, Rue and Lindstroem 2011; as a way to fill holes Botsch and Kobbelt 2004).
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "tripatch/types.h"

namespace tripatch {

/// Positions of the rows first .. first + count - 1 of points (n x 3) at which the integral of the squared Laplacian of the
/// coordinates is least, by cotangents and areas of the triangles as they lie (Pinkall and Polthier 1993). All other rows stay. The
/// triangles around every vertex that is joined to one of these rows must be given; more do not matter. Nothing where no numbers
/// come of it.
std::optional<Points> least_bent(const Points& points, const std::vector<std::array<Index, 3>>& triangles, Index first,
                                 Index count);

}  // namespace tripatch
