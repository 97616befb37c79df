// A mesh about another origin: far away from it coordinates have lost digits.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "tripatch/options.h"
#include "tripatch/output/fill_result.h"

namespace tripatch {

/// Where computations are about: the middle of the rims, or of the mesh where none is given; nothing where that is near the origin.
std::optional<Vec3> local_origin(const Mesh& mesh, std::span<const std::vector<Index>> rims);

/// A mesh about another origin, and the options of what is filled in it.
struct Elsewhere {
  Vec3 origin;
  Points vertices;
  FillOptions options;

  Elsewhere(const Mesh& mesh, const FillOptions& given, const Vec3& about)
      : origin(about), vertices(mesh.vertices.rowwise() - about.transpose()), options(given) {
    if (options.center) *options.center -= origin;
    for (Through& each : options.through) each.point -= origin;
  }

  void bring_back(Fill& fill) const;
};

}  // namespace tripatch
