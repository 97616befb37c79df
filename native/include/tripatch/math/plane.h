// Points of a plane.
#pragma once

#include "tripatch/types.h"

namespace tripatch {

/// n points of a plane, one a row.
using PlanePoints = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>;

}  // namespace tripatch
