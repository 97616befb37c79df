#include "tripatch/hole/rim_shape.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "tripatch/math/angle.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/math/tolerant_compare.h"
#include "tripatch/mesh/vertex_normals.h"

namespace tripatch {
namespace {

using Loop = std::vector<Index>;

constexpr double normal_share = share::third;  ///< of the window: where the tangent plane is read

/// Twice the vector area of the triangle at a corner of a face, to the side of the whole face's: where a face is not convex, as next to a
/// hole that was cut into it, corners turn the other way.
Vec3 area_at_corner(const Mesh& mesh, const Connectivity& around, Connectivity::Corner c, Index v, double scale) {
  const auto p = mesh.vertices.row(v);
  const Vec3 a = (mesh.vertices.row(around.next(c)) - p).transpose() * scale;
  const Vec3 b = (mesh.vertices.row(around.previous(c)) - p).transpose() * scale;
  const Vec3 area = a.cross(b);
  const Index face = around.face(c);
  if (mesh.faces[face].size() == 3) return area;
  return area.dot(area_vector(mesh, face)) < 0 ? Vec3(-area) : area;
}

/// Normals along the rim: those of the vector area of the faces around, summed over the window. That of triangles is linear in the
/// vertices, so that noise cancels even where it turns faces over.
Points rim_normals(const Mesh& mesh, const Connectivity& around, const Loop& rim, const std::vector<double>& length,
                   double scale) {
  const Index n = static_cast<Index>(rim.size());
  const double window = normal_share * window_share * std::accumulate(length.begin(), length.end(), 0.0);
  Points area = Points::Zero(n, 3);
  for (Index k = 0; k < n; ++k)
    for (const Connectivity::Corner c : around.at(rim[k])) area.row(k) += area_at_corner(mesh, around, c, rim[k], scale);
  // running sums over three rounds
  std::vector<double> s(3 * n, 0);
  Points sum = Points::Zero(3 * n + 1, 3);
  for (Index k = 0; k < 3 * n; ++k) {
    if (k > 0) s[k] = s[k - 1] + length[(k - 1) % n];
    sum.row(k + 1) = sum.row(k) + area.row(k % n);
  }
  Points normals(n, 3);
  Index first = 0, last = 0;
  for (Index k = n; k < 2 * n; ++k) {
    while (at_least(s[k] - s[first], window)) ++first;
    last = std::max(last, k);
    while (clearly_less(s[last + 1] - s[k], window)) ++last;
    normals.row(k - n) = (sum.row(last + 1) - sum.row(first)).transpose().stableNormalized();
  }
  // where all faces are needles without area, the next normal along the rim serves
  for (Index k = 2 * n - 2; k >= 0; --k)
    if (normals.row(k % n).isZero(0)) normals.row(k % n) = normals.row((k + 1) % n);
  return normals;
}

/// How far the rim turns at each vertex, radians, positive at a convex corner of the hole: the angle between the two rim edges in the
/// tangent plane of the faces there.
std::vector<double> turns_at_vertices(const Points& edges, const Points& normals) {
  const Index n = edges.rows();
  std::vector<double> turn(n);
  for (Index k = 0; k < n; ++k) {
    const Vec3 normal = normals.row(k), before = edges.row((k + n - 1) % n), after = edges.row(k);
    const Vec3 a = before - before.dot(normal) * normal, b = after - after.dot(normal) * normal;
    const double sine = a.cross(b).dot(normal);  // of edges that go back where they came from it is rounding
    turn[k] = std::atan2(std::abs(sine) > tie * a.norm() * b.norm() ? sine : 0, a.dot(b));
  }
  return turn;
}

/// With their longest coordinate 1, and what they were multiplied by.
std::pair<Points, double> scaled_edges(const Mesh& mesh, const Loop& rim) {
  const Index n = static_cast<Index>(rim.size());
  Points edges(n, 3);
  for (Index k = 0; k < n; ++k) edges.row(k) = mesh.vertices.row(rim[(k + 1) % n]) - mesh.vertices.row(rim[k]);
  const double scale = 1 / edges.cwiseAbs().maxCoeff();
  edges *= scale;
  return {edges, scale};
}

}  // namespace

RimShape measure(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim) {
  const auto [edges, scale] = scaled_edges(mesh, rim);
  RimShape shape;
  for (Index k = 0; k < edges.rows(); ++k) shape.length.push_back(edges.row(k).norm());
  const Points normals = rim_normals(mesh, around, rim, shape.length, scale);
  shape.turn = turns_at_vertices(edges, normals);
  shape.without_area = normals.row(0).isZero(0);
  return shape;
}

RimShape measure_alone(const Mesh& mesh, const std::vector<Index>& rim) {
  const Points edges = scaled_edges(mesh, rim).first;
  const Index n = edges.rows();
  Vec3 area = Vec3::Zero(), at = Vec3::Zero();
  for (Index k = 0; k < n; ++k) {
    area += at.cross(Vec3(edges.row(k)));
    at += Vec3(edges.row(k));
  }
  RimShape shape;
  for (Index k = 0; k < n; ++k) {
    const Vec3 before = edges.row((k + n - 1) % n), after = edges.row(k);
    shape.length.push_back(after.norm());
    const Vec3 across = before.cross(after);  // across the plane of the rim, as in steps of a box, it turns neither way
    shape.turn.push_back(angle_between(before, after) * (across.dot(area) < -tie * across.norm() * area.norm() ? -1 : 1));
  }
  return shape;
}

double zigzag(const Mesh& mesh, const Loop& rim, std::span<const Index> places) {
  const Index n = static_cast<Index>(rim.size());
  const auto direction = [&](Index k) -> Vec3 {
    const auto a = mesh.vertices.row(rim[k % n]), b = mesh.vertices.row(rim[(k + 1) % n]);
    return Vec3(b - a).stableNormalized();
  };
  std::vector<double> off;
  const auto look_at = [&](Index k) { off.push_back((direction(k) - 0.5 * (direction(k + n - 1) + direction(k + 1))).norm()); };
  if (places.empty())
    for (Index k = 0; k < n; ++k) look_at(k);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Index first = places[i], edges = (places[(i + 1) % places.size()] - first + n) % n;
    for (Index k = 1; k + 1 < edges; ++k) look_at(first + k);
  }
  if (off.empty()) return 0;
  const auto third = off.begin() + static_cast<std::ptrdiff_t>((off.size() - 1) / 3);
  std::nth_element(off.begin(), third, off.end());
  return *third;
}

