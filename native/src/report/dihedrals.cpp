#include "tripatch/report/dihedrals.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "tripatch/math/angle.h"
#include "tripatch/mesh/vertex_normals.h"

namespace tripatch {

Vec3 place_of(const Mesh& mesh, const Fill& fill, Index v) {
  const Index n = mesh.vertices.rows();
  return v < n ? Vec3(mesh.vertices.row(v)) : Vec3(fill.vertices.row(v - n));
}

Vec3 area_of(const Mesh& mesh, const Fill& fill, Index face) {
  const std::span<const Index> corners = fill.faces[face];
  const auto way = [&](std::size_t k) { return Vec3(place_of(mesh, fill, corners[k]) - place_of(mesh, fill, corners[0])); };
  Vec3 twice = Vec3::Zero();
  for (std::size_t k = 2; k < corners.size(); ++k) twice += way(k - 1).cross(way(k));
  return 0.5 * twice;
}

std::vector<RimDihedral> rim_dihedrals(const Mesh& mesh, const Connectivity& around, const Fill& fill) {
  const Index n = mesh.vertices.rows();
  std::vector<RimDihedral> found;
  for (Index f = 0; f < fill.faces.size(); ++f) {
    const std::span<const Index> face = fill.faces[f];
    for (std::size_t k = 0; k < face.size(); ++k) {
      const Index a = face[k], b = face[(k + 1) % face.size()];
      const auto beyond = a < n && b < n ? around.edge(b, a) : std::nullopt;
      if (beyond) found.push_back({{a, b}, degrees_between(area_of(mesh, fill, f), area_vector(mesh, around.face(*beyond)))});
    }
  }
  return found;
}

void measure_dihedrals(const Mesh& mesh, const Connectivity& around, Fill& fill) {
  double squares = 0;
  fill.report.seam_angle_max = 0;
  for (const RimDihedral& each : rim_dihedrals(mesh, around, fill)) {
    fill.report.seam_angle_max = std::max(fill.report.seam_angle_max, each.degrees);
    squares += each.degrees * each.degrees;
  }
  fill.report.seam_angle_rms = std::sqrt(squares / static_cast<double>(fill.rim.size()));
}

}  // namespace tripatch
