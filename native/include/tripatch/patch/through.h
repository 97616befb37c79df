// What a surface shall go through inside.
#pragma once

#include <optional>

#include "tripatch/types.h"

namespace tripatch {

/// A point that the surface shall go through, scene units; its place in the domain is where the surface without it comes nearest.
struct Through {
  Vec3 point = Vec3::Zero();
  std::optional<Vec3> normal;
};

}  // namespace tripatch
