#include "tripatch/smooth_triangles.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <map>
#include <string>
#include <unordered_map>

#include "tripatch/boundary/ribbon.h"
#include "tripatch/constructions/side_vertex.h"
#include "tripatch/math/angle.h"
#include "tripatch/math/tolerances.h"
#include "tripatch/mesh/edge_key.h"
#include "tripatch/mesh/vertex_normals.h"
#include "tripatch/messages.h"
#include "tripatch/patch/seam.h"

namespace tripatch {
namespace {

using Triangle = std::array<Index, 3>;

std::vector<Triangle> checked_triangles(const Mesh& mesh) {
  std::vector<Triangle> triangles(mesh.faces.size());
  for (Index f = 0; f < mesh.faces.size(); ++f) {
    const IndicesRef face = mesh.faces[f];
    for (Index v : face)
      if (v < 0 || v >= mesh.vertices.rows())
        throw CodedArgument(Code::no_such_vertex,
                            {{"option", "faces[" + std::to_string(f) + "]"}, {"vertex", v}, {"count", mesh.vertices.rows()}});
    if (face.size() != 3)
      throw CodedRefusal(Code::face_is_no_triangle, {{"face", f}, {"corners", face.size()}}, {face.begin(), face.end()});
    std::copy(face.begin(), face.end(), triangles[f].begin());
    for (Index v : face)
      if (!mesh.vertices.row(v).allFinite()) throw CodedRefusal(Code::position_not_finite, {v});
    const Vec3 a = mesh.vertices.row(face[0]), b = mesh.vertices.row(face[1]), c = mesh.vertices.row(face[2]);
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    if (!((b - a).cross(c - a).norm() > tolerance::rounding * longest * longest))
      throw CodedRefusal(Code::face_without_area, {{"face", f}}, {face.begin(), face.end()});
  }
  return triangles;
}

/// Places and normals that came of the vertices of a face or an edge.
void check_finite(const Points& points, Index row, std::span<const Index> of) {
  if (!points.row(row).allFinite())
    throw CodedRefusal(Code::coordinates_too_large, {{"near", std::vector<Index>{of[0]}}}, {of.begin(), of.end()});
}

/// Barycentric points (resolution - j - k, j, k) / resolution of a face that lie inside it, row by row.
Points inside_lattice(int resolution) {
  Points b((resolution - 1) * (resolution - 2) / 2, 3);
  Index r = 0;
  for (int j = 1; j < resolution; ++j)
    for (int k = 1; j + k < resolution; ++k) b.row(r++) << resolution - j - k, j, k;
  return b / resolution;
}

/// The edges of the triangles and the numbers of the new vertices: those of the mesh, of the edges, inside the faces.
struct Lattice {
  int resolution;
  const std::vector<Triangle>& triangles;
  Index vertices;
  std::vector<std::array<Index, 2>> edges;
  std::vector<std::array<Index, 3>> edges_of;  ///< of each triangle; edge k runs from corner k to corner k + 1

  Lattice(const std::vector<Triangle>& all, Index n, int cuts) : resolution(cuts), triangles(all), vertices(n) {
    std::unordered_map<Index, Index> known;  // lower vertex * n + higher vertex
    for (const Triangle& t : triangles) {
      std::array<Index, 3>& mine = edges_of.emplace_back();
      for (int k = 0; k < 3; ++k) {
        const auto [a, b] = std::minmax(t[k], t[(k + 1) % 3]);
        const auto [place, is_new] = known.try_emplace(a * n + b, static_cast<Index>(edges.size()));
        if (is_new) edges.push_back({a, b});
        mine[k] = place->second;
      }
    }
  }

  Index per_edge() const { return resolution - 1; }
  Index per_face() const { return (resolution - 1) * (resolution - 2) / 2; }
  /// Point k = 1 .. resolution - 1 of an edge, from its lower vertex.
  Index on_edge(Index edge, int k) const { return vertices + edge * per_edge() + k - 1; }
  Index first_inside(std::size_t face) const {
    return vertices + static_cast<Index>(edges.size()) * per_edge() + static_cast<Index>(face) * per_face();
  }
  Index total() const { return first_inside(triangles.size()); }

