// The limit surface of a few faces of a cage as a mesh.
#pragma once

#include "tripatch/boundary/limit_surface.h"

namespace tripatch {

struct LimitMesh {
  Points vertices;
  Faces faces;  ///< quads, each from an end of its shorter diagonal on; of a cage of triangles triangles
};

/// Faces `first` to `last` - 1, each as a grid of 2^level quads a side (an n-gon has half as many on each side of a quarter),
/// with one vertex where faces meet. limit: of `cage`, refined around these faces, with a quality.
LimitMesh sample_limit(const LimitSurface& limit, const Mesh& cage, bool loop, Index first, Index last, int level);
/// The same from face `first` to the last, on a limit surface of its own; without a quality that of stencil_quality.
LimitMesh sample_limit(const Mesh& cage, const Subdivision& settings, Index first, int level);

/// How far irregular places are isolated where stencils are needed and no quality is asked for: on cube-spheres, closed and open,
/// eighths of the edges lie within 2e-15 of an edge of the true limit.
constexpr int stencil_quality = 5;

}  // namespace tripatch
