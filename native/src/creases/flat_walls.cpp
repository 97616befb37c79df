#include "tripatch/creases/flat_walls.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "tripatch/creases/edge_angles.h"
#include "tripatch/math/angle.h"
#include "tripatch/mesh/submesh.h"
#include "tripatch/mesh/vertex_normals.h"

namespace tripatch {
namespace {

/// Of the hole's diameter: vertices of one plane are no farther from it.
constexpr double in_plane = 1e-4;
/// Between a flat rim and walls that end there, at least: the corner of a box with chamfers of one face (35 degrees) is a rounded one's.
constexpr double least_end_angle = 40 * std::numbers::pi / 180;
/// The same where it is enough that half of the rim's edges have it.
constexpr double clear_end_angle = 60 * std::numbers::pi / 180;
/// The same where walls lean far under the rim, less than 30 degrees from what lies in it: whatever continues from them leaves the hole, so that
/// walls need not meet at creases.
constexpr double under_rim = 150 * std::numbers::pi / 180;
/// Between faces of one wall, at most.
constexpr double in_one_wall = 1 * std::numbers::pi / 180;
/// Radians over half of the hole's diameter: walls that bend by less away from the rim are straight. The end of a spring whose wire is a fifth as
/// thick as its coil bends by 0.17 there, a ball cut in half by 1.
constexpr double least_bend = 0.1;

/// Around a rim in a plane: where all of that is flat, any fill is.
constexpr int flat_rings = 6;

struct Plane {
  Vec3 normal = Vec3::Zero(), point = Vec3::Zero();
};

class FlatRim {
public:
  FlatRim(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim, double across)
      : mesh_(mesh), around_(around), rim_(rim), n_(static_cast<Index>(rim.size())), across_(across), within_(in_plane * across) {
    for (Index k = 0; k < n_; ++k) {
      flat_.point += at(k) / static_cast<double>(n_);
      flat_.normal += (at(k) - at(0)).cross(at(k + 1) - at(0));
    }
    flat_.normal = flat_.normal.stableNormalized();
  }

  /// is_in_ending_wall.
  bool is_in_ending_wall() const {
    if (!is_flat()) return false;
    Index goes_on = 0;
    for (Index k = 0; k < n_; ++k) {
      const auto corner = around_.edge(rim_[(k + 1) % n_], rim_[k]);
      if (!corner) return false;
      const Index face = around_.face(*corner);
      const bool same = lies_in(face, flat_);
      if (!same && angle_between(area_vector(mesh_, face), flat_.normal) < least_crease_angle) return false;
      goes_on += same;
    }
    return goes_on > 0 && !(goes_on == n_ && is_in(flat_, flat_rings));
  }

  /// walls_end_at_flat_rim.
  bool walls_end() const {
    if (n_ < 4 || !is_flat()) return false;
    std::vector<Vec3> normal;
    Index least = 0, clear = 0, under = 0, upright = 0;
    for (Index k = 0; k < n_; ++k) {
      const auto corner = around_.edge(rim_[(k + 1) % n_], rim_[k]);
      if (!corner) return false;
      normal.push_back(area_vector(mesh_, around_.face(*corner)));
      if (normal.back().isZero(0)) return false;
      const double angle = angle_between(normal.back(), flat_.normal);
      if (angle < least_crease_angle) return false;
      least += angle > least_end_angle;
      clear += angle > clear_end_angle;
      under += angle > under_rim;
      upright += angle > clear_end_angle && angle < std::numbers::pi / 2 + in_one_wall;
    }
    if (least < n_ && 2 * clear < n_) return false;
    const double apart = under == n_ ? in_one_wall : least_crease_angle;
    bool several = false, creased = true;
    for (Index k = 0; k < n_; ++k) {
      const Vec3 &here = normal[k], &before = normal[(k + n_ - 1) % n_];
      const double turn = angle_between(here, before);
      several = several || angle_between(here, normal[0]) > in_one_wall;
      creased = creased && (turn <= in_one_wall || turn >= apart);
      for (Connectivity::Corner c : around_.at(rim_[k])) {  // between two walls is nothing else, as in a ball of triangles
        const Vec3 own = area_vector(mesh_, around_.face(c));
        if (std::min(angle_between(own, here), angle_between(own, before)) > in_one_wall) return false;
      }
    }
    return several && (creased || (upright == n_ && are_straight()));
  }

private:
  /// Whether the faces at the rim go straight on away from it, or end at sharp edges there.
  bool are_straight() const {
    const auto on_rim = [&](Index v) { return std::ranges::find(rim_, v) != rim_.end(); };
    for (const Index v : rim_)
      for (const Connectivity::Corner c : around_.at(v)) {
        const Index f = around_.face(c);
        const std::span<const Index> face = mesh_.faces[f];
        for (std::size_t k = 0; k < face.size(); ++k) {
          const Index a = face[k], b = face[(k + 1) % face.size()];
          const auto beyond = on_rim(a) || on_rim(b) ? std::nullopt : around_.edge(b, a);
          if (!beyond) continue;
          const Index g = around_.face(*beyond);
          const double turn = angle_between(area_vector(mesh_, f), area_vector(mesh_, g));
          if (turn < least_crease_angle && turn * across_ / 2 > least_bend * (middle(f) - middle(g)).norm()) return false;
        }
      }
    return true;
  }
  Vec3 middle(Index face) const {
    const std::span<const Index> corners = mesh_.faces[face];
    Vec3 sum = Vec3::Zero();
    for (const Index v : corners) sum += point(v);
    return sum / static_cast<double>(corners.size());
  }

  Vec3 point(Index v) const { return mesh_.vertices.row(v); }
  Vec3 at(Index place) const { return point(rim_[place % n_]); }
  bool contains(const Plane& plane, const Vec3& p) const { return std::abs((p - plane.point).dot(plane.normal)) < within_; }
  bool contains(const Plane& plane, std::span<const Index> vertices) const {
    return std::ranges::all_of(vertices, [&](Index v) { return contains(plane, point(v)); });
  }
  bool is_flat() const { return contains(flat_, rim_); }

  bool lies_in(Index face, const Plane& plane) const {
    return area_vector(mesh_, face).dot(plane.normal) > 0 && contains(plane, mesh_.faces[face]);
  }

  /// Whether all faces in so many rings around the rim lie in a plane.
  bool is_in(const Plane& plane, int rings) const {
    Numbering seen(mesh_.vertices.rows());
    for (Index v : rim_) seen.add(v);
    for (std::size_t from = 0; rings > 0; --rings)
      for (const std::size_t to = seen.items().size(); from < to; ++from)
        for (Connectivity::Corner c : around_.at(seen.items()[from])) {
          if (!lies_in(around_.face(c), plane)) return false;
          for (Index w : mesh_.faces[around_.face(c)]) seen.add(w);
        }
    return true;
  }

  const Mesh& mesh_;
  const Connectivity& around_;
  const std::vector<Index>& rim_;
  Index n_;
  double across_, within_;
  Plane flat_;  // as new faces face
};

}  // namespace

bool is_in_ending_wall(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim, double across) {
  return FlatRim(mesh, around, rim, across).is_in_ending_wall();
}

bool walls_end_at_flat_rim(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim, double across) {
  return FlatRim(mesh, around, rim, across).walls_end();
}

}  // namespace tripatch