  /// `steps` from corner k of a face towards corner k + 1.
  Index along(std::size_t face, int k, int steps) const {
    const Triangle& t = triangles[face];
    if (steps == 0) return t[k];
    if (steps == resolution) return t[(k + 1) % 3];
    return on_edge(edges_of[face][k], t[k] < t[(k + 1) % 3] ? steps : resolution - steps);
  }
  /// At barycentric (resolution - j - k, j, k) / resolution of a face.
  Index at(std::size_t face, int j, int k) const {
    if (k == 0) return along(face, 0, j);
    if (j + k == resolution) return along(face, 1, k);
    if (j == 0) return along(face, 2, resolution - k);
    const int rows_before = j - 1;  // row j holds resolution - 1 - j points
    return first_inside(face) + rows_before * (resolution - 1) - rows_before * (rows_before + 1) / 2 + k - 1;
  }
};

/// The vertices' normals as unit vectors, where a face uses them.
void take_normals(const Points& given, bool estimated, const Lattice& lattice, Points& normals) {
  std::vector<char> used(lattice.vertices, 0);
  for (const auto& edge : lattice.edges) used[edge[0]] = used[edge[1]] = 1;
  for (Index v = 0; v < lattice.vertices; ++v) {
    if (!used[v]) continue;
    if (!given.row(v).allFinite()) throw CodedRefusal(Code::normal_not_finite, {v});
    const Vec3 normal = given.row(v);
    if (!(normal.stableNorm() >= std::numeric_limits<double>::min()))
      throw CodedRefusal(estimated ? Code::normals_cancel : Code::normal_zero, {v});
    normals.row(v) = normal.stableNormalized();
  }
}

/// A curve with a normal field over each edge.
std::vector<Side> smooth_edges(const Lattice& lattice, NormalCurve curve, const SmoothMesh& out) {
  const auto point = [&](Index v) -> Vec3 { return out.vertices.row(v); };
  const auto normal = [&](Index v) -> Vec3 { return out.normals.row(v); };
  std::vector<Side> sides(lattice.edges.size());
  for (std::size_t e = 0; e < sides.size(); ++e) {
    const auto [a, b] = lattice.edges[e];
    try {
      sides[e] = side_from_normals(point(a), normal(a), point(b), normal(b), curve);
    } catch (const CodedRefusal& refusal) {
      Message message = with_vertices(refusal.message(), [a = a, b = b](Index w) -> Index { return w == 0 ? a : b; });
      message.parameters.push_back({"edge", std::vector<Index>{a, b}});
      throw CodedRefusal(std::move(message));
    }
  }
  return sides;
}

/// The points on the edges.
void cut_edges(const Lattice& lattice, const std::vector<Side>& sides, SmoothMesh& out) {
  for (std::size_t e = 0; e < sides.size(); ++e)
    for (int k = 1; k < lattice.resolution; ++k) {
      const double t = static_cast<double>(k) / lattice.resolution;
      const Index row = lattice.on_edge(static_cast<Index>(e), k);
      out.vertices.row(row) = sides[e].c(t);
      out.normals.row(row) = sides[e].normal(t);
      check_finite(out.vertices, row, lattice.edges[e]);
      check_finite(out.normals, row, lattice.edges[e]);
    }
}

/// The points inside each face, on a side-vertex patch between the curves of its edges; keep: the patches too.
void smooth_faces(const Lattice& lattice, const std::vector<Side>& sides, bool keep, SmoothMesh& out) {
  const auto point = [&](Index v) -> Vec3 { return out.vertices.row(v); };
  const auto normal = [&](Index v) -> Vec3 { return out.normals.row(v); };
  const Points inside = inside_lattice(lattice.resolution);
  if (inside.rows() == 0 && !keep) return;
  std::vector<double> jets(inside.rows() * 9);
  for (std::size_t f = 0; f < lattice.triangles.size(); ++f) {
    const Triangle& t = lattice.triangles[f];
    // Normals may be the inner ones, or the face turned against its neighbors: the surface is the same, but r must point outwards.
    const Vec3 across = (point(t[1]) - point(t[0])).cross(point(t[2]) - point(t[0]));
    const double outer = across.dot(normal(t[0]) + normal(t[1]) + normal(t[2])) < 0 ? -1 : 1;
    Sides around;
    for (int i = 0; i < 3; ++i) {
      const int k = (i + 1) % 3;  // side i runs from corner i + 1
      const Side& side = sides[lattice.edges_of[f][k]];
      const bool forwards = t[k] < t[(k + 1) % 3];
      around[i].c = forwards ? side.c : side.c.reversed();
      around[i].r = (forwards ? outer : -outer) * (forwards ? side.r : side.r.reversed());
    }
    const SurfacePtr patch = side_vertex(make_boundary(around));
    if (keep) out.patches.push_back(patch);
    patch->evaluate(inside.data(), inside.rows(), 1, jets.data());
    for (Index k = 0; k < inside.rows(); ++k) {
      const double* jet = &jets[9 * k];
      const Index row = lattice.first_inside(f) + k;
      out.vertices.row(row) = Vec3::Map(jet);
      out.normals.row(row) = outer * Vec3::Map(jet + 3).cross(Vec3::Map(jet + 6)).stableNormalized();
      check_finite(out.vertices, row, t);
      check_finite(out.normals, row, t);
    }
  }
}

std::vector<Triangle> small_triangles(const Lattice& lattice) {
  std::vector<Triangle> faces;
  const int n = lattice.resolution;
  faces.reserve(lattice.triangles.size() * n * n);
  for (std::size_t f = 0; f < lattice.triangles.size(); ++f)
    for (int j = 0; j < n; ++j)
      for (int k = 0; j + k < n; ++k) {
        const Index right = lattice.at(f, j + 1, k), up = lattice.at(f, j, k + 1);
        faces.push_back({lattice.at(f, j, k), right, up});
        if (j + k + 1 < n) faces.push_back({right, lattice.at(f, j + 1, k + 1), up});
      }
  return faces;
}

/// Of each edge of the triangles the side that is given for it, from its lower vertex.
std::vector<Side> sides_over(const Lattice& lattice, const std::vector<std::array<Index, 2>>& edges,
                             const std::vector<Side>& given, const SmoothMesh& out) {
  std::map<EdgeKey, std::size_t> known;
  for (std::size_t e = 0; e < edges.size(); ++e) known[edge_key(edges[e][0], edges[e][1])] = e;
  std::vector<Side> sides;
  for (const std::array<Index, 2>& edge : lattice.edges) {
    const auto found = known.find(edge);
    if (found == known.end()) throw CodedRefusal(Code::no_curve_given, {edge[0], edge[1]});
    const Side& own = given[found->second];
    Side& side = sides.emplace_back(own);
    if (edges[found->second][0] != edge[0]) side = {own.c.reversed(), -1.0 * own.r.reversed(), {}};
    const Vec3 from = Vec3(out.vertices.row(edge[0])) - side.c(0), to = Vec3(out.vertices.row(edge[1])) - side.c(1);
    const double gap = std::max(from.norm(), to.norm()), length = (out.vertices.row(edge[0]) - out.vertices.row(edge[1])).norm();
    if (!(gap <= tolerance::same * length)) throw CodedRefusal(Code::curve_off_vertices, {{"gap", gap}}, {edge[0], edge[1]});
    side = moved_ends(std::move(side), from, to);
  }
  return sides;
}

/// Of each vertex the normal that all curves have there.
void take_common_normals(const Lattice& lattice, const std::vector<Side>& sides, SmoothMesh& out) {
  std::vector<std::vector<Vec3>> at(lattice.vertices);
  for (std::size_t e = 0; e < sides.size(); ++e)
    for (int end = 0; end < 2; ++end) at[lattice.edges[e][end]].push_back(sides[e].normal(end));
  for (Index v = 0; v < lattice.vertices; ++v) {
    if (at[v].empty()) continue;
    Vec3 sum = Vec3::Zero();
    for (const Vec3& n : at[v]) sum += n;
    const Vec3 normal = sum.stableNormalized();
    out.normals.row(v) = normal;
    double off = 0;
    for (const Vec3& n : at[v]) off = std::max(off, n.norm() > 0 ? degrees_between(n, normal) : 90);
    if (off > tolerance::same) throw CodedRefusal(Code::curve_planes_differ, {{"angle", off}}, {v});
  }
}

/// The edges of the triangles of a mesh and its own vertices.
Lattice begun(const Mesh& mesh, const std::vector<Triangle>& triangles, int resolution, SmoothMesh& out) {
  const Index n = mesh.vertices.rows();
  Lattice lattice(triangles, n, resolution);
  out.vertices.resize(lattice.total(), 3);
  out.vertices.topRows(n) = mesh.vertices;
  out.normals = Points::Zero(lattice.total(), 3);
  return lattice;
}

void check_resolution(int resolution) {
  if (resolution < 1 || resolution > max_smooth_resolution)
    throw CodedArgument(Code::out_of_range,
                        {{"name", "resolution"}, {"from", 1}, {"to", max_smooth_resolution}, {"value", resolution}});
}

/// The faces between curves over all edges.
void complete(Lattice& lattice, const std::vector<Side>& sides, bool keep, SmoothMesh& out) {
  cut_edges(lattice, sides, out);
  smooth_faces(lattice, sides, keep, out);
  out.faces = small_triangles(lattice);
  out.edges = std::move(lattice.edges);
}

}  // namespace

SmoothMesh network(const Mesh& mesh, const std::vector<std::array<Index, 2>>& edges, const std::vector<Side>& given,
                   int resolution) {
  check_resolution(resolution);
  const std::vector<Triangle> triangles = checked_triangles(mesh);
  SmoothMesh out;
  Lattice lattice = begun(mesh, triangles, resolution, out);
  const std::vector<Side> sides = sides_over(lattice, edges, given, out);
  take_common_normals(lattice, sides, out);
  complete(lattice, sides, true, out);
  return out;
}

SmoothMesh smooth_triangles(const Mesh& mesh, const std::optional<Points>& normals, int resolution, NormalCurve curve,
                            bool keep) {
  const Index n = mesh.vertices.rows();
  check_resolution(resolution);
  if (normals && normals->rows() != n)
    throw InvalidArgument("there must be a normal for each of the " + std::to_string(n) + " vertices, not " +
                          std::to_string(normals->rows()));
  const std::vector<Triangle> triangles = checked_triangles(mesh);
  SmoothMesh out;
  Lattice lattice = begun(mesh, triangles, resolution, out);
  take_normals(normals ? *normals : vertex_normals(mesh), !normals, lattice, out.normals);
  const std::vector<Side> sides = smooth_edges(lattice, curve, out);
  complete(lattice, sides, keep, out);
  return out;
}

}  // namespace tripatch
