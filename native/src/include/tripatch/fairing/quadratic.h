// A sum of squares as a quadratic function.
#pragma once

#include <Eigen/Core>
#include <algorithm>

#include "tripatch/math/dense_kernels.h"

namespace tripatch {

/// sum of squares |A x + r|^2 = x' normal x + 2 x' gradient + constant.
struct Quadratic {
  Eigen::MatrixXd normal;
  Eigen::VectorXd gradient;
  double constant = 0;

  double operator()(const Eigen::VectorXd& x) const {
    return std::max(0.0, x.dot(symmetric_product(normal, x) + 2 * gradient) + constant);
  }
  Quadratic& operator+=(const Quadratic& o) {
    normal += o.normal;
    gradient += o.gradient;
    constant += o.constant;
    return *this;
  }
  Quadratic& operator*=(double weight) {
    normal *= weight;
    gradient *= weight;
    constant *= weight;
    return *this;
  }
};

}  // namespace tripatch
