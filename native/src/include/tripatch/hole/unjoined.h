// Borders that lie upon each other: faces that meet in place, yet have vertices of their own, as files without indices hold them and
// as seams of textures part them. What looks like a hole there is none.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tripatch/types.h"

namespace tripatch {

/// What every sentence of told_of_unjoined says, and none else.
inline constexpr const char* not_joined = "faces meet there without being joined";

/// For each rim a sentence where edges of it lie upon other edges of the border, with both ends at the same places to the bit; else
/// nothing. Takes time by the vertices of the mesh, and by its faces where there are such vertices.
std::vector<std::string> told_of_unjoined(const Mesh& mesh, std::span<const std::vector<Index>> rims);

}  // namespace tripatch
