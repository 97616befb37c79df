// The hole: its rim as an ordered loop, its three corners, and the loops that a mesh has.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "tripatch/mesh/connectivity.h"

namespace tripatch {

/// Rim vertices from corner 0 on, without repeat, in the direction in which new faces traverse it: the new faces are on its left,
/// seen from the mesh's outer side; the surrounding faces hold the edges reversed.
struct Hole {
  std::vector<Index> rim;
  /// Places of the corners in `rim`; corners[0] == 0. Corner 1 and 2 follow along the rim.
  std::array<Index, 3> corners = {0, 0, 0};
  /// Sides that the fill does not continue: their planes say nothing of their neighbors'.
  std::array<bool, 3> alone = {false, false, false};

  /// Vertices of side i (opposite corner i), from corner i + 1 to corner i + 2, both included.
  std::vector<Index> side(int i) const;
};

/// Every border loop, shortest first (then by lowest index), each from its lowest index on, in the direction that new faces take.
std::vector<std::vector<Index>> find_holes(const FacesRef& faces);

/// The hole of a given rim (any start, either direction) and corners, which are vertex indices of the rim. The first corner stays
/// corner 0, the others are sorted along the rim. Without corners they are detected where the rim turns, in the tangent plane of
/// the surface, the lowest vertex first. A rim of three edges has its vertices as corners. `around`: of the mesh, without the
/// faces of a region to be replaced. Takes time by the rim and the faces at it. Throws a Refusal.
Hole make_hole(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim,
               const std::optional<std::array<Index, 3>>& corners);
/// The same for one rim. `replaced`: faces that count as not there.
Hole make_hole(const Mesh& mesh, const std::vector<Index>& rim, const std::optional<std::array<Index, 3>>& corners,
               const std::vector<Index>& replaced = {});

/// The mesh's only border loop with three corners; else a Refusal that lists the candidates. Outer borders count only where the mesh
/// has no other.
Hole find_hole(const Mesh& mesh, const Connectivity& around);
Hole find_hole(const Mesh& mesh);

}  // namespace tripatch
