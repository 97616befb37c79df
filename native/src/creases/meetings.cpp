#include "tripatch/creases/meetings.h"

#include <Eigen/Dense>
#include <cmath>

#include "tripatch/math/ties.h"

namespace tripatch {
namespace {

/// Of the hole's diameter, from the nearest vertex of the rim: pieces that meet farther off leave the hole.
constexpr double farthest_node = 1;
/// Of the volume that three unit normals span: less, and it is chance where their pieces meet.
constexpr double least_volume = 0.02;
/// Newton's steps to a corner or a crease settle within ten where pieces meet at all.
constexpr int newton_steps = 20;
/// Points along a curved crease: over a quarter of a circle its chords are 1e-4 of the radius off.
constexpr Index curve_points = 49;
/// Of the hole's diameter: Newton's last step to a corner is shorter.
constexpr double in_node = 1e-4;

}  // namespace

std::optional<Vec3> Meetings::node(std::array<std::size_t, 3> of) {
  std::sort(of.begin(), of.end());
  const auto known = nodes_.find(of);
  return known != nodes_.end() ? known->second : nodes_.emplace(of, found_node(of)).first->second;
}

std::optional<Points> Meetings::crease(std::size_t a, std::size_t b, const Vec3& from, const Vec3& to) const {
  const bool straight = pieces_[a].is_plane() && pieces_[b].is_plane();
  const Index n = straight ? 2 : curve_points;
  const Eigen::VectorXd t = Eigen::VectorXd::LinSpaced(n, 0, 1);
  Points points = t * (to - from).transpose() + Eigen::VectorXd::Ones(n) * from.transpose();
  if (straight) return points;
  const Vec3 along = (to - from).stableNormalized();
  double step = 0;
  for (int round = 0; round < newton_steps; ++round) {
    step = 0;
    const SmoothPiece::At one = pieces_[a].at(points), other = pieces_[b].at(points);
    for (Index k = 0; k < n; ++k) {
      const Vec3 u = one.normal.row(k).transpose() - along.dot(one.normal.row(k)) * along;
      const Vec3 v = other.normal.row(k).transpose() - along.dot(other.normal.row(k)) * along;
      Eigen::Matrix<double, 2, 3> slopes;
      slopes << u.transpose(), v.transpose();
      const Eigen::Matrix2d among = slopes * slopes.transpose();
      if (!(among.determinant() > least_volume * least_volume)) return {};
      const Vec3 way = -slopes.transpose() * among.inverse() * Vec2(one.distance[k], other.distance[k]);
      points.row(k) += way.transpose();
      step = std::max(step, way.norm());
    }
    if (!(step < across_)) return {};
    if (step < tie * across_) break;
  }
  if (!(step < within(a, b))) return {};
  const Eigen::RowVector3d first = from.transpose() - points.row(0), last = to.transpose() - points.row(n - 1);
  points += (1 - t.array()).matrix() * first + t * last;  // the ends lie in both pieces but for noise
  return points;
}

Eigen::VectorXd Meetings::deviation(const std::vector<std::size_t>& of, const Points& points) const {
  std::vector<Eigen::VectorXd> own;
  std::vector<SmoothPiece::At> at;
  for (const std::size_t p : of) {
    own.push_back(pieces_[p].deviation(points));
    at.push_back(pieces_[p].at(points));
  }
  Eigen::VectorXd out(points.rows());
  for (Index k = 0; k < points.rows(); ++k) {
    Eigen::MatrixXd normals(static_cast<Index>(of.size()), 3), errors = Eigen::MatrixXd::Zero(normals.rows(), normals.rows());
    for (Index p = 0; p < normals.rows(); ++p) {
      normals.row(p) = at[static_cast<std::size_t>(p)].normal.row(k);
      errors(p, p) = own[static_cast<std::size_t>(p)][k];
    }
    const Eigen::MatrixXd among = normals * normals.transpose();
    out[k] = (normals.transpose() * among.ldlt().solve(errors)).norm();
  }
  return out;
}

std::optional<Vec3> Meetings::found_node(const std::array<std::size_t, 3>& of) const {
  Vec3 node = rim_.colwise().mean().transpose();
  double step = 0;
  for (int round = 0; round < newton_steps; ++round) {
    Eigen::Matrix3d normals;
    Vec3 distance;
    for (int k = 0; k < 3; ++k) {
      const SmoothPiece::At at = pieces_[of[static_cast<std::size_t>(k)]].at(node.transpose());
      normals.row(k) = at.normal.row(0);
      distance[k] = at.distance[0];
    }
    if (!(std::abs(normals.determinant()) > least_volume)) return {};
    const Vec3 way = -normals.partialPivLu().solve(distance);
    node += way;
    step = way.norm();
    if (!((node.transpose() - rim_.row(0)).norm() < 3 * across_)) return {};
    if (step < tie * across_) break;
  }
  const double far = (rim_.rowwise() - node.transpose()).rowwise().norm().minCoeff();
  if (!(step < in_node * across_) || !(far < farthest_node * across_)) return {};
  return node;
}

}  // namespace tripatch
