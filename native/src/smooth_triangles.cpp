#include "tripatch/smooth_triangles.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <unordered_map>

#include "tripatch/boundary/ribbon.h"
#include "tripatch/constructions/side_vertex.h"

namespace tripatch {
namespace {

using Triangle = std::array<Index, 3>;

std::vector<Triangle> checked_triangles(const Mesh& mesh) {
  std::vector<Triangle> triangles(mesh.faces.size());
  for (Index f = 0; f < mesh.faces.size(); ++f) {
    const std::span<const Index> face = mesh.faces[f];
    const std::string name = "Face " + std::to_string(f);
    for (Index v : face)
      if (v < 0 || v >= mesh.vertices.rows())
        throw InvalidArgument(name + " names vertex " + std::to_string(v) + ", of " + std::to_string(mesh.vertices.rows()));
    if (face.size() != 3)
      throw Refusal(
          name + " has " + std::to_string(face.size()) + " corners; only triangles can be smoothed: triangulate it first",
          {face.begin(), face.end()});
    std::copy(face.begin(), face.end(), triangles[f].begin());
    for (Index v : face)
      if (!mesh.vertices.row(v).allFinite()) throw Refusal("The position of vertex " + std::to_string(v) + " is not finite", {v});
    const Vec3 a = mesh.vertices.row(face[0]), b = mesh.vertices.row(face[1]), c = mesh.vertices.row(face[2]);
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    if (!((b - a).cross(c - a).norm() > 1e-12 * longest * longest))
      throw Refusal(name + " has no area", {face.begin(), face.end()});
  }
  return triangles;
}

/// Points of the lattice of a face that lie inside it, barycentric, row by row.
Points inside_lattice(int n) {
  Points b((n - 1) * (n - 2) / 2, 3);
  Index r = 0;
  for (int j = 1; j < n; ++j)
    for (int k = 1; j + k < n; ++k) b.row(r++) << n - j - k, j, k;
  return b / n;
}

}  // namespace

Points angle_weighted_normals(const Mesh& mesh) {
  Points normals = Points::Zero(mesh.vertices.rows(), 3);
  for (Index f = 0; f < mesh.faces.size(); ++f) {
    const std::span<const Index> face = mesh.faces[f];
    for (std::size_t k = 0; k < face.size(); ++k) {
      const Vec3 p = mesh.vertices.row(face[k]);
      const Vec3 a = mesh.vertices.row(face[(k + 1) % face.size()]).transpose() - p;
      const Vec3 b = mesh.vertices.row(face[(k + face.size() - 1) % face.size()]).transpose() - p;
      const Vec3 n = a.cross(b);
      normals.row(face[k]) += std::atan2(n.norm(), a.dot(b)) * n.stableNormalized();
    }
  }
  for (Index v = 0; v < normals.rows(); ++v) {
    const double length = normals.row(v).norm();
    if (length > 1e-9) {
      normals.row(v) /= length;
    } else {
      normals.row(v).setZero();
    }
  }
  return normals;
}

SmoothMesh smooth_triangles(const Mesh& mesh, const std::optional<Points>& normals, int resolution, NormalCurve curve) {
  const Index n = mesh.vertices.rows();
  if (resolution < 1 || resolution > max_smooth_resolution)
    throw InvalidArgument("resolution must be from 1 to " + std::to_string(max_smooth_resolution));
  if (normals && normals->rows() != n)
    throw InvalidArgument("there must be a normal for each of the " + std::to_string(n) + " vertices, not " +
                          std::to_string(normals->rows()));
  const std::vector<Triangle> triangles = checked_triangles(mesh);
  const Points given = normals ? *normals : angle_weighted_normals(mesh);

  SmoothMesh out;
  std::unordered_map<Index, Index> edge_of;                      // lower vertex * n + higher vertex
  std::vector<std::array<Index, 3>> edges_of(triangles.size());  // edge k runs from corner k to corner k + 1
  std::vector<char> used(n, 0);
  for (std::size_t f = 0; f < triangles.size(); ++f)
    for (int k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(triangles[f][k], triangles[f][(k + 1) % 3]);
      used[a] = used[b] = 1;
      const auto [place, is_new] = edge_of.try_emplace(a * n + b, static_cast<Index>(out.edges.size()));
      if (is_new) out.edges.push_back({a, b});
      edges_of[f][k] = place->second;
    }

  const int cuts = resolution - 1;
  const Points inside = inside_lattice(resolution);
  const Index first_inside = n + static_cast<Index>(out.edges.size()) * cuts;
  const Index total = first_inside + static_cast<Index>(triangles.size()) * inside.rows();
  out.vertices.resize(total, 3);
  out.vertices.topRows(n) = mesh.vertices;
  out.normals = Points::Zero(total, 3);
  for (Index v = 0; v < n; ++v) {
    if (!used[v]) continue;
    const std::string name = std::to_string(v);
    if (!given.row(v).allFinite()) throw Refusal("The normal of vertex " + name + " is not finite", {v});
    const Vec3 unit = given.row(v).transpose().stableNormalized();
    if (!(std::abs(unit.norm() - 1) < 1e-9))
      throw Refusal(normals ? "The normal of vertex " + name + " is zero"
                            : "The normals of the faces around vertex " + name + " cancel: give its normal",
                    {v});
    out.normals.row(v) = unit;
  }
  const auto point = [&](Index v) -> Vec3 { return mesh.vertices.row(v); };
  const auto normal = [&](Index v) -> Vec3 { return out.normals.row(v); };

  std::vector<Side> sides(out.edges.size());
  for (std::size_t e = 0; e < sides.size(); ++e) {
    const auto [a, b] = out.edges[e];
    try {
      sides[e] = side_from_normals(point(a), normal(a), point(b), normal(b), curve);
    } catch (const Refusal& refusal) {
      std::vector<Index> where;
      for (Index w : refusal.where()) where.push_back(w == 0 ? a : b);
      std::string at = " (vertex " + std::to_string(where[0]) + ", on the edge from ";
      throw Refusal(refusal.what() + at + std::to_string(a) + " to " + std::to_string(b) + ")", where);
    }
    for (int k = 1; k <= cuts; ++k) {
      const double t = static_cast<double>(k) / resolution;
      const Index row = n + static_cast<Index>(e) * cuts + k - 1;
      out.vertices.row(row) = sides[e].c(t);
      out.normals.row(row) = sides[e].normal(t);
    }
  }

  out.faces.reserve(triangles.size() * resolution * resolution);
  std::vector<double> jets(inside.rows() * 9);
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    const Triangle& t = triangles[f];
    const Index start = first_inside + static_cast<Index>(f) * inside.rows();
    if (inside.rows() > 0) {
      // Normals may be the inner ones, or the face turned against its neighbours: the surface is the same, but r must point outwards.
      const Vec3 across = (point(t[1]) - point(t[0])).cross(point(t[2]) - point(t[0]));
      const double outer = across.dot(normal(t[0]) + normal(t[1]) + normal(t[2])) < 0 ? -1 : 1;
      Sides around;
      for (int i = 0; i < 3; ++i) {
        const int k = (i + 1) % 3;  // side i runs from corner i + 1
        const Side& side = sides[edges_of[f][k]];
        const bool forwards = t[k] < t[(k + 1) % 3];
        around[i].c = forwards ? side.c : side.c.reversed();
        around[i].r = (forwards ? outer : -outer) * (forwards ? side.r : side.r.reversed());
      }
      const SurfacePtr patch = side_vertex(make_boundary(around));
      patch->evaluate(inside.data(), inside.rows(), 1, jets.data());
      for (Index k = 0; k < inside.rows(); ++k) {
        const double* jet = &jets[9 * k];
        out.vertices.row(start + k) = Vec3::Map(jet);
        out.normals.row(start + k) = outer * Vec3::Map(jet + 3).cross(Vec3::Map(jet + 6)).stableNormalized();
      }
    }

    const auto on_edge = [&](int k, int steps) {  // `steps` from corner k towards corner k + 1
      if (steps == 0) return t[k];
      if (steps == resolution) return t[(k + 1) % 3];
      const int from_lower = t[k] < t[(k + 1) % 3] ? steps : resolution - steps;
      return n + edges_of[f][k] * cuts + from_lower - 1;
    };
    const auto lattice = [&](int j, int k) {  // barycentric (resolution - j - k, j, k) / resolution
      if (k == 0) return on_edge(0, j);
      if (j + k == resolution) return on_edge(1, k);
      if (j == 0) return on_edge(2, resolution - k);
      const int rows_before = j - 1;  // row j holds resolution - 1 - j points
      return start + rows_before * (resolution - 1) - rows_before * (rows_before + 1) / 2 + k - 1;
    };
    for (int j = 0; j < resolution; ++j)
      for (int k = 0; j + k < resolution; ++k) {
        out.faces.push_back({lattice(j, k), lattice(j + 1, k), lattice(j, k + 1)});
        if (j + k + 1 < resolution) out.faces.push_back({lattice(j + 1, k), lattice(j + 1, k + 1), lattice(j, k + 1)});
      }
  }
  return out;
}

}  // namespace tripatch
