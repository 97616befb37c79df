#include "tripatch/report/passages.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>

#include "tripatch/cage/limit_mesh.h"
#include "tripatch/math/box_tree.h"
#include "tripatch/math/interruption.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/report/crossings.h"

namespace tripatch {
namespace {

using Corners = std::array<Vec3, 3>;
using Passed = std::vector<std::optional<Vec3>>;

struct FlatTriangle {
  Corners p;
  Vec3 normal;  // of unit length
  double longest;
  Index fill;
  BoxTree::Box box;
};

/// Nothing of a triangle without area.
std::optional<FlatTriangle> flat_triangle(const Corners& p, Index fill) {
  const Vec3 u = p[1] - p[0], v = p[2] - p[0], w = p[2] - p[1];
  const Vec3 normal = u.cross(v).stableNormalized();
  if (normal.isZero() || !normal.allFinite()) return {};
  FlatTriangle t{p, normal, std::max({u.norm(), v.norm(), w.norm()}), fill, {}};
  for (const Vec3& q : p) t.box.extend(q);
  return t;
}

/// Where an edge of one of two triangles goes through the other.
std::optional<Vec3> place_through(const FlatTriangle& a, const FlatTriangle& b) {
  const double least = tolerance::same * std::max(a.longest, b.longest);
  for (int k = 0; k < 3; ++k) {
    if (const auto where = passage(a.p[k], a.p[(k + 1) % 3], b.p, b.normal, least)) return where;
    if (const auto where = passage(b.p[k], b.p[(k + 1) % 3], a.p, a.normal, least)) return where;
  }
  return {};
}

/// A fan from the first corner.
void add_triangles(std::span<const Vec3> corners, Index fill, std::vector<FlatTriangle>& triangles) {
  for (std::size_t c = 2; c < corners.size(); ++c)
    if (auto t = flat_triangle({corners[0], corners[c - 1], corners[c]}, fill)) triangles.push_back(*t);
}

/// Of the triangles of fills, what faces pass through.
class Passages {
public:
  /// vertices: by fill those that it shares with the mesh, in order.
  Passages(std::vector<FlatTriangle> triangles, std::vector<std::vector<Index>> vertices)
      : found(vertices.size()), triangles_(std::move(triangles)), vertices_(std::move(vertices)), tree_(boxes()) {}

  bool is_near(const BoxTree::Box& box) const {
    bool any = false;
    tree_.each_meeting(box, [&](std::size_t) { any = true; });
    return any;
  }

  /// The triangles that meet a box, in order: the place that is found in a fill does not depend on what else is looked at.
  void find_near(const BoxTree::Box& box, std::vector<std::size_t>& near) const {
    near.clear();
    tree_.each_meeting(box, [&](std::size_t k) { near.push_back(k); });
    std::ranges::sort(near);
  }

  /// A face, or a piece of it. face: its vertices; own: its fill.
  void look(const IndicesRef& face, std::span<const Vec3> corners, Index own = -1) {
    find_near(box_around(corners), near_);
    for (const std::size_t k : near_) look_at(k, face, corners, own);
  }
  /// A face of no fill. near: all triangles that it meets, and perhaps others.
  void look_among(std::span<const std::size_t> near, const IndicesRef& face, std::span<const Vec3> corners) {
    const BoxTree::Box box = box_around(corners);
    for (const std::size_t k : near)
      if (triangles_[k].box.intersects(box)) look_at(k, face, corners, -1);
  }

  Passed found;

private:
  std::vector<BoxTree::Box> boxes() const {
    std::vector<BoxTree::Box> all;
    for (const FlatTriangle& each : triangles_) all.push_back(each.box);
    return all;
  }

  static BoxTree::Box box_around(std::span<const Vec3> corners) {
    BoxTree::Box box;
    for (const Vec3& corner : corners) box.extend(corner);
    return box;
  }

  void look_at(std::size_t k, const IndicesRef& face, std::span<const Vec3> corners, Index own) {
    const FlatTriangle& of_fill = triangles_[k];
    std::optional<Vec3>& place = found[of_fill.fill];
    if (place || of_fill.fill == own || shares_vertex(face, of_fill.fill)) return;
    for (std::size_t c = 2; c < corners.size() && !place; ++c)
      if (const auto other = flat_triangle({corners[0], corners[c - 1], corners[c]}, own)) place = place_through(*other, of_fill);
  }

  bool shares_vertex(const IndicesRef& face, Index fill) const {
    return std::ranges::any_of(face, [&](Index v) { return std::ranges::binary_search(vertices_[fill], v); });
  }

