#include "tripatch/creases/walls.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

#include "tripatch/math/angle.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/math/tolerant_compare.h"
#include "tripatch/mesh/edge_key.h"
#include "tripatch/mesh/submesh.h"
#include "tripatch/mesh/vertex_normals.h"

namespace tripatch {
namespace {

/// Between edges of the rim that tell the plane of a wall that has no face left, at least.
constexpr double min_turn = 20 * std::numbers::pi / 180;
/// Between a flat rim and walls that end there, at least: the corner of a box with chamfers of one face (35 degrees) is a rounded one's.
constexpr double min_end_angle = 40 * std::numbers::pi / 180;
/// The same where it is enough that half of the rim's edges have it.
constexpr double clear_end_angle = radians(angle::steep);
/// The same where walls lean far under the rim, less than 30 degrees from what lies in it: whatever continues from them leaves the hole, so that
/// walls need not meet at creases.
constexpr double under_rim = 150 * std::numbers::pi / 180;
/// Between faces of one wall, at most.
constexpr double in_one_wall = radians(angle::flat);
/// Radians over half of the hole's diameter: walls that bend by less away from the rim are straight. The end of a spring whose wire is a fifth as
/// thick as its coil bends by 0.17 there, a ball cut in half by 1.
constexpr double min_bend = share::tenth;
/// Planes next to a rim, as a prism has them whose walls meet at min_crease_angle; and planes that may be those of walls without faces.
constexpr std::size_t max_planes = count::places, max_unseen = count::octet;
/// Walls that seem to have lost nothing, where nothing else meets: of one a sliver may be left, two are the solid's shape.
constexpr int max_whole = 1;
/// Walls of a hole of which no face is left: what one vertex of a solid takes with it.
constexpr std::size_t max_lost = count::few;

/// Around a rim in a plane: where all of that is flat, any fill is.
constexpr int flat_rings = count::half_dozen;

class WallFinder {
public:
  /// Faces of walls are sought at the vertices `near`, sorted.
  WallFinder(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim, double across,
             const std::vector<Index>& near, const std::vector<std::array<Index, 2>>* sharp)
      : mesh_(mesh),
        around_(around),
        rim_(rim),
        near_(near),
        sharp_(sharp),
        n_(static_cast<Index>(rim.size())),
        across_(across) {}

  /// Planes, or else smooth pieces.
  std::optional<Walls> walls() {
    if (const Wall flat = plane_of_rim(); contains(flat, rim_)) return wall_of(flat);
    std::optional<Walls> found = read_planes() ? meeting_walls() : std::nullopt;
    return found || !read_pieces() ? found : meeting_walls();
  }

