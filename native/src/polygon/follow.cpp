#include "tripatch/polygon/follow.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "tripatch/math/interruption.h"
#include "tripatch/math/linear.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/polygon/space.h"

namespace tripatch {
namespace {

constexpr int newton_steps = count::several;  ///< from where the patch was about to pass the points: a choice
constexpr int follow_degree = count::half_dozen,
              follow_second_cross = count::several;  ///< more than the points of the coarsest layouts can tell apart
constexpr Index points_a_look = count::block;        ///< between two looks whether the work is to end: some milliseconds

}  // namespace

Eigen::VectorXd nearest_in_polygon(const Surface& surface, const PolygonDomain& domain, const Points& points, Points& uv) {
  Eigen::VectorXd distance = Eigen::VectorXd::Constant(points.rows(), std::numeric_limits<double>::infinity());
  Points at = uv;
  Eigen::Matrix<double, Eigen::Dynamic, 9, Eigen::RowMajor> jets(points.rows(), 9);
  for (int step = 0; step <= newton_steps; ++step) {
    for (Index first = 0; first < at.rows(); first += points_a_look) {
      check_interruption();
      surface.evaluate(at.row(first).data(), std::min(points_a_look, at.rows() - first), 1, jets.row(first).data());
    }
    for (Index k = 0; k < points.rows(); ++k) {
      const Vec3 off = points.row(k) - jets.row(k).head<3>();
      if (off.norm() < distance[k]) {
        distance[k] = off.norm();
        uv.row(k) = at.row(k);
      }
      const Vec2 move = in_frame(jets.row(k).segment<3>(3), jets.row(k).tail<3>(), off);
      if (!move.allFinite()) continue;
      at.row(k).head<2>() = domain.kept_inside(Vec2(at.row(k).head<2>()) + move);
    }
  }
  return distance;
}

SurfacePtr follow_over_polygon(const SurfacePtr& plain, const PolygonDomain& domain, SurfacePoints points, double size) {
  const Index n = points.points.rows(),
              unknowns = static_cast<Index>(domain.sides()) * follow_second_cross + polynomials_to(follow_degree);
  SurfacePtr patch = plain;
  for (int round = 0; round < 2; ++round) {
    const Points missing = points.points - plain->positions(points.barycentric);
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(3 * unknowns, 3 * unknowns), rows(3, 3 * unknowns);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(3 * unknowns);
    for (Index k = 0; k < n; ++k) {
      if (k % points_a_look == 0) check_interruption();
      const Jet<0> u(points.barycentric(k, 0)), v(points.barycentric(k, 1));
      const Vec2 place(u.value(), v.value());
      if (domain.corner_at(place, tolerance::same) >= 0) continue;  // side weights are 0/0 there, and nothing is added
      const std::vector<Jet<0>> basis = polygon_basis<0>(domain, domain.place(u, v), u, v, follow_degree, follow_second_cross);
      const Vec3 up = points.normals.row(k);
      const Eigen::Matrix3d across = follow_along * Eigen::Matrix3d::Identity() + (1 - follow_along) * up * up.transpose();
      for (Index s = 0; s < unknowns; ++s) rows.block<3, 3>(0, 3 * s) = size * basis[s].value() * across;
      normal.selfadjointView<Eigen::Lower>().rankUpdate(rows.transpose());
      const Vec3 off = across * missing.row(k).transpose();
      right += rows.transpose() * off;
    }
    normal.diagonal().array() += tolerance::same * normal.trace() / static_cast<double>(3 * unknowns);
    const Eigen::VectorXd x = normal.selfadjointView<Eigen::Lower>().ldlt().solve(right);
    if (!x.allFinite()) return patch;
    const Points coefficients = size * Eigen::Map<const Points>(x.data(), unknowns, 3);
    patch = sum(plain, polygon_correction(domain, std::vector<PiecewisePolynomial>(domain.sides()), follow_degree,
                                          follow_second_cross, coefficients));
    if (round == 0) nearest_in_polygon(*patch, domain, points.points, points.barycentric);
  }
  return patch;
}

}  // namespace tripatch
