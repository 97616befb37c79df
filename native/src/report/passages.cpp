#include "tripatch/report/passages.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <numeric>

#include "tripatch/math/box_tree.h"
#include "tripatch/math/interruption.h"
#include "tripatch/report/crossings.h"

namespace tripatch {
namespace {

using Corners = std::array<Vec3, 3>;

struct FlatTriangle {
  Corners p;
  Vec3 normal;  // of unit length
  double longest;
  std::size_t fill;
  Eigen::AlignedBox3d box;
};

/// Nothing of a triangle without area.
std::optional<FlatTriangle> flat_triangle(const Corners& p, std::size_t fill) {
  const Vec3 u = p[1] - p[0], v = p[2] - p[0], w = p[2] - p[1];
  const Vec3 normal = u.cross(v).stableNormalized();
  if (normal.isZero() || !normal.allFinite()) return {};
  FlatTriangle t{p, normal, std::max({u.norm(), v.norm(), w.norm()}), fill, {}};
  for (const Vec3& q : p) t.box.extend(q);
  return t;
}

/// Where an edge of one of two triangles goes through the other.
std::optional<Vec3> place_through(const FlatTriangle& a, const FlatTriangle& b) {
  const double least = touching * std::max(a.longest, b.longest);
  for (int k = 0; k < 3; ++k) {
    if (const auto where = passage(a.p[k], a.p[(k + 1) % 3], b.p, b.normal, least)) return where;
    if (const auto where = passage(b.p[k], b.p[(k + 1) % 3], a.p, a.normal, least)) return where;
  }
  return {};
}

std::vector<FlatTriangle> triangles_of(const PointsRef& vertices, std::span<const FillFaces> fills) {
  const Index n = vertices.rows();
  std::vector<FlatTriangle> triangles;
  for (std::size_t f = 0; f < fills.size(); ++f) {
    const auto at = [&](Index v) -> Vec3 { return v < n ? vertices.row(v) : fills[f].added.row(v - n); };
    for (Index k = 0; k < fills[f].faces.size(); ++k) {
      const std::span<const Index> face = fills[f].faces[k];
      for (std::size_t c = 2; c < face.size(); ++c)
        if (auto t = flat_triangle({at(face[0]), at(face[c - 1]), at(face[c])}, f)) triangles.push_back(*t);
    }
  }
  return triangles;
}

}  // namespace

std::vector<std::optional<Vec3>> passages(const Mesh& mesh, std::span<const FillFaces> fills) {
  std::vector<std::optional<Vec3>> found(fills.size());
  const std::vector<FlatTriangle> triangles = triangles_of(mesh.vertices, fills);
  std::vector<BoxTree::Box> boxes;
  for (const FlatTriangle& each : triangles) boxes.push_back(each.box);
  const BoxTree tree(std::move(boxes));
  std::vector<std::vector<Index>> rims;
  for (const FillFaces& fill : fills) {
    std::vector<Index>& rim = rims.emplace_back(fill.rim.begin(), fill.rim.end());
    std::sort(rim.begin(), rim.end());
  }
  for (Index f = 0; f < mesh.faces.size(); ++f) {
    if (f % 4096 == 0) check_interruption();
    const std::span<const Index> face = mesh.faces[f];
    Eigen::AlignedBox3d box;
    for (Index v : face) box.extend(Vec3(mesh.vertices.row(v)));
    tree.each_meeting(box, [&](std::size_t k) {
      const FlatTriangle& of_fill = triangles[k];
      const std::vector<Index>& rim = rims[of_fill.fill];
      if (found[of_fill.fill]) return;
      if (std::ranges::any_of(face, [&](Index v) { return std::binary_search(rim.begin(), rim.end(), v); })) return;
      for (std::size_t c = 2; c < face.size(); ++c) {
        const Corners p = {mesh.vertices.row(face[0]), mesh.vertices.row(face[c - 1]), mesh.vertices.row(face[c])};
        const std::optional<FlatTriangle> old = flat_triangle(p, of_fill.fill);
        if (old && !found[of_fill.fill]) found[of_fill.fill] = place_through(*old, of_fill);
      }
    });
  }
  return found;
}

}  // namespace tripatch
