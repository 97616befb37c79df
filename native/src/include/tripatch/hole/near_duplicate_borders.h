// Borders that lie upon each other: faces that meet in place, yet have vertices of their own, as files without indices hold them and
// as seams of textures part them. What looks like a hole there is none.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "tripatch/messages.h"
#include "tripatch/types.h"

namespace tripatch {

/// For each rim a message where edges of it lie upon other edges of the border, with both ends at the same places to the bit; else
/// nothing. Takes time by the vertices of the mesh, and by its faces where there are such vertices.
std::vector<std::optional<Message>> told_of_near_duplicate_borders(const Mesh& mesh, std::span<const std::vector<Index>> rims);

}  // namespace tripatch
