#include "tripatch/math/decompositions.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Householder>
#include <algorithm>
#include <cmath>

namespace tripatch {

// Column by column, as Eigen's own does with few: what turns them by blocks, which HouseholderQR brings along, takes longer to
// compile than all else here.
OrthonormalColumns orthonormal_columns(const Eigen::MatrixXd& a, bool with_rest) {
  const Index m = a.rows(), n = a.cols();
  Eigen::MatrixXd reflections = a, q = Eigen::MatrixXd::Identity(m, with_rest ? m : n);
  Eigen::VectorXd lengths(n), work(q.cols());
  for (Index k = 0; k < n; ++k) {
    double diagonal;
    reflections.col(k).tail(m - k).makeHouseholderInPlace(lengths[k], diagonal);
    reflections(k, k) = diagonal;
    reflections.bottomRightCorner(m - k, n - k - 1)
        .applyHouseholderOnTheLeft(reflections.col(k).tail(m - k - 1), lengths[k], work.data());
  }
  for (Index k = n; k-- > 0;)
    q.bottomRightCorner(m - k, q.cols() - k)
        .applyHouseholderOnTheLeft(reflections.col(k).tail(m - k - 1), lengths[k], work.data());
  OrthonormalColumns out{q.leftCols(n), Eigen::MatrixXd::Zero(n, n), q.rightCols(q.cols() - n)};
  for (Index j = 0; j < n; ++j) out.triangle.col(j).head(j + 1) = reflections.col(j).head(j + 1);
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

// It is tridiagonal as it is: what makes it so, which Eigen would compile, takes longer than all the rest of such a solver.
PlaneAxes principal_axes(const Eigen::Matrix2d& a) {
  const double largest = std::max({std::abs(a(0, 0)), std::abs(a(1, 0)), std::abs(a(1, 1))}), scale = largest == 0 ? 1 : largest;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen;
  eigen.computeFromTridiagonal(Eigen::Vector2d(a(0, 0) / scale, a(1, 1) / scale), Eigen::Matrix<double, 1, 1>(a(1, 0) / scale));
  return {eigen.eigenvalues() * scale, eigen.eigenvectors()};
}

Eigen::Matrix2d cholesky_root(const Eigen::Matrix2d& a) {
  Eigen::Matrix2d root = Eigen::Matrix2d::Zero();
  root(0, 0) = std::sqrt(a(0, 0));
  root(1, 0) = a(1, 0) / root(0, 0);
  root(1, 1) = std::sqrt(a(1, 1) - root(1, 0) * root(1, 0));
  return root;
}

SquareSystem::SquareSystem(const Eigen::MatrixXd& a) : factors_(a) {}

Eigen::MatrixXd SquareSystem::solve(const Eigen::MatrixXd& b) const {
  if (b.size() == 0) return b;  // nothing is asked, and Eigen takes the address of what is not there
  return factors_.solve(b);
}

Eigen::MatrixXd SquareSystem::inverse() const { return factors_.inverse(); }

Eigen::Matrix3d rotation_between(const Vec3& a, const Vec3& b) {
  const Vec3 across = a.cross(b);
  const double sine = across.norm();
  const Vec3 axis = sine > 0 ? Vec3(across / sine) : Vec3(a.unitOrthogonal());
  return Eigen::AngleAxisd(std::atan2(sine, a.dot(b)), axis).toRotationMatrix();
}

}  // namespace tripatch
