// The average of a try with its second model, or that model alone.
#pragma once

#include "tripatch/spline/plane_attempt.h"

namespace tripatch {

/// The new vertices so far between the field's and the second model's as the share says, the surface with them. False, and as it was,
/// where that leaves the rim's neighborhood.
bool take_second(const PlaneRim& rim, const SecondModel& second, double share, Attempt& result);

/// The average with the second model where the surroundings are rough: with one that keeps the planes next to the rim, or, where that
/// folds more than the rim, with one that need not. As it was where that leaves the rim or folds more.
void average_models(const Disc& disc, const PlaneRim& rim, Attempt& result);

/// The triangles that bend least where the field runs far from them without a reason in the surroundings. result: tells of no points inside.
void hold_back(const Disc& disc, const PlaneRim& rim, Attempt& result);

/// Variance of both models about their average, of each new vertex.
Eigen::VectorXd spread_of_models(const Attempt& result);

/// Values at some places of the plane, carried to others: none below zero.
Eigen::VectorXd carried(const Eigen::VectorXd& values, const PlanePoints& places, double unit, const PlanePoints& to);

/// A surface through the vertices of a fill, those of its rim first: all of these, and as many inside as a field has samples.
SurfacePtr through_vertices(const PlanePoints& uv, const Points& points, Index rim, double unit);

}  // namespace tripatch
