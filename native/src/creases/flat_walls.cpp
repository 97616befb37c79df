#include "tripatch/creases/flat_walls.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "tripatch/math/angle.h"
#include "tripatch/math/ties.h"
#include "tripatch/mesh/submesh.h"
#include "tripatch/mesh/vertex_normals.h"

namespace tripatch {
namespace {

/// Of the hole's diameter: vertices of one plane are no farther from it.
constexpr double in_plane = 1e-4;
/// Between edges of the rim that tell the plane of a wall that has no face left, at least.
constexpr double least_turn = 20 * std::numbers::pi / 180;
/// Of the hole's diameter, from the nearest vertex of the rim: where walls meet farther off, the fill would leave the hole.
constexpr double farthest_node = 1;
/// Planes beside a rim, and as many of walls that have no face left.
constexpr std::size_t most_planes = 8;

struct Plane {
  Vec3 normal = Vec3::Zero(), point = Vec3::Zero();
};

class WallFinder {
public:
  /// Faces of walls are sought at the vertices `near`, sorted.
  WallFinder(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim, double across,
             const std::vector<Index>& near)
      : mesh_(mesh),
        around_(around),
        rim_(rim),
        near_(near),
        n_(static_cast<Index>(rim.size())),
        across_(across),
        within_(in_plane * across) {}

  /// Between the planes that are seen, else with one more.
  std::optional<FlatWalls> walls() {
    if (!read_planes() || is_flat()) return {};
    std::optional<Meeting> best = meeting();
    const std::vector<Plane> unseen = best ? std::vector<Plane>() : unseen_planes();
    for (const Plane& plane : unseen) {
      planes_.resize(seen_);
      planes_.push_back(plane);
      std::optional<Meeting> found = meeting();
      if (found && (!best || std::pair(found->walls.first.size(), found->area) < std::pair(best->walls.first.size(), best->area)))
        best = std::move(found);
    }
    if (!best) return {};
    return best->walls;
  }

private:
  struct Meeting {
    FlatWalls walls;
    double area = 0;
  };

  Vec3 point(Index v) const { return mesh_.vertices.row(v); }
  Vec3 at(Index place) const { return point(rim_[place % n_]); }
  bool contains(const Plane& plane, const Vec3& p) const { return std::abs((p - plane.point).dot(plane.normal)) < within_; }
  template <class Vertices>
  bool contains(const Plane& plane, const Vertices& vertices) const {
    return std::all_of(vertices.begin(), vertices.end(), [&](Index v) { return contains(plane, point(v)); });
  }

  bool lies_in(Index face, const Plane& plane) const {
    return area_vector(mesh_, face).dot(plane.normal) > 0 && contains(plane, mesh_.faces[face]);
  }

  /// Of the faces beside the rim's edges; false where these are not flat, or too many.
  bool read_planes() {
    for (Index k = 0; k < n_; ++k) {
      const auto corner = around_.edge(rim_[(k + 1) % n_], rim_[k]);
      if (!corner) return false;
      const Index face = around_.face(*corner);
      const auto known = std::find_if(planes_.begin(), planes_.end(), [&](const Plane& plane) { return lies_in(face, plane); });
      beside_.push_back(static_cast<std::size_t>(known - planes_.begin()));
      if (known != planes_.end()) continue;
      planes_.push_back({area_vector(mesh_, face).stableNormalized(), at(k)});
      if (planes_.size() > most_planes || !lies_in(face, planes_.back())) return false;
    }
    seen_ = planes_.size();
    return seen_ > 1;
  }

  /// Planes of two edges of the rim that follow each other: of a wall that has no face left. None where they are many.
  std::vector<Plane> unseen_planes() const {
    std::vector<Plane> found;
    for (Index k = 0; k < n_; ++k) {
      const Vec3 before = at(k) - at(k + n_ - 1), after = at(k + 1) - at(k), across = before.cross(after);
      if (!(across.norm() > std::sin(least_turn) * before.norm() * after.norm())) continue;
      const auto holds = [&](const Plane& plane) {
        return contains(plane, at(k + n_ - 1)) && contains(plane, at(k)) && contains(plane, at(k + 1));
      };
      if (std::any_of(planes_.begin(), planes_.end(), holds) || std::any_of(found.begin(), found.end(), holds)) continue;
      if (found.size() == most_planes) return {};
      found.push_back({across.stableNormalized(), at(k)});
    }
    return found;
  }

  bool is_flat() const {
    Plane flat;
    for (Index k = 0; k < n_; ++k) {
      flat.point += at(k) / static_cast<double>(n_);
      flat.normal += (at(k) - at(0)).cross(at(k + 1) - at(0));
    }
    flat.normal = flat.normal.stableNormalized();
    return contains(flat, rim_);
  }

