// Faces that hang on the rim of a hole by one edge and stick out of the surface: the rim goes around them, where a person sees none.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "tripatch/messages.h"
#include "tripatch/types.h"

namespace tripatch {

/// For each rim a message that names such a face; else nothing. Takes time by the faces of the mesh.
std::vector<std::optional<Message>> told_of_extra_faces(const Mesh& mesh, std::span<const std::vector<Index>> rims);

}  // namespace tripatch