double diameter(const Points& rim) {
  if (!rim.allFinite()) return NAN;
  // from the farthest from the middle on, so that most pairs are too near each other to be looked at
  const Vec3 middle = rim.colwise().mean();
  const Eigen::VectorXd reach = (rim.rowwise() - middle.transpose()).rowwise().norm();
  std::vector<Index> order(rim.rows());
  std::iota(order.begin(), order.end(), Index{0});
  std::sort(order.begin(), order.end(), [&](Index a, Index b) { return reach[a] > reach[b]; });
  const Points points = rim(order, Eigen::all);
  const Eigen::VectorXd far = reach(order);
  double largest = 0, square = 0;
  for (Index i = 0; i < points.rows() && 2 * far[i] >= largest; ++i)
    for (Index k = i + 1; k < points.rows() && far[i] + far[k] >= largest; ++k)
      if (const double each = (points.row(i) - points.row(k)).squaredNorm(); each > square) {
        square = each;
        largest = std::sqrt(each);
      }
  return largest;
}

double diameter(const Mesh& mesh, const std::vector<Index>& rim) { return diameter(Points(mesh.vertices(rim, Eigen::all))); }

bool exceeds_hole_bounds(const Mesh& mesh, const std::vector<Index>& rim, const Points& inside) {
  // Nearly always all are as near to one vertex of the rim as another vertex is, and the hole is as large at least.
  const Points around = mesh.vertices(rim, Eigen::all);
  const auto squares = [&](const Points& points) { return (points.rowwise() - around.row(0)).rowwise().squaredNorm().eval(); };
  if ((squares(inside).array() <= squares(around).maxCoeff()).all()) return false;
  const double size = diameter(mesh, rim);
  for (Index k = 0; k < inside.rows(); ++k)
    if (std::none_of(rim.begin(), rim.end(), [&](Index v) { return (mesh.vertices.row(v) - inside.row(k)).norm() <= size; }))
      return true;
  return false;
}

}  // namespace tripatch
