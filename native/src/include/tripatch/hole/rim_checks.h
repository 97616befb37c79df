// What a rim must be before it can be filled.
#pragma once

#include <span>
#include <vector>

#include "tripatch/mesh/connectivity.h"
#include "tripatch/messages.h"

namespace tripatch {

/// InvalidArgument for a vertex that the mesh has not, by the option that names it.
void check_vertices(std::span<const Index> named, Index vertices, const char* option);
/// InvalidArgument for a vertex that is named twice.
void check_distinct(std::span<const Index> named, const char* option);

/// Every vertex once; every edge with one face; the faces around agree in orientation; else a Refusal. InvalidArgument for vertices
/// that the mesh has not. Returns the rim in the direction of new faces.
std::vector<Index> check_topology(const Connectivity& around, const std::vector<Index>& rim);

/// All positions at the rim must be finite. Else a Refusal.
void check_finite(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim);

/// Rim edges must have a length, rim vertices places of their own; all positions at the rim must be finite. Else a Refusal.
void check_positions(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim);

/// Refuses what may be meant of several rims, with the lowest vertex of each.
[[noreturn]] void refuse_several(const std::vector<std::vector<Index>>& rims, Code code);

}  // namespace tripatch
