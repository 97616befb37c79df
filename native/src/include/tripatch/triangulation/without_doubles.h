// Triangulations without the edges that a mesh has already.
#pragma once

#include <vector>

#include "tripatch/mesh/edge_key.h"
#include "tripatch/mesh/triangles.h"

namespace tripatch {

/// Flips inner edges that the mesh has already to where nothing joins their opposite vertices yet. False if some are left, or an
/// edge occurs twice. joined: the edges of the mesh, sorted, each once.
bool without_doubles(Triangles& triangles, const std::vector<EdgeKey>& joined);

}  // namespace tripatch
