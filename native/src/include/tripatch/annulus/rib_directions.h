// Which way a surface continues across a closed boundary.
#pragma once

#include "tripatch/boundary/side.h"

namespace tripatch {

/// A translation, a rotation and a scaling about a point, as velocities.
struct Motion {
  Vec3 middle = Vec3::Zero(), shift = Vec3::Zero(), turn = Vec3::Zero();
  double growth = 0;
  Vec3 operator()(const Vec3& p) const { return shift + turn.cross(p - middle) + growth * (p - middle); }
};

/// Directions within the tangent planes of a side, away from the hole. They are those of the motion by which the surrounding
/// surface moves in itself: a cylinder along its axis, a cone towards its tip, a plane in all directions (Pottmann and Randrup,
/// Rotational and helical surface approximation, Computing 60, 1998). Where no motion tells, they are at right angles to the
/// side.
class RibDirections {
public:
  explicit RibDirections(const Side& side);
  /// Unit.
  Vec3 operator()(double t) const;

private:
  const Side& side_;
  Motion motion_;
  double upright_ = 0;  // how much of the direction at right angles to the side is added
};

}  // namespace tripatch
