// Points of a plane.
#pragma once

#include "tripatch/types.h"

namespace tripatch {

/// n points of a plane, one a row.
using PlanePoints = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>;

/// (u, v, 0): rows as surfaces over a plane are evaluated at.
inline Points as_rows(const PlanePoints& uv) {
  Points rows = Points::Zero(uv.rows(), 3);
  rows.leftCols(2) = uv;
  return rows;
}

}  // namespace tripatch
