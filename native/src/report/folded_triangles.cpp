#include "tripatch/report/folded_triangles.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <ranges>

#include "tripatch/math/angle.h"
#include "tripatch/math/interruption.h"
#include "tripatch/math/parallel.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/math/tolerant_compare.h"
#include "tripatch/math/unit_vector.h"
#include "tripatch/mesh/vertex_normals.h"

namespace tripatch {
namespace {

/// Degrees from the faces around it at which a face is turned over: a fill that continues as those do stands at another angle to
/// it than they, so that folds of 120 degrees begin here. Clear of a right angle, as of boxes. Tried on 318 holes of known
/// surfaces and in scanned meshes, with vertices off by .1, .2 and .3 of an edge. Closed with plain triangles are 24, with 90
/// degrees 23, with 110 and 120 degrees 28, and 64 if no face counts as flipped.
constexpr double turned_degrees = 100;
/// Of the areas of faces: so long is their vector area where they tell a side. A bound: of two halves at a right angle it is .7.
constexpr double agree = share::half;

/// use(its corners) for each triangle of faces that are cut into fans.
template <class Use>
void for_triangles(const Faces& faces, const Use& use) {
  const Index *const offsets = faces.offsets.data(), *const corners = faces.corners.data(), size = faces.size();
  for (Index f = 0; f < size; ++f) {
    if (f % 256 == 0) check_interruption();
    const Index first = offsets[f], end = offsets[f + 1];
    for (Index k = first + 2; k < end; ++k) use(corners[first], corners[k - 1], corners[k]);
  }
}

/// Rows of a mesh and of what is added to it, by the number of their vertex.
class Places {
public:
  Places(const PointsRef& vertices, const PointsRef& added) : vertices_(vertices), added_(added), n_(vertices.rows()) {}
  Vec3 operator()(Index v) const { return v < n_ ? vertices_.row(v) : added_.row(v - n_); }

private:
  const PointsRef &vertices_, &added_;
  Index n_;
};

bool is_folded_over_one_beside(const Mesh& mesh, const Connectivity& around, Index face) {
  const Vec3 own = area_vector(mesh, face);
  const auto corners = std::views::iota(around.faces().offsets[face], around.faces().offsets[face + 1]);
  return std::ranges::any_of(corners, [&](Connectivity::Corner c) {
    const auto beside = around.edge(around.next(c), around.faces().corners[c]);
    return beside && degrees_between(own, area_vector(mesh, around.face(*beside))) > folded_degrees;
  });
}

/// The other faces at the vertices of one.
std::vector<Index> faces_at_vertices_of(const Connectivity& around, Index face) {
  std::vector<Index> others;
  for (Index v : around.faces()[face])
    for (Connectivity::Corner c : around.at(v))
      if (around.face(c) != face) others.push_back(around.face(c));
  std::sort(others.begin(), others.end());
  others.erase(std::unique(others.begin(), others.end()), others.end());
  return others;
}

/// From what the other faces at its vertices are together.
bool turns_from_those_around(const Mesh& mesh, const Connectivity& around, Index face) {
  const std::vector<Index> others = faces_at_vertices_of(around, face);
  Vec3 way = Vec3::Zero();
  double areas = 0;
  for (Index other : others) {
    const Vec3 area = area_vector(mesh, other);
    way += area;
    areas += area.norm();
  }
  return way.norm() > agree * areas && degrees_between(area_vector(mesh, face), way) > turned_degrees;
}

}  // namespace

std::vector<AdjacentFace> faces_beyond(const Mesh& mesh, const Connectivity& around,
                                       const std::vector<std::vector<Index>>& loops) {
  std::vector<AdjacentFace> out;
  for (const std::vector<Index>& loop : loops)
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const Index from = loop[k], to = loop[(k + 1) % loop.size()];
      const auto corner = around.edge(to, from);
      out.push_back({from, to, corner ? Vec3(area_vector(mesh, around.face(*corner)).stableNormalized()) : Vec3(Vec3::Zero())});
    }
  return out;
}

