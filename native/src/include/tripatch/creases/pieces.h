// The smooth pieces that the surroundings of a hole consist of, between creases, and how each continues in the hole.
#pragma once

#include <functional>
#include <memory>
#include <unordered_map>
#include <vector>

#include "tripatch/math/plane.h"
#include "tripatch/mesh/connectivity.h"
#include "tripatch/spline/field.h"

namespace tripatch {

/// A plane, or a surface over one: the field of its heights there.
class SmoothPiece {
public:
  /// faces: of the mesh, the first ones at the rim (k x 3). across: the hole's diameter.
  SmoothPiece(const Mesh& mesh, std::vector<Index> faces, const Points& rim, double across);

  /// A plane of which no face is left, whichever its outer side is.
  SmoothPiece(const Vec3& normal, const Vec3& point, double across);

  const std::vector<Index>& faces() const { return faces_; }
  /// Whether anything is known of how it continues: not of a few faces that are no plane.
  bool continues() const { return is_plane_ || field_; }
  bool is_plane() const { return is_plane_; }
  /// Of its mean plane, outwards.
  const Vec3& normal() const { return normal_; }
  /// Scene units: vertices that are so near lie in it.
  double tolerance() const { return tolerance_; }
  const Points& samples() const { return samples_; }

  struct At {
    Eigen::VectorXd distance;  ///< to first order, positive outside
    Points normal;             ///< unit, outwards
  };
  At at(const Points& points) const;
  /// Standard deviation along the normal, scene units.
  Eigen::VectorXd deviation(const Points& points) const;
  /// Seen from outside.
  PlanePoints in_plane(const Points& points) const;

private:
  void fit(double across);

  std::vector<Index> faces_;
  Points samples_;
  double edge_ = 0;  // mean
  Vec3 middle_, normal_, along_, beside_;
  bool is_plane_ = false;
  std::shared_ptr<const Field> field_;
  double noise_ = 0, tolerance_ = 0;
};

using IsSharp = std::function<bool(Index, Index)>;  // an edge

struct PiecesFound {
  std::vector<SmoothPiece> pieces;
  std::unordered_map<Index, std::size_t> of_face;
  std::vector<std::size_t> beside;  ///< for each edge of the rim the piece whose face is there
};

/// Grown from the rim's faces across all edges that are not sharp, among faces whose vertices are all `near`, sorted. Pieces of one plane
/// are one. None where a face is missing next to the rim.
PiecesFound smooth_pieces(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim, const IsSharp& is_sharp,
                          const std::vector<Index>& near, double across);

}  // namespace tripatch
