#include "tripatch/creases/wall.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "tripatch/math/angle.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/mesh/submesh.h"
#include "tripatch/mesh/vertex_normals.h"

namespace tripatch {
namespace {

/// Standard deviations of the noise: vertices of a wall are no farther from it.
constexpr double in_wall = deviations::clear;
/// Of an edge: noisier faces are no smooth wall (rough_noise of polyharmonic_spline.cpp).
constexpr double rough_share = noise::rough;
/// Between a wall's mean plane and its faces: heights over the plane tell nothing of steeper ones.
constexpr double steepest = radians(angle::steep);
/// The nearest to the rim: farther ones change no fill of 168 holes by more than 1%, and the time grows with their square.
constexpr Index max_wall_samples = count::hundreds;
/// Of the hole's diameter: at that distance from the rim faces count a third in the mean plane.
constexpr double near_share = share::third;

}  // namespace

Wall::Wall(const Vec3& normal, const Vec3& point, double across, bool has_faces)
    : middle_(point), normal_(normal), is_flat_(true), has_faces_(has_faces), within_(tolerance::close * across) {
  along_ = normal_.unitOrthogonal();
  beside_ = normal_.cross(along_);
}

Wall::Wall(const Mesh& mesh, std::vector<Index> faces, const Points& rim, double across)
    : faces_(std::move(faces)), within_(tolerance::close * across) {
  const auto from_rim = [&](const Vec3& p) { return (rim.rowwise() - p.transpose()).rowwise().squaredNorm().minCoeff(); };
  Vec3 sum = Vec3::Zero();
  double area = 0;
  for (const Index f : faces_) {
    Vec3 middle = Vec3::Zero();
    for (const Index v : mesh.faces[f]) middle += Vec3(mesh.vertices.row(v)) / static_cast<double>(mesh.faces[f].size());
    const Vec3 own = area_vector(mesh, f);
    area += own.norm() / 2;
    sum += std::exp(-from_rim(middle) / std::pow(near_share * across, 2)) * own;
  }
  normal_ = sum.stableNormalized();
  along_ = normal_.unitOrthogonal();
  beside_ = normal_.cross(along_);
  Numbering vertices;
  for (const Index f : faces_)
    if (angle_between(area_vector(mesh, f), normal_) < steepest)
      for (const Index v : mesh.faces[f]) vertices.add(v);
  std::vector<Index> nearest = vertices.items();
  if (std::ssize(nearest) > max_wall_samples) {
    std::ranges::stable_sort(nearest, {}, [&](Index v) { return from_rim(mesh.vertices.row(v)); });
    nearest.resize(max_wall_samples);
  }
  const Points samples = mesh.vertices(nearest, Eigen::all);
  if (samples.rows() < 4) return;
  middle_ = samples.colwise().mean().transpose();
  const Points centered = samples.rowwise() - middle_.transpose();
  Points local(samples.rows(), 3);
  local << centered * along_, centered * beside_, centered * normal_;
  const double edge = std::sqrt(area / static_cast<double>(faces_.size()));
  try {
    const FieldOptions options = {.unit = edge};
    auto surface = std::make_shared<PolyharmonicSpline>(PlanePoints(local.leftCols(2)), local, options);
    if (surface->noise() > rough_share * edge) return;
    within_ = std::max(within_, in_wall * surface->noise());
    surface_ = std::move(surface);
  } catch (const InvalidArgument&) {  // on a line
  }
}

Wall::At Wall::at(const Points& points) const {
  const Points local = points.rowwise() - middle_.transpose();
  const Index n = points.rows();
  At out{local * normal_, normal_.transpose().replicate(n, 1)};
  if (is_flat_) return out;
  Points rows = Points::Zero(n, 3);
  rows.col(0) = local * along_;
  rows.col(1) = local * beside_;
  std::vector<double> jets(static_cast<std::size_t>(9 * n));
  surface_->evaluate(rows.data(), n, 1, jets.data());
  for (Index k = 0; k < n; ++k) {
    const double* jet = &jets[static_cast<std::size_t>(9 * k)];  // position, by u, by v
    const Vec3 gradient = normal_ - jet[5] * along_ - jet[8] * beside_;
    out.distance[k] = (out.distance[k] - jet[2]) / gradient.norm();
    out.normal.row(k) = gradient.normalized();
  }
  return out;
}

Eigen::VectorXd Wall::deviation(const Points& points) const {
  if (is_flat_) return Eigen::VectorXd::Zero(points.rows());
  Points up = Points::Zero(points.rows(), 3);
  up.col(2).setOnes();
  return surface_->deviation(seen_from_outside(points), up).cwiseProduct((at(points).normal * normal_).cwiseAbs());
}

PlanePoints Wall::seen_from_outside(const Points& points) const {
  const Points local = points.rowwise() - middle_.transpose();
  PlanePoints out(points.rows(), 2);
  out << local * along_, local * beside_;
  return out;
}

}  // namespace tripatch