  /// The wall that each edge is part of: as few changes around the rim as its planes allow, each where a crease shows.
  bool choose_walls() {
    first_.clear();
    wall_.clear();
    const std::size_t planes = planes_.size();
    const double none = std::numeric_limits<double>::infinity();
    const auto cost = [&](Index k, std::size_t p) {
      if (p == beside_[k]) return 0.0;
      const bool in = contains(planes_[p], at(k)) && contains(planes_[p], at(k + 1));
      return !in ? none : (p < seen_ ? 1.0 : 2.0) / (4 * static_cast<double>(n_));  // all together less than a change
    };
    Eigen::MatrixXd costs(n_, planes);
    for (Index k = 0; k < n_; ++k)
      for (std::size_t p = 0; p < planes; ++p) costs(k, p) = cost(k, p);
    std::vector<Eigen::MatrixXd> change;  // at the beginning of each edge, from one plane to another
    for (Index k = 0; k < n_; ++k) {
      change.emplace_back(planes, planes);
      for (std::size_t p = 0; p < planes; ++p)
        for (std::size_t q = 0; q < planes; ++q) {
          const bool may = std::isfinite(costs((k + n_ - 1) % n_, p)) && std::isfinite(costs(k, q));
          change[k](p, q) = p == q ? 0 : may && is_shown(k, p, q) ? 1 : none;
        }
    }
    double least = none;
    std::vector<std::size_t> best;
    for (std::size_t begin = 0; begin < planes; ++begin) {
      std::vector<std::vector<std::size_t>> before(n_, std::vector<std::size_t>(planes, 0));
      Eigen::VectorXd sum = Eigen::VectorXd::Constant(planes, none);
      sum[begin] = costs(0, begin);
      for (Index k = 1; k < n_; ++k) {
        Eigen::VectorXd next(planes);
        for (std::size_t p = 0; p < planes; ++p) next[p] = costs(k, p) + (sum + change[k].col(p)).minCoeff(&before[k][p]);
        sum = next;
      }
      for (std::size_t p = 0; p < planes; ++p) {
        if (!(sum[p] + change[0](p, begin) < least)) continue;
        least = sum[p] + change[0](p, begin);
        best.assign(n_, p);
        for (Index k = n_ - 1; k > 0; --k) best[k - 1] = before[k][best[k]];
      }
    }
    if (!(least < none)) return false;
    for (Index k = 0; k < n_; ++k)
      if (best[k] != best[(k + n_ - 1) % n_]) first_.push_back(k), wall_.push_back(best[k]);
    std::vector<std::size_t> sorted = wall_;
    std::sort(sorted.begin(), sorted.end());
    if (wall_.size() < 2 || std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) return false;
    for (std::size_t i = 0; i < wall_.size(); ++i)
      if (wall_[i] < seen_ && (!is_beside(i) || ends_at_rim(i))) return false;
    return true;
  }

  Index end_of(std::size_t wall) const { return wall + 1 < first_.size() ? first_[wall + 1] : first_[0] + n_; }

  bool is_beside(std::size_t wall) const {
    for (Index k = first_[wall]; k < end_of(wall); ++k)
      if (beside_[k % n_] == wall_[wall]) return true;
    return false;
  }

  /// Whether a wall has lost nothing: its border, as far as it is the rim, turns around it on the whole.
  bool ends_at_rim(std::size_t wall) const {
    double turned = 0;
    for (Index k = first_[wall] + 1; k < end_of(wall); ++k) {
      if (beside_[k % n_] != wall_[wall] || beside_[(k - 1) % n_] != wall_[wall]) continue;
      const Vec3 before = at(k) - at(k - 1), after = at(k + 1) - at(k);
      turned += std::atan2(before.cross(after).dot(planes_[wall_[wall]].normal), before.dot(after));
    }
    return turned < -least_turn;
  }

  /// Whether the crease between two walls that meet at a place of the rim can be seen there.
  bool is_shown(Index place, std::size_t before, std::size_t here) const {
    const double turn = angle_between(planes_[here].normal, planes_[before].normal);
    if (turn < least_crease_angle || (std::max(here, before) >= seen_ && turn > std::numbers::pi - least_crease_angle))
      return false;
    const std::size_t beside = beside_[place];  // a third wall, if it has both edges
    if (beside == beside_[(place + n_ - 1) % n_] && beside != here && beside != before) return true;
    const Index v = rim_[place];
    const Plane &one_wall = planes_[before], &other_wall = planes_[here];
    for (Connectivity::Corner c : around_.at(v)) {
      const Index w = around_.next(c);
      const auto one = around_.edge(v, w), other = around_.edge(w, v);
      if (!one || !other) continue;
      const Index f = around_.face(*one), g = around_.face(*other);
      if ((lies_in(f, one_wall) && lies_in(g, other_wall)) || (lies_in(g, one_wall) && lies_in(f, other_wall))) return true;
    }
    return false;
  }

