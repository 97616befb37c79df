// A wall around a hole, flat or curved, and how it continues in the hole.
#pragma once

#include <memory>
#include <vector>

#include "tripatch/math/plane.h"
#include "tripatch/mesh/connectivity.h"
#include "tripatch/spline/polyharmonic_spline.h"

namespace tripatch {

class Wall {
public:
  /// A plane. across: the hole's diameter. has_faces: else its normal may be turned over.
  Wall(const Vec3& normal, const Vec3& point, double across, bool has_faces = true);
  /// The surface of heights over the mean plane of these faces. rim (k x 3): the hole's.
  Wall(const Mesh& mesh, std::vector<Index> faces, const Points& rim, double across);

  /// Whether it is known how it continues: not of few faces that are not flat, or of rough ones.
  bool continues() const { return is_flat_ || surface_; }
  bool is_flat() const { return is_flat_; }
  bool has_faces() const { return has_faces_; }
  /// Of a curved wall, those it was read from.
  const std::vector<Index>& faces() const { return faces_; }
  /// Of its mean plane, outwards, of unit length.
  const Vec3& normal() const { return normal_; }
  /// Scene units: what is no farther from the wall lies in it.
  double within() const { return within_; }

  struct At {
    Eigen::VectorXd distance;  ///< to first order, positive outside
    Points normal;             ///< outwards, of unit length
  };
  At at(const Points& points) const;
  double distance(const Vec3& p) const { return is_flat_ ? (p - middle_).dot(normal_) : at(p.transpose()).distance[0]; }
  Vec3 normal_at(const Vec3& p) const { return is_flat_ ? normal_ : Vec3(at(p.transpose()).normal.row(0)); }
  /// Standard deviation along the normal, scene units; of a plane 0.
  Eigen::VectorXd deviation(const Points& points) const;
  /// Places in its mean plane, seen from outside.
  PlanePoints seen_from_outside(const Points& points) const;

private:
  std::vector<Index> faces_;
  Vec3 middle_, normal_, along_, beside_;
  bool is_flat_ = false, has_faces_ = true;
  std::shared_ptr<const PolyharmonicSpline> surface_;
  double within_ = 0;
};

}  // namespace tripatch
