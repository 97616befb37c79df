#include "tripatch/quads/quad_repair.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>

namespace tripatch {
namespace {

/// Cosine between the halves of a quad, cut from its k-th corner on.
double bend_of_halves(const Points& points, std::span<const Index> quad, std::size_t k) {
  const auto at = [&](std::size_t i) -> Vec3 { return points.row(quad[(k + i) % 4]); };
  const Vec3 across = at(2) - at(0);
  return (at(1) - at(0)).cross(across).stableNormalized().dot(across.cross(at(3) - at(0)).stableNormalized());
}

}  // namespace

Faces with_bad_quads_halved(const Points& points, const Faces& faces) {
  Faces left;
  for (Index f = 0; f < faces.size(); ++f) {
    std::vector<Index> face(faces[f].begin(), faces[f].end());
    Faces one;
    one.add(face);
    if (face.size() == 4 && quad_quality(points, one).least < min_sine) {
      if (bend_of_halves(points, face, 1) > bend_of_halves(points, face, 0))
        std::rotate(face.begin(), face.begin() + 1, face.end());
      left.add(std::array{face[0], face[1], face[2]});
      left.add(std::array{face[0], face[2], face[3]});
    } else {
      left.add(face);
    }
  }
  return left;
}

void remove_doublets(PlaneLayout& layout) {
  std::vector<std::vector<Index>> faces, at(static_cast<std::size_t>(layout.uv.rows()));
  for (Index f = 0; f < layout.faces.size(); ++f) {
    faces.emplace_back(layout.faces[f].begin(), layout.faces[f].end());
    for (const Index v : faces.back()) at[static_cast<std::size_t>(v)].push_back(f);
  }
  const auto from = [](const std::vector<Index>& quad, Index v, std::size_t k) {
    return quad[static_cast<std::size_t>(std::ranges::find(quad, v) - quad.begin() + k) % 4];
  };
  std::vector<Index> row, kept;  // of the vertices that stay
  for (Index v = 0; v < layout.uv.rows(); ++v) {
    const std::vector<Index>& own = at[static_cast<std::size_t>(v)];
    std::vector<Index>*one = nullptr, *other = nullptr;
    if (v >= layout.rim && own.size() == 2)
      one = &faces[static_cast<std::size_t>(own[0])], other = &faces[static_cast<std::size_t>(own[1])];
    row.push_back(static_cast<Index>(kept.size()));
    if (!one || one->size() != 4 || other->size() != 4 || from(*one, v, 2) == from(*other, v, 2)) {
      kept.push_back(v);
      continue;
    }
    *one = {from(*one, v, 1), from(*one, v, 2), from(*one, v, 3), from(*other, v, 2)};
    const Index left = own[0], gone = own[1];
    for (const Index w : *other) std::ranges::replace(at[static_cast<std::size_t>(w)], gone, left);
    for (const Index w : {(*one)[0], (*one)[2]}) {  // of both quads
      std::vector<Index>& around = at[static_cast<std::size_t>(w)];
      around.erase(std::ranges::find(around, left));
    }
    other->clear();
  }
  layout.uv = PlanePoints(layout.uv(kept, Eigen::all));
  layout.faces = {};
  for (std::vector<Index>& face : faces) {
    for (Index& v : face) v = row[static_cast<std::size_t>(v)];
    if (!face.empty()) layout.faces.add(face);
  }
}

}  // namespace tripatch
