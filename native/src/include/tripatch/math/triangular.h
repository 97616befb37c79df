// Triangular systems with many right-hand sides.
#pragma once

#include "tripatch/math/linear.h"

namespace tripatch {

/// b becomes the x with l x = b, for the lower triangle l of a (n, n) and b (n, k).
void solve_lower_triangular(const Eigen::MatrixXd& a, RowMajor& b);

}  // namespace tripatch