  /// walls_end_at_flat_rim.
  bool walls_end() const {
    const Wall flat = plane_of_rim();
    if (n_ < 4 || !contains(flat, rim_)) return false;
    std::vector<Vec3> normal;
    Index least = 0, clear = 0, under = 0, upright = 0;
    for (Index k = 0; k < n_; ++k) {
      const auto corner = around_.edge(rim_[(k + 1) % n_], rim_[k]);
      if (!corner) return false;
      normal.push_back(area_vector(mesh_, around_.face(*corner)));
      if (normal.back().isZero(0)) return false;
      const double angle = angle_between(normal.back(), flat.normal());
      if (angle < min_crease_angle) return false;
      least += angle > min_end_angle;
      clear += angle > clear_end_angle;
      under += angle > under_rim;
      upright += angle > clear_end_angle && angle < std::numbers::pi / 2 + in_one_wall;
    }
    if (least < n_ && 2 * clear < n_) return false;
    const double apart = under == n_ ? in_one_wall : min_crease_angle;
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
  /// Those that are seen, where they meet; else as few as will do, with others that are lost; else with one that seems whole.
  std::optional<Walls> meeting_walls() {
    const Points points = mesh_.vertices(rim_, Eigen::all);
    const auto meeting = [&](int whole) { return least_meeting(walls_, points, walls_of_edges(whole), across_); };
    std::optional<WallMeeting> best = meeting(0);
    const std::vector<Wall> unseen = best || !all_flat() ? std::vector<Wall>() : unseen_planes();
    for (std::size_t lost = 1; lost <= std::min(max_lost, unseen.size()); ++lost) {
      const std::size_t fewest = best ? best->runs : std::numeric_limits<std::size_t>::max();
      std::vector<char> taken(unseen.size(), 0);
      std::fill(taken.begin(), taken.begin() + lost, 1);
      do {
        walls_.erase(walls_.begin() + static_cast<std::ptrdiff_t>(seen_), walls_.end());
        for (std::size_t k = 0; k < unseen.size(); ++k)
          if (taken[k]) walls_.push_back(unseen[k]);
        std::optional<WallMeeting> found = meeting(0);
        const auto rank = [](const WallMeeting& m) { return std::pair(m.runs, m.area); };
        if (found && found->runs < fewest && (!best || rank(*found) < rank(*best))) best = std::move(found);
      } while (std::prev_permutation(taken.begin(), taken.end()));
    }
    walls_.erase(walls_.begin() + static_cast<std::ptrdiff_t>(seen_), walls_.end());
    if (!best) best = meeting(max_whole);
    if (!best) return {};
    Walls walls{
        std::move(best->nodes), std::move(best->deviation), std::move(best->parts), std::move(best->creases), {}, all_flat()};
    const std::vector<Index> near = near_faces();
    for (const std::size_t p : best->wall)
      walls.faces.push_back(p < seen_ ? faces_of_wall(walls_[p], near) : std::vector<Index>());
    return walls;
  }

  /// Whether the faces at the rim go straight on away from it, or end at sharp edges there.
  bool are_straight() const {
    const auto on_rim = [&](Index v) { return std::ranges::find(rim_, v) != rim_.end(); };
    for (const Index v : rim_)
      for (const Connectivity::Corner c : around_.at(v)) {
        const Index f = around_.face(c);
        const IndicesRef face = mesh_.faces[f];
        for (std::size_t k = 0; k < face.size(); ++k) {
          const Index a = face[k], b = face[(k + 1) % face.size()];
          const auto beyond = on_rim(a) || on_rim(b) ? std::nullopt : around_.edge(b, a);
          if (!beyond) continue;
          const Index g = around_.face(*beyond);
          const double turn = angle_between(area_vector(mesh_, f), area_vector(mesh_, g));
          if (turn < min_crease_angle && turn * across_ / 2 > min_bend * (middle(f) - middle(g)).norm()) return false;
        }
      }
    return true;
  }
  Vec3 middle(Index face) const {
    const IndicesRef corners = mesh_.faces[face];
    Vec3 sum = Vec3::Zero();
    for (const Index v : corners) sum += point(v);
    return sum / static_cast<double>(corners.size());
  }

  Vec3 point(Index v) const { return mesh_.vertices.row(v); }
  Vec3 at(Index place) const { return point(rim_[place % n_]); }
  bool contains(const Wall& wall, const Vec3& p) const { return std::abs(wall.distance(p)) < wall.within(); }
  template <class Vertices>
  bool contains(const Wall& wall, const Vertices& vertices) const {
    return std::all_of(vertices.begin(), vertices.end(), [&](Index v) { return contains(wall, point(v)); });
  }

  bool lies_in(Index face, const Wall& wall) const {
    if (!wall.is_flat()) return std::ranges::binary_search(wall.faces(), face);
    return area_vector(mesh_, face).dot(wall.normal()) > 0 && contains(wall, mesh_.faces[face]);
  }
  bool all_flat() const { return std::ranges::all_of(walls_, &Wall::is_flat); }

  /// Of the faces next to the rim's edges, the largest first: its plane is known best. False where these are not flat, or too many.
  bool read_planes() {
    const std::vector<Index> faces = faces_at_rim();
    std::vector<Index> order(faces);
    std::ranges::stable_sort(order, std::greater(), [&](Index f) { return coarse(area_vector(mesh_, f).norm()); });
    for (const Index f : order) {
      if (std::ranges::any_of(walls_, [&](const Wall& wall) { return lies_in(f, wall); })) continue;
      walls_.emplace_back(area_vector(mesh_, f).stableNormalized(), point(mesh_.faces[f][0]), across_);
      if (walls_.size() > max_planes || !lies_in(f, walls_.back())) return false;
    }
    seen_ = walls_.size();
    for (const Index f : faces) {  // a narrow one lies in several
      std::size_t best = 0;
      double nearest = -1;
      for (std::size_t p = 0; p < seen_; ++p)
        if (const double along = area_vector(mesh_, f).stableNormalized().dot(walls_[p].normal());
            lies_in(f, walls_[p]) && clearly_more(along, nearest))
          nearest = along, best = p;
      beside_.push_back(best);
    }
    return seen_ > 1;
  }

  /// Next to each edge; empty where one is missing.
  std::vector<Index> faces_at_rim() const {
    std::vector<Index> faces;
    for (Index k = 0; k < n_; ++k) {
      const auto corner = around_.edge(rim_[(k + 1) % n_], rim_[k]);
      if (!corner) return {};
      faces.push_back(around_.face(*corner));
    }
    return faces;
  }

  /// The smooth pieces between sharp edges of the faces next to the rim, flat or curved. False where one does not tell how it continues, or all are flat.
  bool read_pieces() {
    walls_.clear();
    beside_.clear();
    if (!sharp_) return false;
    Numbering seen(mesh_.faces.size());
    std::vector<std::size_t> number;  // of each face's piece
    std::vector<SmoothPiece> pieces;
    for (const Index f : faces_at_rim()) {
      if (seen.find(f) < 0) {
        std::vector<Index> piece = grown(f, seen);
        number.resize(seen.size(), number_of(std::move(piece), pieces));
      }
      if (pieces.size() > max_planes) return false;
      beside_.push_back(number[static_cast<std::size_t>(seen.find(f))]);
    }
    if (pieces.size() < 2 || std::ranges::all_of(pieces, [](const SmoothPiece& piece) { return piece.plane.has_value(); }))
      return false;  // most holes: before anything is fitted
    std::vector<std::optional<Wall>> read(pieces.size());
    std::vector<std::size_t> order(pieces.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, [&](std::size_t k) { return pieces[k].faces.size(); });  // the fastest to read first
    const Points points = mesh_.vertices(rim_, Eigen::all);
    for (const std::size_t k : order) {
      read[k] = pieces[k].plane ? pieces[k].plane : Wall(mesh_, std::move(pieces[k].faces), points, across_);
      if (!read[k]->continues()) return false;
    }
    for (std::optional<Wall>& wall : read) walls_.push_back(std::move(*wall));
    seen_ = walls_.size();
    return true;
  }

  /// The faces near a face that edges which are not sharp connect with it.
  std::vector<Index> grown(Index face, Numbering& seen) const {
    std::vector<Index> piece = {face};
    seen.add(face);
    for (std::size_t next = 0; next < piece.size(); ++next) {
      const IndicesRef corners = mesh_.faces[piece[next]];
      for (std::size_t k = 0; k < corners.size(); ++k) {
        const Index a = corners[k], b = corners[(k + 1) % corners.size()];
        if (std::ranges::binary_search(*sharp_, edge_key(a, b))) continue;
        const auto beyond = around_.edge(b, a);
        if (beyond && is_near(around_.face(*beyond)) && seen.add(around_.face(*beyond))) piece.push_back(around_.face(*beyond));
      }
    }
    return piece;
  }

  /// Faces that no sharp edges part.
  struct SmoothPiece {
    std::optional<Wall> plane;  ///< none: it is curved
    std::vector<Index> faces;
  };

  /// Its number: of one plane's pieces the same.
  std::size_t number_of(std::vector<Index> faces, std::vector<SmoothPiece>& pieces) const {
    const Index largest = *std::ranges::max_element(faces, {}, [&](Index f) { return coarse(area_vector(mesh_, f).norm()); });
    const Wall flat(area_vector(mesh_, largest).stableNormalized(), point(mesh_.faces[largest][0]), across_);
    const auto lie_in = [&](const Wall& wall) { return std::ranges::all_of(faces, [&](Index f) { return lies_in(f, wall); }); };
    const auto same = std::ranges::find_if(pieces, [&](const SmoothPiece& piece) { return piece.plane && lie_in(*piece.plane); });
    if (same != pieces.end()) return static_cast<std::size_t>(same - pieces.begin());
    std::ranges::sort(faces);
    pieces.push_back({lie_in(flat) ? std::optional(flat) : std::nullopt, std::move(faces)});
    return pieces.size() - 1;
  }

  /// Planes of two edges of the rim that follow each other: of a wall that has no face left. None where they are many.
  std::vector<Wall> unseen_planes() const {
    std::vector<Wall> found;
    for (Index k = 0; k < n_; ++k) {
      const Vec3 before = at(k) - at(k + n_ - 1), after = at(k + 1) - at(k), across = before.cross(after);
      if (!(across.norm() > std::sin(min_turn) * before.norm() * after.norm())) continue;
      const auto holds = [&](const Wall& wall) {
        return contains(wall, at(k + n_ - 1)) && contains(wall, at(k)) && contains(wall, at(k + 1));
      };
      if (std::any_of(walls_.begin(), walls_.end(), holds) || std::any_of(found.begin(), found.end(), holds)) continue;
      if (found.size() == max_unseen) return {};
      found.emplace_back(across.stableNormalized(), at(k), across_, false);
    }
    return found;
  }

  /// As new faces face.
  Wall plane_of_rim() const {
    Vec3 middle = Vec3::Zero(), normal = Vec3::Zero();
    for (Index k = 0; k < n_; ++k) {
      middle += at(k) / static_cast<double>(n_);
      normal += (at(k) - at(0)).cross(at(k + 1) - at(0));
    }
    return {normal.stableNormalized(), middle, across_};
  }

  /// The one wall in whose plane the rim is, where it continues next to some of it and ends at the rest, or not far from it.
  std::optional<Walls> wall_of(const Wall& flat) const {
    Index goes_on = 0;
    for (Index k = 0; k < n_; ++k) {
      const auto corner = around_.edge(rim_[(k + 1) % n_], rim_[k]);
      if (!corner) return {};
      const Index face = around_.face(*corner);
      const bool same = lies_in(face, flat);
      if (!same && angle_between(area_vector(mesh_, face), flat.normal()) < min_crease_angle) return {};
      goes_on += same;
    }
    if (goes_on == 0 || (goes_on == n_ && is_in(flat, flat_rings))) return {};
    Walls wall{{}, {}, {std::vector<Index>(static_cast<std::size_t>(n_))}, {}, {faces_of_wall(flat, near_faces())}, true};
    std::iota(wall.parts[0].begin(), wall.parts[0].end(), Index{0});
    return wall;
  }

  /// Whether all faces in so many rings around the rim lie in a plane.
  bool is_in(const Wall& wall, int rings) const {
    Numbering seen(mesh_.vertices.rows());
    for (Index v : rim_) seen.add(v);
    for (std::size_t from = 0; rings > 0; --rings)
      for (const std::size_t to = seen.items().size(); from < to; ++from)
        for (Connectivity::Corner c : around_.at(seen.items()[from])) {
          if (!lies_in(around_.face(c), wall)) return false;
          for (Index w : mesh_.faces[around_.face(c)]) seen.add(w);
        }
    return true;
  }

  /// The wall that each edge is part of: as few changes around the rim as its walls allow, each where a crease shows. Empty where none are
  /// possible, or more walls than `whole` have lost nothing.
  std::vector<std::size_t> walls_of_edges(int whole) const {
    if (!may_meet()) return {};
    const std::size_t walls = walls_.size();
    const double none = std::numeric_limits<double>::infinity();
    const auto cost = [&](Index k, std::size_t p) {
      if (p == beside_[k]) return 0.0;
      const bool in = contains(walls_[p], at(k)) && contains(walls_[p], at(k + 1));
      return !in ? none : (p < seen_ ? 1.0 : 2.0) / (4 * static_cast<double>(n_));  // all together less than a change
    };
    Eigen::MatrixXd costs(n_, walls);
    for (Index k = 0; k < n_; ++k)
      for (std::size_t p = 0; p < walls; ++p) costs(k, p) = cost(k, p);
    std::vector<Eigen::MatrixXd> change;  // at the beginning of each edge, from one wall to another
    for (Index k = 0; k < n_; ++k) {
      change.emplace_back(walls, walls);
      for (std::size_t p = 0; p < walls; ++p)
        for (std::size_t q = 0; q < walls; ++q) {
          const bool may = std::isfinite(costs((k + n_ - 1) % n_, p)) && std::isfinite(costs(k, q));
          change[k](p, q) = p == q ? 0 : may && is_shown(k, p, q) ? 1 : none;
        }
    }
    double least = none;
    std::vector<std::size_t> best;
    for (std::size_t begin = 0; begin < walls; ++begin) {
      std::vector<std::vector<std::size_t>> before(n_, std::vector<std::size_t>(walls, 0));
      Eigen::VectorXd sum = Eigen::VectorXd::Constant(walls, none);
      sum[begin] = costs(0, begin);
      if (!std::isfinite(sum[begin])) continue;
      for (Index k = 1; k < n_; ++k) {
        Eigen::VectorXd next(walls);
        for (std::size_t p = 0; p < walls; ++p) next[p] = costs(k, p) + (sum + change[k].col(p)).minCoeff(&before[k][p]);
        sum = next;
      }
      for (std::size_t p = 0; p < walls; ++p) {
        if (!(sum[p] + change[0](p, begin) < least)) continue;
        least = sum[p] + change[0](p, begin);
        best.assign(n_, p);
        for (Index k = n_ - 1; k > 0; --k) best[k - 1] = before[k][best[k]];
      }
    }
    for (Index k = 0; std::cmp_less(k, best.size()); ++k)
      if (best[k] != best[(k + n_ - 1) % n_] && best[k] < seen_) whole -= seems_whole(best, k);
    return whole < 0 ? std::vector<std::size_t>() : best;
  }

  /// Whether two walls are turned from each other as at a crease, or bend.
  bool may_meet() const {
    if (!all_flat()) return true;
    for (std::size_t p = 0; p < walls_.size(); ++p)
      for (std::size_t q = 0; q < p; ++q)
        if (!(angle_between(walls_[p].normal(), walls_[q].normal()) < min_crease_angle)) return true;
    return false;
  }

  /// Of the wall whose run begins at a place, 1: its border there is straight between two of its corners, or turns around it without a corner
  /// to the other side; more if it is nowhere next to its run.
  int seems_whole(const std::vector<std::size_t>& wall, Index first) const {
    const std::size_t own = wall[first];
    const auto turn =
        [&](Index place) {  // to the left as the border continues around the wall; none where it does not pass there
          const Index k = place % n_, last = (k + n_ - 1) % n_;
          if (beside_[k] != own || beside_[last] != own) return 0.0;
          const Vec3 before = at(k) - at(last), after = at(k + 1) - at(k);
          return std::atan2(before.cross(after).dot(walls_[own].normal_at(at(k))), before.dot(after));
        };
    double turned = 0, most = 0;
    bool is_beside = false;
    Index end = first;
    for (; end == first || (wall[end % n_] == own && end < first + n_); ++end) {
      if (end > first) turned += turn(end), most = std::max(most, turn(end));
      is_beside = is_beside || beside_[end % n_] == own;
    }
    const bool between_corners = turn(first) < -min_turn && turn(end) < -min_turn && turned < min_turn;
    if (!is_beside) return max_whole + 1;
    return between_corners || (turned < -min_turn && most < min_turn) ? 1 : 0;
  }

  /// Whether the crease between two walls that meet at a place of the rim can be seen there.
  bool is_shown(Index place, std::size_t before, std::size_t here) const {
    const double turn = angle_between(walls_[here].normal_at(at(place)), walls_[before].normal_at(at(place)));
    if (turn < min_crease_angle || (std::max(here, before) >= seen_ && turn > std::numbers::pi - min_crease_angle)) return false;
    const std::size_t beside = beside_[place], last = beside_[(place + n_ - 1) % n_];
    if (beside == last && beside != here && beside != before) return true;  // a third wall, which has both edges
    // where the border of one leaves the other, no face of which is left
    if (here >= seen_ && beside == before && !contains(walls_[here], at(place + n_ - 1))) return true;
    if (before >= seen_ && last == here && !contains(walls_[before], at(place + 1))) return true;
    bool leaves_before = false, leaves_here = false;  // for a third wall
    for (Connectivity::Corner c : around_.at(rim_[place])) {
      const Index w = around_.next(c);
      const auto one = around_.edge(rim_[place], w), other = around_.edge(w, rim_[place]);
      if (!one || !other) continue;
      for (const auto& [f, g] :
           {std::pair(around_.face(*one), around_.face(*other)), std::pair(around_.face(*other), around_.face(*one))}) {
        if (lies_in(f, walls_[before]) && lies_in(g, walls_[here])) return true;
        if (angle_between(area_vector(mesh_, f), area_vector(mesh_, g)) < min_crease_angle) continue;
        leaves_before = leaves_before || lies_in(f, walls_[before]);
        leaves_here = leaves_here || lies_in(f, walls_[here]);
      }
    }
    return last == before && beside == here && leaves_before && leaves_here;
  }

  std::vector<Index> faces_of_wall(const Wall& wall, const std::vector<Index>& near) const {
    if (!wall.is_flat()) return wall.faces();
    std::vector<Index> out;
    std::ranges::copy_if(near, std::back_inserter(out), [&](Index f) { return lies_in(f, wall); });
    return out;
  }

  /// Those whose vertices are all near.
  std::vector<Index> near_faces() const {
    Numbering at_near(mesh_.faces.size());
    for (Index v : near_)
      for (Connectivity::Corner c : around_.at(v)) at_near.add(around_.face(c));
    std::vector<Index> out;
    std::ranges::copy_if(at_near.items(), std::back_inserter(out), [&](Index f) { return is_near(f); });
    return out;
  }
  bool is_near(Index face) const {
    return std::ranges::all_of(mesh_.faces[face], [&](Index v) { return std::ranges::binary_search(near_, v); });
  }

  const Mesh& mesh_;
  const Connectivity& around_;
  const std::vector<Index>&rim_, &near_;
  const std::vector<std::array<Index, 2>>* sharp_;  // none: walls are flat
  Index n_;
  double across_;
  std::vector<Wall> walls_;
  std::size_t seen_ = 0;             // of these, next to the rim; the normals of the others may be turned over
  std::vector<std::size_t> beside_;  // the wall of the face next to each edge of the rim
};

}  // namespace

std::optional<Walls> find_walls(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim, double across,
                                const std::vector<Index>& near, const std::vector<std::array<Index, 2>>* sharp) {
  return WallFinder(mesh, around, rim, across, near, sharp).walls();
}

bool walls_end_at_flat_rim(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim, double across) {
  return WallFinder(mesh, around, rim, across, {}, nullptr).walls_end();
}

}  // namespace tripatch
