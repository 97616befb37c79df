#include "tripatch/estimate/quadric.h"

#include <cmath>
#include <limits>

#include "tripatch/math/decompositions.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/math/unit_vector.h"

namespace tripatch {
namespace {

constexpr Index coefficients = 10;

Eigen::RowVectorXd monomials(const Vec3& x) {
  Eigen::RowVectorXd row(coefficients);
  row << x[0] * x[0], x[1] * x[1], x[2] * x[2], x[0] * x[1], x[1] * x[2], x[2] * x[0], x[0], x[1], x[2], 1;
  return row;
}

}  // namespace

std::optional<Quadric> Quadric::through(const Points& points) {
  const Index n = points.rows();
  if (n < 2 * coefficients || !points.allFinite()) return {};
  Quadric q;
  q.middle_ = points.colwise().mean();
  q.size_ = (points.rowwise() - q.middle_.transpose()).cwiseAbs().maxCoeff();
  if (!(q.size_ > 0)) return {};
  Eigen::MatrixXd rows(n, coefficients);
  for (Index k = 0; k < n; ++k) rows.row(k) = monomials(q.local(points, k));
  q.root_ = orthonormal_columns(rows, false).triangle / std::sqrt(static_cast<double>(n));
  q.root_.diagonal() += tolerance::fit * Eigen::VectorXd::Ones(coefficients);
  // Inverse iteration with the root has all digits of the least singular vector, which those of its square have half of.
  Eigen::VectorXd c = symmetric_eigen(q.root_.transpose() * q.root_).vectors.col(0);
  for (int round = 0; round < count::pair; ++round) {
    c = q.root_.transpose().triangularView<Eigen::Lower>().solve(c);
    c = q.root_.triangularView<Eigen::Upper>().solve(c).normalized();
  }
  if (!c.allFinite()) return {};
  q.twice_ << 2 * c[0], c[3], c[5], c[3], 2 * c[1], c[4], c[5], c[4], 2 * c[2];
  q.along_ = c.segment<3>(6);
  q.constant_ = c[9];
  q.bend_ = principal_axes(q.twice_).values.cwiseAbs().maxCoeff();
  q.left_ = (rows * c).norm() / std::sqrt(static_cast<double>(n - coefficients + 1));
  return q;
}

Points Quadric::nearest(const Points& points) const {
  Points out = points;
  for (Index k = 0; k < out.rows(); ++k) {
    Vec3 x = local(points, k);
    for (int step = 0; step < count::half_dozen; ++step) {
      const Vec3 way = gradient(x);
      const double f = 0.5 * x.dot(twice_ * x) + along_.dot(x) + constant_;
      x -= f / std::max(way.squaredNorm(), tolerance::tiny) * way;
    }
    out.row(k) = middle_ + size_ * x;
  }
  return out;
}

Points Quadric::normals(const Points& points, const Points& directions) const {
  Points out(points.rows(), 3);
  for (Index k = 0; k < out.rows(); ++k) {
    const Vec3 way = gradient(local(points, k));
    out.row(k) = unit_vector(way.dot(directions.row(k)) < 0 ? Vec3(-way) : way);
  }
  return out;
}

Eigen::VectorXd Quadric::deviation(const Points& points, double edge) const {
  Eigen::VectorXd out(points.rows());
  for (Index k = 0; k < out.size(); ++k) {
    const Vec3 x = local(points, k);
    const double slope = gradient(x).norm();
    const Eigen::VectorXd known = root_.transpose().triangularView<Eigen::Lower>().solve(monomials(x).transpose());
    const double off = left_ * std::sqrt(1 + known.squaredNorm()) / slope + tolerance::solved;
    out[k] = bend_ * edge <= size_ * slope ? size_ * off : std::numeric_limits<double>::infinity();
  }
  return out;
}

}  // namespace tripatch
