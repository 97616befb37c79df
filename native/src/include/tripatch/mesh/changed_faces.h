// The faces of a mesh without some of them, and with vertices on their edges.
#pragma once

#include <map>
#include <span>

#include "tripatch/mesh/edge_key.h"
#include "tripatch/types.h"

namespace tripatch {

/// By face whether it is replaced; empty: none is. Throws InvalidArgument for one that does not exist.
std::vector<char> marked_faces(const FacesRef& faces, std::span<const Index> replaced);
/// middles: by edge the vertex that comes between its ends.
Faces changed_faces(const FacesRef& faces, std::span<const Index> replaced, const std::map<EdgeKey, Index>& middles = {});

}  // namespace tripatch