  std::optional<Vec3> node_of(std::size_t a, std::size_t b, std::size_t c) const {
    Eigen::Matrix3d normals;
    Vec3 at_plane;
    int row = 0;
    for (const std::size_t wall : {a, b, c}) {
      const Plane& plane = planes_[wall_[wall]];
      normals.row(row) = plane.normal;
      at_plane[row++] = plane.normal.dot(plane.point - at(0));
    }
    const Vec3 node = at(0) + Vec3(normals.partialPivLu().solve(at_plane));
    double least = std::numeric_limits<double>::infinity();
    for (Index k = 0; k < n_; ++k) least = std::min(least, (node - at(k)).norm());
    if (!(least > within_ && least < farthest_node * across_)) return {};
    return node;
  }

  /// The area that the pieces of all walls have together; none where one is turned over.
  std::optional<double> area(const FlatWalls& found) const {
    double sum = 0;
    for (std::size_t i = 0; i < wall_.size(); ++i) {
      std::vector<Vec3> piece;
      for (Index k = first_[i]; k <= end_of(i); ++k) piece.push_back(at(k));
      for (Index node : found.nodes_beside(i)) piece.push_back(found.nodes[node]);
      Vec3 twice = Vec3::Zero();
      for (std::size_t k = 1; k + 1 < piece.size(); ++k) twice += (piece[k] - piece[0]).cross(piece[k + 1] - piece[0]);
      const double towards = twice.dot(planes_[wall_[i]].normal) / 2, own = wall_[i] < seen_ ? towards : std::abs(towards);
      if (!(own > within_ * across_)) return {};
      sum += own;
    }
    return sum;
  }

  /// One wall meets all others: the first of these and the second in the first node, the second and the third in the next, and so on.
  /// Nodes at one place are one.
  std::optional<FlatWalls> around_wall(std::size_t hub) const {
    const std::size_t walls = wall_.size();
    FlatWalls found;
    found.first = first_;
    if (walls == 2) return found;
    found.node.resize(walls);
    for (std::size_t k = 1; k + 1 < walls; ++k) {
      const std::size_t here = (hub + k) % walls, next = (hub + k + 1) % walls;
      const std::optional<Vec3> node = node_of(hub, here, next);
      if (!node) return {};
      if (k == 1 || (*node - found.nodes.back()).norm() > within_) found.nodes.push_back(*node);
      if (k == 1) found.node[here] = 0;
      found.node[next] = found.node[hub] = static_cast<Index>(found.nodes.size()) - 1;
    }
    return found;
  }

  std::optional<Meeting> meeting() {
    if (!choose_walls()) return {};
    std::optional<Meeting> best;
    for (std::size_t hub = 0; hub < wall_.size(); ++hub) {
      const std::optional<FlatWalls> found = around_wall(hub);
      const std::optional<double> own = found ? area(*found) : std::nullopt;
      if (own && (!best || clearly_less(*own, best->area))) best = {*found, *own};
    }
    if (best) best->walls.faces = faces();
    return best;
  }

  /// For each wall those in its plane.
  std::vector<std::vector<Index>> faces() const {
    Numbering at_near(mesh_.faces.size());
    for (Index v : near_)
      for (Connectivity::Corner c : around_.at(v)) at_near.add(around_.face(c));
    std::vector<std::vector<Index>> out(wall_.size());
    for (Index f : at_near.items()) {
      const auto face = mesh_.faces[f];
      if (!std::all_of(face.begin(), face.end(), [&](Index v) { return std::binary_search(near_.begin(), near_.end(), v); }))
        continue;
      for (std::size_t i = 0; i < wall_.size(); ++i)
        if (wall_[i] < seen_ && lies_in(f, planes_[wall_[i]])) out[i].push_back(f);
    }
    return out;
  }

  const Mesh& mesh_;
  const Connectivity& around_;
  const std::vector<Index>&rim_, &near_;
  Index n_;
  double across_, within_;
  std::vector<Plane> planes_;
  std::size_t seen_ = 0;             // of these, beside the rim; the normals of the others may be turned over
  std::vector<std::size_t> beside_;  // the plane of the face beside each edge of the rim
  std::vector<Index> first_;
  std::vector<std::size_t> wall_;  // planes
};

}  // namespace

std::vector<Index> FlatWalls::nodes_beside(std::size_t wall) const {
  std::vector<Index> out;
  if (nodes.empty()) return out;
  const Index last = node[wall];
  for (Index k = node[(wall + 1) % first.size()]; k != last; k += k < last ? 1 : -1) out.push_back(k);
  out.push_back(last);
  return out;
}

std::optional<FlatWalls> flat_walls(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim, double across,
                                    const std::vector<Index>& near) {
  return WallFinder(mesh, around, rim, across, near).walls();
}

}  // namespace tripatch
