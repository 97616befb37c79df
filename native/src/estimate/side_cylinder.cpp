#include "tripatch/estimate/side_cylinder.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>

#include "tripatch/estimate/circle.h"
#include "tripatch/math/decompositions.h"
#include "tripatch/math/linear.h"
#include "tripatch/math/thresholds.h"

namespace tripatch {
namespace {

/// Unknowns of a cylinder, and vertices beyond these that tell whether there is one.
constexpr int cylinder_unknowns = 5, min_beyond = count::few;

/// Edges that the faces are deep: vertices on two circles are on a cylinder and on any surface of revolution through these. Meshes follow their
/// surfaces, so that long faces bend little along them; squares next to a torus, of 1.6, hide 3 degrees.
constexpr double deep_faces = factor::large;
/// Where they are not so deep the cylinder has to end behind them. A sine and a cosine of angles to the way across: of edges
/// that continue a ruling.
constexpr double off_way = share::tenth, ahead = share::most;
/// Of what a strip would turn if it bent as what lies behind it: the turn there is within this of what ends a straight one. Circles of even
/// edges are to rounding, and strips that bend are off by all of it.
constexpr double clear_end = share::quarter;
/// Inner vertices of a side that say so, at least; none says otherwise.
constexpr int min_asked = count::pair;

struct Cylinder {
  Vec3 point, axis;            // axis: unit
  double radius = 0, off = 0;  // off: root mean square
  Vec3 outward(const Vec3& p) const {
    const Vec3 d = p - point;
    return d - axis * axis.dot(d);
  }
};

/// The vertices of the faces at the inner vertices of a side: all of them are of the surface that continues there.
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

/// From a vertex to the one next to it that lies most nearly one way, and not aside (both unit).
std::optional<int> vertex_ahead(const LocalMesh& w, int v, const Vec3& way, const Vec3& aside, double off) {
  std::optional<int> best;
  double most = ahead;
  for (int f : w.part.faces_at(v))
    for (int u : w.part[f]) {
      const Vec3 to = (w.position[u] - w.position[v]).normalized();
      if (u == v || !(std::abs(to.dot(aside)) < off && to.dot(way) > most)) continue;
      most = to.dot(way);
      best = u;
    }
  return best;
}

/// From a vertex on a cylinder along its ruling, which is an edge, and over two more; nothing where the mesh does not lead that way.
std::optional<std::array<Vec3, 3>> steps_across(const LocalMesh& w, int v, const Vec3& ruling, const Vec3& around) {
  std::array<Vec3, 3> steps;
  Vec3 way = ruling;
  for (int j = 0; j < 3; ++j) {
    const std::optional<int> next = vertex_ahead(w, v, way, around, j == 0 ? tolerance::slight : off_way);
    if (!next) return {};
    steps[j] = w.position[*next] - w.position[v];
    way = steps[j].normalized();
    v = *next;
  }
  return steps;
}

/// Whether the faces next to a side are straight across it, and what lies behind them bends: between the chord of a circle and a line that is
/// its tangent there is half of the turn that is between two chords.
bool ends_behind(const LocalMesh& w, const SideDraft& side, const Cylinder& cylinder) {
  int asked = 0;
  for (int k = 1; k < side.edges(); ++k) {
    const Vec3 out = cylinder.outward(side.position[k]).normalized(), around = cylinder.axis.cross(out);
    auto steps = steps_across(w, side.vertex[k], cylinder.axis, around);
    if (!steps) steps = steps_across(w, side.vertex[k], -cylinder.axis, around);
    if (!steps) continue;
    const auto rise = [&](int j) { return std::atan2((*steps)[j].dot(out), std::abs((*steps)[j].dot(cylinder.axis))); };
    const double first = (*steps)[0].norm(), second = (*steps)[1].norm(), third = (*steps)[2].norm();
    const double turn = rise(1), bend = (rise(2) - turn) / (second + third);
    if (!(std::abs(turn - bend * second) < clear_end * std::abs(bend * first))) return false;
    ++asked;
  }
  return asked >= min_asked;
}

/// By Gauss-Newton from the direction that the faces turn about.
std::optional<Cylinder> cylinder_through(const std::vector<Vec3>& points, const std::vector<Vec3>& normals) {
  const Index n = static_cast<Index>(points.size());
  if (n < cylinder_unknowns + min_beyond) return {};
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
  for (int step = 0; step < tolerance::newton_steps; ++step) {
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
    if (x.norm() < tolerance::fit) break;
  }
  for (const Vec3& p : points) c.off += std::pow(c.outward(p).norm() - c.radius, 2) / static_cast<double>(n);
  c.off = std::sqrt(c.off);
  if (!(c.off <= tolerance::slight * off_plane && c.radius > 0)) return {};
  return c;
}

/// Whether the faces next to a side turn, and about one line, as those of a cylinder do: asked of three, before anything is fitted.
bool turns_about_line(const LocalMesh& w, const SideDraft& side) {
  const Vec3 first = w.area[side.face.front()].normalized(), last = w.area[side.face.back()].normalized(),
             middle = w.area[side.face[side.face.size() / 2]].normalized(), line = first.cross(last);
  return line.norm() > tolerance::slight && std::abs(line.normalized().dot(middle)) < tolerance::same;
}

}  // namespace

void take_cylinder(const LocalMesh& w, SideFit& fit, SideDraft& side) {
  const auto is_known = [&](double variance) { return variance + fit.turned < well_known * well_known; };
  const bool deep = side.depth >= deep_faces;
  // fits across the end of a strip are sure of themselves, and wrong
  if (deep ? std::all_of(fit.slope_variances.begin(), fit.slope_variances.end(), is_known) : !turns_about_line(w, side)) return;
  std::vector<Vec3> normals;
  const std::vector<Vec3> points = vertices_beside(w, side, normals);
  const std::optional<Cylinder> cylinder = cylinder_through(points, normals);
  if (!cylinder || !(deep || ends_behind(w, side, *cylinder))) return;
  const double variance =
      std::max(std::pow(coplanar * std::numbers::pi / 180, 2), std::pow(2 * cylinder->off, 2));  // over an edge of the rim
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
