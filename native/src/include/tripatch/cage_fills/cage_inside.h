// The vertices of a cage inside its hole: on the surface that continues the mesh around it, or in rows of quads that continue.
#pragma once

#include <optional>
#include <variant>

#include "tripatch/cage/closed_cage.h"
#include "tripatch/fill/fill_context.h"
#include "tripatch/messages.h"

namespace tripatch {

/// Places and normals of the vertices inside a layout, on the surface over a plane that continues the faces around the hole. None where no
/// such surface is found or only a plainer one. The deviation is the largest on that surface, scene units; 0: unknown. error: as expected.
struct OnMesh {
  Points points, normals;
  double deviation = 0, error = 0;
};
/// As they are spread evenly; smoothed on the surface; or smoothed in its plane, for where they cross as they are.
enum class Smoothed { no, on_surface, in_plane };
std::optional<OnMesh> cage_on_mesh(const FillContext& context, const SidedRim& hole, const CageHole& laid_out,
                                   const FillOptions& options, Smoothed smoothed);

struct InRows {
  Points points;
  double error = 0;  ///< as expected, scene units
};
/// Places of the vertices inside a layout that is such rows, in its order: what continues the cage's own points continues the limit surface
/// that they carry. replaced: faces that count as not there. Why not, where rows do not continue in it, or where the surface around it tells
/// more.
std::variant<InRows, Code> cage_in_rows(const FillContext& context, const CageHole& laid_out, const std::vector<Index>& replaced);

}  // namespace tripatch