  std::vector<FlatTriangle> triangles_;
  std::vector<std::vector<Index>> vertices_;
  BoxTree tree_;
  std::vector<std::size_t> near_;  // of one face; keeps its memory
};

/// For each vertex a bit of each side of a box that it lies beyond: faces whose vertices have one in common do not meet the box.
std::vector<unsigned char> sides_beyond(const PointsRef& vertices, const BoxTree::Box& box) {
  std::vector<unsigned char> beyond(static_cast<std::size_t>(vertices.rows()));
  for (Index v = 0; v < vertices.rows(); ++v)
    for (int k = 0; k < 3; ++k)
      beyond[v] |= (vertices(v, k) < box.min()[k] ? 1U << (2 * k) : 0U) | (vertices(v, k) > box.max()[k] ? 2U << (2 * k) : 0U);
  return beyond;
}

std::vector<Index> in_order(std::vector<Index> vertices) {
  std::ranges::sort(vertices);
  vertices.erase(std::ranges::unique(vertices).begin(), vertices.end());
  return vertices;
}

/// Into the vector, which keeps its memory from face to face.
void corners_of(const PointsRef& vertices, const PointsRef& added, const IndicesRef& face, std::vector<Vec3>& corners) {
  corners.clear();
  const Index n = vertices.rows();
  for (Index v : face) corners.push_back(v < n ? vertices.row(v) : added.row(v - n));
}

/// Some faces of a cage on its limit surface, each as squares.
class LimitFaces {
public:
  LimitFaces(const Mesh& cage, const Subdivision& settings, const std::vector<Index>& faces)
      : cage_(cage), settings_(with_quality(settings)), limit_(cage, settings_, vertices_of(cage, faces)) {}

  template <class Take>
  void each(Index face, const Take& take) const {
    const LimitMesh squares = sample_limit(limit_, cage_, settings_.loop, face, face + 1, settings_.level);
    std::vector<Vec3> corners;
    for (Index k = 0; k < squares.faces.size(); ++k) {
      corners_of(squares.vertices, Points(0, 3), squares.faces[k], corners);
      take(corners);
    }
  }

  static std::vector<Index> vertices_of(const Mesh& cage, const std::vector<Index>& faces) {
    std::vector<Index> vertices;
    for (Index f : faces) vertices.insert(vertices.end(), cage.faces[f].begin(), cage.faces[f].end());
    return in_order(std::move(vertices));
  }

private:
  static Subdivision with_quality(Subdivision settings) {
    if (!settings.quality) settings.quality = stencil_quality;
    return settings;
  }