std::vector<AdjacentFace> faces_beyond_rows(const Mesh& mesh, const Connectivity& around,
                                            const std::vector<std::vector<Index>>& loops) {
  std::vector<AdjacentFace> out = faces_beyond(mesh, around, loops);
  Index first = 0;
  for (const std::vector<Index>& loop : loops) {
    const Index n = static_cast<Index>(loop.size());
    for (Index k = 0; k < n; ++k) {
      out[first + k].from = first + k;
      out[first + k].to = first + (k + 1) % n;
    }
    first += n;
  }
  return out;
}

std::vector<char> flipped(const Mesh& mesh, const Connectivity& around, const std::vector<std::vector<Index>>& loops) {
  std::vector<char> out;
  for (const std::vector<Index>& loop : loops)
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const auto corner = around.edge(loop[(k + 1) % loop.size()], loop[k]);
      const std::optional<Index> face = corner ? std::optional(around.face(*corner)) : std::nullopt;
      out.push_back(face && is_folded_over_one_beside(mesh, around, *face) && turns_from_those_around(mesh, around, *face));
    }
  return out;
}

bool is_of_convex_body(const Mesh& mesh, const Connectivity& around, Index face) {
  std::vector<Index> faces = faces_at_vertices_of(around, face), vertices;
  faces.push_back(face);
  for (Index f : faces) vertices.insert(vertices.end(), around.faces()[f].begin(), around.faces()[f].end());
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return std::ranges::all_of(faces, [&](Index f) {
    const Vec3 normal = area_vector(mesh, f).stableNormalized(), on = mesh.vertices.row(around.faces()[f][0]);
    return std::ranges::all_of(vertices, [&](Index v) {
      if (std::ranges::find(around.faces()[f], v) != around.faces()[f].end()) return true;
      const Vec3 to = Vec3(mesh.vertices.row(v)) - on;
      return to.dot(normal) < -tolerance::same * to.norm();
    });
  });
}

void begin_at_shorter_diagonals(const PointsRef& vertices, const PointsRef& added, Faces& faces) {
  const Places at(vertices, added);
  for (Index f = 0; f < faces.size(); ++f) {
    if (faces[f].size() != 4) continue;
    const auto corner = faces.corners.begin() + faces.offsets[f];
    const auto apart = [&](Index a, Index b) { return (at(a) - at(b)).norm(); };
    if (clearly_less(apart(corner[1], corner[3]), apart(corner[0], corner[2]))) std::rotate(corner, corner + 1, corner + 4);
  }
}

EdgesByVertex edges_of_triangles(Index of_mesh, Index own, const Faces& faces, std::span<const AdjacentFace> beyond) {
  EdgesByVertex edges(of_mesh, own, static_cast<Index>(faces.corners.size()));
  for_triangles(faces, [&](Index a, Index b, Index c) {
    edges.count(a, b);
    edges.count(b, c);
    edges.count(c, a);
  });
  for (const AdjacentFace& face : beyond) edges.count(face.from, face.to);
  edges.counted();
  std::size_t two = 0;  // of a triangle
  const auto add = [&](Index from, Index to) { edges.add(from, to, two + (from < to ? 1 : 0)); };
  for_triangles(faces, [&](Index a, Index b, Index c) {
    add(a, b);
    add(b, c);
    add(c, a);
    two += 2;
  });
  for (const AdjacentFace& face : beyond) {
    add(face.from, face.to);
    two += 2;
  }
  return edges;
}

