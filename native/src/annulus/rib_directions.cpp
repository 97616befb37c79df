#include "tripatch/annulus/rib_directions.h"

#include <Eigen/Dense>
#include <array>

#include "tripatch/fairing/curvature.h"
#include "tripatch/math/thresholds.h"

namespace tripatch {
namespace {

constexpr int motion_samples = count::many_places;  ///< places along a side: a choice
/// How much a motion out of the planes counts against one that leans along the side: leaning is what it is there to tell.
constexpr double out_of_plane_counts = 30;
/// A motion tells nothing where its direction leans from a right angle to the side by more than this cosine says, 70 degrees.
constexpr double min_upright = 0.35;

Motion motion_of(const Side& side) {
  Motion motion;
  for (int k = 0; k < motion_samples; ++k) motion.middle += side.c(static_cast<double>(k) / motion_samples) / motion_samples;
  double size = 0;
  for (int k = 0; k < motion_samples; ++k)
    size += (side.c(static_cast<double>(k) / motion_samples) - motion.middle).norm() / motion_samples;
  Eigen::MatrixXd rows(3 * motion_samples, 7);
  Eigen::VectorXd wanted(3 * motion_samples);
  for (int k = 0; k < motion_samples; ++k) {
    const double t = static_cast<double>(k) / motion_samples;
    const Vec3 from = (side.c(t) - motion.middle) / size, across = upright_across(side, t), n = side.normal(t);
    const std::array<Vec3, 3> seen = {across, across.cross(n), out_of_plane_counts * n};
    for (int i = 0; i < 3; ++i) {
      rows.row(3 * k + i) << seen[i].transpose(), from.cross(seen[i]).transpose(), seen[i].dot(from);
      wanted[3 * k + i] = i == 0 ? 1 : 0;
    }
  }
  const Eigen::VectorXd found = rows.completeOrthogonalDecomposition().solve(wanted);
  motion.shift = found.head<3>();
  motion.turn = found.segment<3>(3) / size;
  motion.growth = found[6] / size;
  return motion;
}

}  // namespace

RibDirections::RibDirections(const Side& side) : side_(side), motion_(motion_of(side)) {
  const auto tells = [&] {
    for (int k = 0; k < motion_samples; ++k) {
      const double t = static_cast<double>(k) / motion_samples;
      if (!((*this)(t).dot(upright_across(side_, t)) > min_upright)) return false;
    }
    return true;
  };
  for (const double upright : {0.0, 1.0, 4.0, 1e6}) {
    upright_ = upright;
    if (tells()) return;
  }
}

Vec3 RibDirections::operator()(double t) const {
  const Vec3 n = side_.normal(t), way = motion_(side_.c(t)) + upright_ * upright_across(side_, t);
  return (way - n * n.dot(way)).stableNormalized();
}

}  // namespace tripatch
