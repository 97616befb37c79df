// Where a cage is compared with what it shall be: places spread over the faces of its fill and over those around.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "tripatch/boundary/limit_surface.h"
#include "tripatch/cage/cage_fair.h"
#include "tripatch/cage/cage_system.h"
#include "tripatch/cage/closed_cage.h"
#include "tripatch/fairing/follow.h"

namespace tripatch {

/// A cell's centres of a grid of 4 x 4 on a quad, 2 x 2 on each quarter of an n-gon, the ten of a triangle (Loop's scheme).
std::vector<FacePlace> spread_places(std::size_t corners, bool loop);
/// Bilinear between `rows` of the face's corners.
Vec3 mean_at(const FacePlace& place, std::span<const Index> face, const Points& rows, bool loop);
/// The same of barycentric coordinates.
Vec3 barycentric_at(const FacePlace& place, std::span<const Index> face, const Points& rows, bool loop);

/// The limit surface at the places of a face: sums of the cage's vertices.
struct SampledFace {
  Index face;
  Sums limit;
  Points target, normal;  ///< outside: of the old limit surface
  double trust = 1;       ///< times the weight of these distances
  double along = 1;       ///< times that of distances along the surface: nothing on strips much longer than the fill's faces
};

/// A hole's samples, while its cage is fitted.
struct HoleSamples {
  std::vector<SampledFace> inside, outside;  ///< of the fill, and of the first two rings around
  std::vector<LimitStencils> stencils;       ///< of the faces inside
  Points coordinates;          ///< of the samples inside, barycentric or (u, v, 0): where on the patch they shall be
  std::size_t first_ring = 0;  ///< faces of `outside` that touch the rim
  FairHole shape;              ///< of the faces inside and of the first ring
  bool region = false;         ///< the hole replaces faces

  /// Of the samples inside.
  Points positions(const Points& free) const;
  /// Barycentric coordinates, points and normals of the limit surface inside; vertices: of the closed cage.
  SurfacePoints points(const Points& vertices) const;
};

/// What a cage was and what it becomes.
struct CageSurfaces {
  const Mesh& given;
  const ClosedCage& closed;
  const LimitSurface &was, &limit;  ///< of the given and of the closed cage
  const CageSystem& system;
  bool loop;
};

/// first_face: of the fill in the closed cage. corner_trust: of faces that touch a corner of an open hole.
HoleSamples sample_hole(const CageSurfaces& surfaces, const CageHole& hole, Index first_face,
                        const std::array<std::vector<Index>, 2>& rings, bool region, double corner_trust);

}  // namespace tripatch
