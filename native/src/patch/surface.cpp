#include "tripatch/patch/surface.h"

#include <Eigen/Geometry>

namespace tripatch {
namespace {
using RowMajorB = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
}

Points Surface::positions(const PointsRef& b) const {
  Points out(b.rows(), 3);
  evaluate(RowMajorB(b).data(), b.rows(), 0, out.data());
  return out;
}

Points Surface::normals(const PointsRef& b) const { return positions_and_normals(b).second; }

std::pair<Points, Points> Surface::positions_and_normals(const PointsRef& b) const {
  Eigen::Matrix<double, Eigen::Dynamic, 9, Eigen::RowMajor> jets(b.rows(), 9);
  evaluate(RowMajorB(b).data(), b.rows(), 1, jets.data());
  Points normals(b.rows(), 3);
  for (Index k = 0; k < b.rows(); ++k) {
    const Vec3 d0 = jets.row(k).segment<3>(3), d1 = jets.row(k).segment<3>(6);
    normals.row(k) = d0.cross(d1).stableNormalized();
  }
  return {jets.leftCols<3>(), normals};
}

}  // namespace tripatch
