// Decompositions of dense matrices that their users keep. As in linear.h, Eigen's templates are compiled here once.
#pragma once

#include <Eigen/LU>

#include "tripatch/types.h"

namespace tripatch {

/// a = basis triangle for a (m, n), m >= n, of full rank: the columns of basis (m, n) are orthonormal, triangle (n, n) is upper
/// triangular. The columns of rest (m, m - n), orthonormal too, are at right angles to them.
struct OrthonormalColumns {
  Eigen::MatrixXd basis, triangle, rest;
};
/// with_rest: else that stays empty.
OrthonormalColumns orthonormal_columns(const Eigen::MatrixXd& a, bool with_rest);

/// a = vectors values vectors' for a symmetric a (n, n): values in rising order, columns of vectors orthonormal.
struct SymmetricEigen {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& a);

/// The same of a (3, 3), or (2, 2).
struct PrincipalAxes {
  Vec3 values;
  Eigen::Matrix3d vectors;
};
PrincipalAxes principal_axes(const Eigen::Matrix3d& a);
struct PlaneAxes {
  Eigen::Vector2d values;
  Eigen::Matrix2d vectors;
};
PlaneAxes principal_axes(const Eigen::Matrix2d& a);

/// The lower triangular root with root root' = a for a symmetric, positive definite a (2, 2).
Eigen::Matrix2d cholesky_root(const Eigen::Matrix2d& a);

/// a x = b for a regular a (n, n) and any number of b (n, k).
class SquareSystem {
public:
  explicit SquareSystem(const Eigen::MatrixXd& a);
  Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const;
  Eigen::MatrixXd inverse() const;

private:
  Eigen::PartialPivLU<Eigen::MatrixXd> factors_;
};

/// The rotation by the least angle that takes the direction of a to that of b; of opposite directions one of half a turn.
Eigen::Matrix3d rotation_between(const Vec3& a, const Vec3& b);

}  // namespace tripatch
