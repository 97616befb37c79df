#include "tripatch/report/dihedrals.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <span>

#include "tripatch/math/angle.h"

namespace tripatch {

Vec3 place_of(const Mesh& mesh, const Fill& fill, Index v) {
  const Index n = mesh.vertices.rows();
  return v < n ? Vec3(mesh.vertices.row(v)) : Vec3(fill.vertices.row(v - n));
}

void measure_dihedrals(const Mesh& mesh, const Connectivity& around, Fill& fill) {
  const Index n = mesh.vertices.rows();
  const auto at = [&](Index v) { return place_of(mesh, fill, v); };
  const auto normal = [&](std::span<const Index> f) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t k = 2; k < f.size(); ++k) sum += (at(f[k - 1]) - at(f[0])).cross(at(f[k]) - at(f[0]));
    return sum;
  };
  double squares = 0;
  fill.report.seam_angle_max = 0;
  for (Index f = 0; f < fill.faces.size(); ++f)
    for (std::size_t k = 0; k < fill.faces[f].size(); ++k) {
      const Index a = fill.faces[f][k], b = fill.faces[f][(k + 1) % fill.faces[f].size()];
      if (a >= n || b >= n) continue;
      const auto beyond = around.edge(b, a);
      if (!beyond) continue;
      const double angle = degrees_between(normal(fill.faces[f]), normal(around.faces()[around.face(*beyond)]));
      fill.report.seam_angle_max = std::max(fill.report.seam_angle_max, angle);
      squares += angle * angle;
    }
  fill.report.seam_angle_rms = std::sqrt(squares / static_cast<double>(fill.rim.size()));
}

}  // namespace tripatch
