// How many quads the vertices of a hole's rim want inside.
#pragma once

#include <vector>

#include "tripatch/mesh/connectivity.h"
#include "tripatch/types.h"

namespace tripatch {

/// How many quads a vertex of a rim wants inside: where the faces around it are quads, what they lack to four; or, where these are too irregular
/// for that to come out, what their angles leave, as with all other faces.
enum class WantedQuads { by_number, by_angle };

/// What the faces at the k-th vertex of a rim leave, in quads. If they also leave other gaps there, as another hole that touches this one does
/// or the side of a new edge that is not filled, the rim has its share of all by the angles. Vertices that `around` does not know lie on
/// edges.
double quads_left(const PointsRef& vertices, const Connectivity& around, const std::vector<Index>& rim, std::size_t k,
                  WantedQuads which = WantedQuads::by_number);

/// For each vertex of a rim, counterclockwise: 1 where it turns left, 2 where it continues, 3 where it turns right. What is rounded at one vertex
/// is made up for at the next.
std::vector<int> wanted_quads(const PointsRef& vertices, const Connectivity& around, const std::vector<Index>& rim,
                              WantedQuads which = WantedQuads::by_number);

}  // namespace tripatch
