#include "tripatch/math/decompositions.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <cmath>

namespace tripatch {

OrthonormalColumns orthonormal_columns(const Eigen::MatrixXd& a, bool with_rest) {
  const Index m = a.rows(), n = a.cols();
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(a);
  const Eigen::MatrixXd q = qr.householderQ() * Eigen::MatrixXd::Identity(m, with_rest ? m : n);
  OrthonormalColumns out{q.leftCols(n), Eigen::MatrixXd::Zero(n, n), q.rightCols(q.cols() - n)};
  for (Index j = 0; j < n; ++j) out.triangle.col(j).head(j + 1) = qr.matrixQR().col(j).head(j + 1);
  return out;
}

SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& a) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(a);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

PrincipalAxes principal_axes(const Eigen::Matrix3d& a) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(a);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

PlaneAxes principal_axes(const Eigen::Matrix2d& a) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(a);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

Eigen::Matrix2d cholesky_root(const Eigen::Matrix2d& a) { return Eigen::LLT<Eigen::Matrix2d>(a).matrixL(); }

SquareSystem::SquareSystem(const Eigen::MatrixXd& a) : factors_(a) {}

Eigen::MatrixXd SquareSystem::solve(const Eigen::MatrixXd& b) const { return factors_.solve(b); }

Eigen::MatrixXd SquareSystem::inverse() const { return factors_.inverse(); }

Eigen::Matrix3d rotation_between(const Vec3& a, const Vec3& b) {
  const Vec3 across = a.cross(b);
  const double sine = across.norm();
  const Vec3 axis = sine > 0 ? Vec3(across / sine) : Vec3(a.unitOrthogonal());
  return Eigen::AngleAxisd(std::atan2(sine, a.dot(b)), axis).toRotationMatrix();
}

}  // namespace tripatch