bool surely_unfolded(const PointsRef& vertices, const PointsRef& added, const Faces& faces,
                     std::span<const AdjacentFace> beyond) {
  const Places at(vertices, added);
  if (beyond.empty()) return false;
  const Vec3 origin = at(beyond[0].from);
  Vec3 way = Vec3::Zero();
  for (const AdjacentFace& face : beyond) way += (at(face.from) - origin).cross(at(face.to) - origin);
  way = unit_vector(way);
  for (const AdjacentFace& face : beyond)
    if (!face.normal.isZero(0)) {
      if (face.normal.dot(way) < 0) way = -way;
      break;
    }
  constexpr double clearly = tolerance::solved + 1;  // a million times what rounding does to unit vectors
  const double cosine = std::cos(folded_degrees / 2 * std::numbers::pi / 180), least = clearly * cosine * cosine;
  const auto leans_little = [&](const Vec3& normal) {
    const double along = normal.dot(way);
    return along > 0 && along * along > least * normal.squaredNorm();
  };
  for (const AdjacentFace& face : beyond)
    if (!face.normal.isZero(0) && !leans_little(face.normal)) return false;
  return holds_for_all(faces.size(), [&](Index f) {
    const Index *const corner = faces.corners.data() + faces.offsets[f], *const end = faces.corners.data() + faces.offsets[f + 1];
    const Vec3 first = at(corner[0]);
    for (const Index* next = corner + 2; next < end; ++next)
      if (!leans_little((at(next[-1]) - first).cross(at(*next) - first))) return false;
    return true;
  });
}

namespace {

/// use(one vertex, the other) for each other triangle that is folded over the first along an edge. edges: as of count_folded_edges.
template <class Use>
void for_folded_edges(const PointsRef& vertices, const PointsRef& added, const Faces& faces, std::span<const AdjacentFace> beyond,
                      EdgesByVertex& edges, const Use& use) {
  const Places at(vertices, added);
  std::vector<Vec3> normals;
  normals.reserve(faces.corners.size() + beyond.size());
  for_triangles(faces, [&](Index a, Index b, Index c) {
    const Vec3 first = at(a);
    normals.push_back(unit_vector((at(b) - first).cross(at(c) - first)));
  });
  const std::size_t own = normals.size();  // those beyond count only where one of these is
  for (const AdjacentFace& face : beyond) normals.push_back(face.normal.stableNormalized());
  const double cosine = std::cos(folded_degrees * std::numbers::pi / 180);
  edges.for_edges([&](Index high, std::span<const EdgeUse> along) {
    const std::size_t first = along[0].what / 2;
    if (first >= own) return;
    for (const EdgeUse& other : along.subspan(1))
      if (normals[other.what / 2].dot(normals[first]) < cosine) use(static_cast<Index>(other.low), high);
  });
}

}  // namespace

Index count_folded_edges(const PointsRef& vertices, const PointsRef& added, const Faces& faces,
                         std::span<const AdjacentFace> beyond, EdgesByVertex& edges) {
  if (surely_unfolded(vertices, added, faces, beyond)) return 0;
  Index count = 0;
  for_folded_edges(vertices, added, faces, beyond, edges, [&](Index, Index) { ++count; });
  return count;
}

Index count_folded_edges(const PointsRef& vertices, const PointsRef& added, const Faces& faces,
                         std::span<const AdjacentFace> beyond) {
  if (surely_unfolded(vertices, added, faces, beyond)) return 0;
  EdgesByVertex edges = edges_of_triangles(vertices.rows(), added.rows(), faces, beyond);
  return count_folded_edges(vertices, added, faces, beyond, edges);
}

Index count_folded_edges(const PointsRef& points, const Triangles& triangles, std::span<const AdjacentFace> beyond) {
  return count_folded_edges(points, Points(0, 3), faces_of(triangles), beyond);
}

std::vector<std::array<Index, 2>> folded_edges(const PointsRef& vertices, const PointsRef& added, const Faces& faces,
                                               std::span<const AdjacentFace> beyond) {
  Faces cut = faces;
  begin_at_shorter_diagonals(vertices, added, cut);
  EdgesByVertex edges = edges_of_triangles(vertices.rows(), added.rows(), cut, beyond);
  std::vector<std::array<Index, 2>> out;
  for_folded_edges(vertices, added, cut, beyond, edges, [&](Index a, Index b) { out.push_back({a, b}); });
  return out;
}

}  // namespace tripatch
