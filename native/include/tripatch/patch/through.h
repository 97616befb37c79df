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

/// Of the size: where inner points are farther from the patch than that the equations had no solution.
constexpr double points_met = 1e-6;

}  // namespace tripatch
