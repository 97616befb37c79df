#include "tripatch/mesh/vertex_normals.h"

#include "tripatch/math/angle.h"
#include "tripatch/math/tolerances.h"
#include "tripatch/messages.h"

namespace tripatch {
namespace {

/// Zero stays zero.
Vec3 unit(const Vec3& v) {
  const double length = v.stableNorm();
  return length > 0 ? Vec3(v / length) : Vec3::Zero();
}

}  // namespace

Vec3 area_vector(const Mesh& mesh, Index f) {
  const IndicesRef face = mesh.faces[f];
  const Vec3 p = mesh.vertices.row(face[0]);
  Vec3 area = Vec3::Zero();
  for (std::size_t k = 1; k + 1 < face.size(); ++k)
    area += (Vec3(mesh.vertices.row(face[k])) - p).cross(Vec3(mesh.vertices.row(face[k + 1])) - p);
  return area;
}

Points vertex_normals(const Mesh& mesh, const PointsRef& corner_normals) {
  if (corner_normals.rows() != 0 && corner_normals.rows() != static_cast<Index>(mesh.faces.corners.size()))
    throw CodedArgument(Code::wrong_shape, {{"name", "corner_normals"},
                                            {"shape", "(" + std::to_string(mesh.faces.corners.size()) + ", 3)"},
                                            {"given", "(" + std::to_string(corner_normals.rows()) + ", 3)"}});
  for (Index v : mesh.faces.corners)
    if (v < 0 || v >= mesh.vertices.rows())
      throw InvalidArgument("A face names vertex " + std::to_string(v) + ", of " + std::to_string(mesh.vertices.rows()));
  Points normals = Points::Zero(mesh.vertices.rows(), 3);
  const auto at = [&](Index v) -> Vec3 { return mesh.vertices.row(v); };
  for (Index f = 0; f < mesh.faces.size(); ++f) {
    const IndicesRef face = mesh.faces[f];
    const std::size_t n = face.size();
    const Vec3 own = unit(area_vector(mesh, f));
    for (std::size_t k = 0; k < n; ++k) {
      const Vec3 here = at(face[k]);
      const double angle = angle_between(at(face[(k + 1) % n]) - here, at(face[(k + n - 1) % n]) - here);
      const Index corner = mesh.faces.offsets[f] + static_cast<Index>(k);
      const bool given = corner_normals.rows() != 0 && !corner_normals.row(corner).isZero(0);
      normals.row(face[k]) += angle * (given ? Vec3(corner_normals.row(corner)) : own);
    }
  }
  for (Index v = 0; v < normals.rows(); ++v) {
    const Vec3 sum = normals.row(v);
    normals.row(v) = sum.norm() < tolerance::solved ? Vec3::Zero() : unit(sum);
  }
  return normals;
}

}  // namespace tripatch
