#include "tripatch/estimate/side_cylinder.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "tripatch/estimate/circle.h"
#include "tripatch/math/decompositions.h"
#include "tripatch/math/linear.h"

namespace tripatch {
namespace {

/// Unknowns of a cylinder, and vertices beyond these that tell whether there is one.
constexpr int cylinder_unknowns = 5, least_beyond = 3;
/// Vertices lie off a cylinder by this share of what they lie off a plane, at most.
constexpr double cylinder_within = 1e-3;
/// Of Gauss-Newton: with faces that lie askew two leave 6e-7, three 2e-13, four rounding; a bound for where there is no cylinder.
constexpr int most_cylinder_steps = 30;
/// Where it ends: a step of so much of a rim edge is rounding. With one of 1e-4 planes come to 2e-13.
constexpr double last_cylinder_step = 1e-13;

/// Edges that the faces are deep: vertices on two circles are on a cylinder and on any surface of revolution through these. Meshes follow their
/// surfaces, so that long faces bend little along them; squares beside a torus, of 1.6, hide 3 degrees.
constexpr double deep_faces = 5;

struct Cylinder {
  Vec3 point, axis;            // axis: unit
  double radius = 0, off = 0;  // off: root mean square
  Vec3 outward(const Vec3& p) const {
    const Vec3 d = p - point;
    return d - axis * axis.dot(d);
  }
};

/// The vertices of the faces at the inner vertices of a side: all of them are of the surface that goes on there.
std::vector<Vec3> vertices_beside(const LocalMesh& w, const SideDraft& side, std::vector<Vec3>& normals) {
  std::set<int> faces, vertices;
  for (int k = 1; k < side.edges(); ++k)
    for (int f : w.part.faces_at(side.vertex[k])) faces.insert(f);
  for (int f : faces) {
    normals.push_back(w.area[f].stableNormalized());
    vertices.insert(w.part[f].begin(), w.part[f].end());
  }
  std::vector<Vec3> points;
  for (int v : vertices) points.push_back(w.position[v]);
  return points;
}

/// By Gauss-Newton from the direction that the faces turn about.
std::optional<Cylinder> cylinder_through(const std::vector<Vec3>& points, const std::vector<Vec3>& normals) {
  const Index n = static_cast<Index>(points.size());
  if (n < cylinder_unknowns + least_beyond) return {};
  Eigen::Matrix3d turns = Eigen::Matrix3d::Zero(), spread = Eigen::Matrix3d::Zero();
  for (const Vec3& normal : normals) turns += normal * normal.transpose();
  Vec3 middle = Vec3::Zero();
  for (const Vec3& p : points) middle += p / static_cast<double>(n);
  for (const Vec3& p : points) spread += (p - middle) * (p - middle).transpose() / static_cast<double>(n);
  const double off_plane = std::sqrt(std::max(principal_axes(spread).values[0], 0.0));
  Cylinder c;
  c.axis = principal_axes(turns).vectors.col(0);
  Vec3 u = c.axis.unitOrthogonal(), v = c.axis.cross(u);
  const Circle circle = circle_along(points, middle, u, v);
  c.point = circle.center;
  c.radius = circle.radius;
  for (int step = 0; step < most_cylinder_steps; ++step) {
    u = c.axis.unitOrthogonal();
    v = c.axis.cross(u);
    Eigen::MatrixXd slopes(n, cylinder_unknowns), off(n, 1);
    for (Index k = 0; k < n; ++k) {
      const Vec3 out = c.outward(points[k]), way = out.normalized();
      const double along = c.axis.dot(points[k] - c.point);
      slopes.row(k) << -way.dot(u), -way.dot(v), -along * way.dot(u), -along * way.dot(v), -1;
      off(k, 0) = out.norm() - c.radius;
    }
    const Eigen::VectorXd x = least_squares(slopes, -off);
    if (!x.allFinite()) return {};
    c.point += x[0] * u + x[1] * v;
    c.axis = (c.axis + x[2] * u + x[3] * v).normalized();
    c.radius += x[4];
    if (x.norm() < last_cylinder_step) break;
  }
  for (const Vec3& p : points) c.off += std::pow(c.outward(p).norm() - c.radius, 2) / static_cast<double>(n);
  c.off = std::sqrt(c.off);
  if (!(c.off <= cylinder_within * off_plane && c.radius > 0)) return {};
  return c;
}

}  // namespace

void take_cylinder(const LocalMesh& w, SideFit& fit, SideDraft& side) {
  if (!(side.depth >= deep_faces)) return;
  const auto is_known = [&](double variance) { return variance + fit.turned < well_known * well_known; };
  if (std::all_of(fit.slope_variances.begin(), fit.slope_variances.end(), is_known)) return;
  std::vector<Vec3> normals;
  const std::vector<Vec3> points = vertices_beside(w, side, normals);
  const std::optional<Cylinder> cylinder = cylinder_through(points, normals);
  if (!cylinder) return;
  const double variance =
      std::max(std::pow(coplanar * M_PI / 180, 2), std::pow(2 * cylinder->off, 2));  // over an edge of the rim
  double before = fit.turned;
  for (double v : fit.slope_variances) before = std::max(before, v + fit.turned);
  if (!(variance < before)) return;
  for (int k = 0; k <= side.edges(); ++k) {
    Vec3 normal = cylinder->outward(side.position[k]).normalized();
    const double sign = normal.dot(mean_of_facets(w, side, k)) < 0 ? -1 : 1;
    const Vec3 around = cylinder->axis.cross(normal);
    normal *= sign;
    side.normal[k] = normal;
    side.second[k] = -sign / cylinder->radius * around * around.transpose();
    fit.slope_variances[k] = variance;
    if (k > 0 && k < side.edges()) continue;
    VertexFit& end = fit.ends[k == 0 ? 0 : 1];
    end.normal = normal;
    end.second = side.second[k];
    end.frame << cylinder->axis, around;
    end.covariance = variance * Eigen::Matrix2d::Identity();
    end.slope_variances = variance;
  }
  fit.turned = 0;
  fit.bend_variance = std::min(fit.bend_variance, variance);
}

}  // namespace tripatch