  const Mesh& cage_;
  Subdivision settings_;
  LimitSurface limit_;
};

/// Boxes around what of the limit surface each face of a cage can be: that of the faces which share a vertex with it.
std::vector<BoxTree::Box> limit_boxes(const Mesh& cage) {
  std::vector<BoxTree::Box> around(cage.vertices.rows()), boxes(cage.faces.size());
  for (Index f = 0; f < cage.faces.size(); ++f) {
    BoxTree::Box own;
    for (Index v : cage.faces[f]) own.extend(Vec3(cage.vertices.row(v)));
    for (Index v : cage.faces[f]) around[v].extend(own);
  }
  for (Index f = 0; f < cage.faces.size(); ++f)
    for (Index v : cage.faces[f]) boxes[f].extend(around[v]);
  return boxes;
}

std::vector<std::vector<Index>> faces_by_fill(std::span<const Index> fill_of_face) {
  std::vector<std::vector<Index>> faces;
  for (std::size_t f = 0; f < fill_of_face.size(); ++f) {
    const Index fill = fill_of_face[f];
    if (fill < 0) continue;
    if (fill >= std::ssize(faces)) faces.resize(fill + 1);
    faces[fill].push_back(static_cast<Index>(f));
  }
  return faces;
}

/// Looks at all faces of a mesh. Consecutive faces are mostly neighbors, so one search finds what several of them meet.
///
/// box: around all triangles of the fills.
void look_at_mesh(const Mesh& mesh, const BoxTree::Box& box, Passages& passages) {
  constexpr Index together = count::places;  // nothing but time depends on it
  const std::vector<unsigned char> beyond = sides_beyond(mesh.vertices, box);
  std::vector<Index> faces;
  std::vector<std::size_t> near;
  std::vector<Vec3> corners;
  for (Index first = 0; first < mesh.faces.size(); first += together) {
    if (first % 4096 == 0) check_interruption();
    faces.clear();
    BoxTree::Box around;
    double sizes = 0;  // of all of them
    for (Index f = first; f < std::min(first + together, mesh.faces.size()); ++f) {
      unsigned char all = 63;
      for (Index v : mesh.faces[f]) all &= beyond[v];
      if (all != 0) continue;
      faces.push_back(f);
      BoxTree::Box own;
      for (Index v : mesh.faces[f]) own.extend(Vec3(mesh.vertices.row(v)));
      around.extend(own);
      sizes += own.sizes().sum();
    }
    const bool are_close = around.sizes().sum() <= sizes;
    if (are_close) passages.find_near(around, near);
    if (are_close && near.empty()) continue;
    const bool few = are_close && near.size() <= faces.size();
    for (const Index f : faces) {
      corners_of(mesh.vertices, Points(0, 3), mesh.faces[f], corners);
      if (few)
        passages.look_among(near, mesh.faces[f], corners);
      else
        passages.look(mesh.faces[f], corners);
    }
  }
}

/// The limit surface of a cage of which some faces are of fills.
void look_at_limit(const Mesh& cage, std::span<const Index> fill_of_face, const Subdivision& settings, Passages& passages) {
  const std::vector<BoxTree::Box> boxes = limit_boxes(cage);
  std::vector<Index> near;
  for (Index f = 0; f < cage.faces.size(); ++f)
    if (passages.is_near(boxes[f])) near.push_back(f);
  const LimitFaces around(cage, settings, near);
  for (Index f : near)
    around.each(f, [&](const std::vector<Vec3>& corners) { passages.look(cage.faces[f], corners, fill_of_face[f]); });
}

Passed limit_passages(const Mesh& cage, std::span<const Index> fill_of_face, const Subdivision& settings) {
  std::vector<Index> own;
  std::vector<std::vector<Index>> vertices;
  for (const std::vector<Index>& fill : faces_by_fill(fill_of_face)) {
    own.insert(own.end(), fill.begin(), fill.end());
    vertices.push_back(LimitFaces::vertices_of(cage, fill));
  }
  std::vector<FlatTriangle> triangles;
  const LimitFaces of_fills(cage, settings, own);
  for (Index f : own)
    of_fills.each(f, [&](const std::vector<Vec3>& corners) { add_triangles(corners, fill_of_face[f], triangles); });
  Passages passages(std::move(triangles), std::move(vertices));
  look_at_limit(cage, fill_of_face, settings, passages);
  return passages.found;
}

}  // namespace

std::vector<std::optional<Vec3>> passages(const Mesh& mesh, std::span<const FillFaces> fills,
                                          const std::optional<Subdivision>& subdivision) {
  std::vector<FlatTriangle> triangles;
  std::vector<std::vector<Index>> rims;
  std::vector<Vec3> corners;
  const auto each_face = [&](const auto& take) {
    for (Index fill = 0; fill < std::ssize(fills); ++fill)
      for (Index k = 0; k < fills[fill].faces.size(); ++k) {
        corners_of(mesh.vertices, fills[fill].added, fills[fill].faces[k], corners);
        take(fill, fills[fill].faces[k]);
      }
  };
  each_face([&](Index fill, const IndicesRef&) { add_triangles(corners, fill, triangles); });
  BoxTree::Box box;
  for (const FlatTriangle& each : triangles) box.extend(each.box);
  for (const FillFaces& fill : fills) rims.push_back(in_order({fill.rim.begin(), fill.rim.end()}));
  Passages passages(std::move(triangles), std::move(rims));
  if (subdivision)
    look_at_limit(mesh, std::vector<Index>(mesh.faces.size(), -1), *subdivision, passages);
  else
    look_at_mesh(mesh, box, passages);
  if (fills.size() > 1) each_face([&](Index fill, const IndicesRef& face) { passages.look(face, corners, fill); });
  return passages.found;
}

std::vector<std::optional<Vec3>> passages(const Mesh& mesh, std::span<const Index> fill_of_face,
                                          const std::optional<Subdivision>& subdivision) {
  if (subdivision) return limit_passages(mesh, fill_of_face, *subdivision);
  std::vector<Faces> faces;
  std::vector<std::vector<Index>> vertices;
  for (const std::vector<Index>& fill : faces_by_fill(fill_of_face)) {
    Faces& own = faces.emplace_back();
    for (Index f : fill) own.add(mesh.faces[f]);
    vertices.push_back(LimitFaces::vertices_of(mesh, fill));
  }
  const Points none(0, 3);
  std::vector<FillFaces> fills;
  for (std::size_t k = 0; k < faces.size(); ++k) fills.push_back({none, faces[k], vertices[k]});
  return passages(mesh, fills, {});
}

}  // namespace tripatch
