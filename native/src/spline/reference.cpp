#include "tripatch/spline/reference.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "tripatch/math/linear.h"

namespace tripatch {
namespace {

/// Gauss-Newton on a smooth polynomial; tried: the last of them moves nothing by more than rounding.
constexpr int steps = 8;

int size_of(int degree) { return (degree + 1) * (degree + 2) / 2; }

}  // namespace

Reference::Reference(const PlanePoints& points, const Points& samples, int degree)
    : degree_(std::clamp(degree, 1, highest_degree)) {
  while (degree_ > 1 && size_of(degree_) > points.rows() / 3) --degree_;
  middle_ = points.colwise().mean();
  size_ = std::max((points.rowwise() - middle_).cwiseAbs().maxCoeff(), 1e-300);
  Eigen::MatrixXd monomials(points.rows(), size_of(degree_));
  for (Index k = 0; k < points.rows(); ++k) {
    const Eigen::RowVector2d x = (points.row(k) - middle_) / size_;
    int column = 0;
    for (int i = 0; i <= degree_; ++i)
      for (int j = 0; i + j <= degree_; ++j) monomials(k, column++) = std::pow(x[0], i) * std::pow(x[1], j);
  }
  coefficients_ = least_squares(monomials, samples);
  const Points left = monomials * coefficients_ - samples;
  double across = 0;
  for (Index k = 0; k < points.rows(); ++k) {
    const Eigen::Matrix3d jet = at(points.row(k));
    const Vec3 u = jet.row(1), v = jet.row(2);
    across += std::pow(left.row(k).dot(u.cross(v).stableNormalized()), 2);
  }
  distance_across_ = std::sqrt(across / static_cast<double>(points.rows()));
}

Eigen::Matrix3d Reference::at(const Eigen::RowVector2d& point) const {
  const Eigen::RowVector2d x = (point - middle_) / size_;
  std::array<std::array<double, highest_degree + 1>, 2> power;
  for (int axis = 0; axis < 2; ++axis) {
    power[axis][0] = 1;
    for (int k = 1; k <= highest_degree; ++k) power[axis][k] = power[axis][k - 1] * x[axis];
  }
  Eigen::Matrix3d out = Eigen::Matrix3d::Zero();
  int row = 0;
  for (int i = 0; i <= degree_; ++i)
    for (int j = 0; i + j <= degree_; ++j, ++row) {
      out.row(0) += power[0][i] * power[1][j] * coefficients_.row(row);
      if (i > 0) out.row(1) += i * power[0][i - 1] * power[1][j] / size_ * coefficients_.row(row);
      if (j > 0) out.row(2) += j * power[0][i] * power[1][j - 1] / size_ * coefficients_.row(row);
    }
  return out;
}

PlanePoints Reference::foot_points(PlanePoints points, const Points& samples) const {
  const double longest = 0.1 * size_;  // of a step
  for (Index k = 0; k < points.rows(); ++k)
    for (int step = 0; step < steps; ++step) {
      const Eigen::Matrix3d jet = at(points.row(k));
      const Eigen::Matrix<double, 2, 3> tangents = jet.bottomRows<2>();
      const Eigen::Matrix2d gram = tangents * tangents.transpose();
      if (!(gram.determinant() > 1e-12 * gram.squaredNorm())) break;
      Eigen::Vector2d move = gram.inverse() * (tangents * (samples.row(k) - jet.row(0)).transpose());
      if (move.norm() > longest) move *= longest / move.norm();
      points.row(k) += move.transpose();
      if (move.norm() < 1e-14 * size_) break;
    }
  return points;
}

}  // namespace tripatch
