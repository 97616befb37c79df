#include "tripatch/creases/wall_meeting.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "tripatch/math/plane.h"
#include "tripatch/math/tolerant_compare.h"

namespace tripatch {
namespace {

/// Runs of the rim along one wall each of which all ways to meet are tried: nine have 429. Of more, one meets all others.
constexpr std::size_t max_runs = 9;
/// Of the hole's diameter, from the nearest vertex of the rim: where walls meet farther off, the fill would leave the hole.
constexpr double farthest_node = 1;

double cross2(const Eigen::RowVector2d& a, const Eigen::RowVector2d& b) { return a[0] * b[1] - a[1] * b[0]; }

double signed_area(const PlanePoints& polygon) {
  double twice = 0;
  for (Index k = 1; k + 1 < polygon.rows(); ++k)
    twice += cross2(polygon.row(k) - polygon.row(0), polygon.row(k + 1) - polygon.row(0));
  return twice / 2;
}

/// Whether two sides of a polygon cross by more than `within`.
bool crosses_its_sides(const PlanePoints& polygon, double within) {
  const Index n = polygon.rows();
  const auto side_of = [&](Index k, Index v) {  // of the line through side k
    const Eigen::RowVector2d a = polygon.row(k), way = polygon.row((k + 1) % n) - a;
    const double far = cross2(way, polygon.row(v % n) - a) / std::max(way.norm(), 1e-300);
    return far > within ? 1 : far < -within ? -1 : 0;
  };
  for (Index i = 0; i < n; ++i)
    for (Index j = i + 2; j < n; ++j)
      if (side_of(i, j) * side_of(i, j + 1) < 0 && side_of(j, i) * side_of(j, i + 1) < 0) return true;
  return false;
}

class MeetingSearch {
public:
  MeetingSearch(const std::vector<WallPlane>& walls, const Points& rim, const std::vector<std::size_t>& wall, double across)
      : walls_(walls), rim_(rim), wall_(wall), across_(across), within_(in_plane * across), n_(rim.rows()) {
    for (Index k = 0; k < n_; ++k)
      if (wall[k] != wall[(k + n_ - 1) % n_]) first_.push_back(k);
  }

  std::optional<WallMeeting> least() {
    const std::size_t m = first_.size();
    if (m < 2) return {};
    const bool all_seen = std::ranges::all_of(wall_, [&](std::size_t w) { return walls_[w].has_faces; });
    std::optional<WallMeeting> best;
    for (const Triangles& triangles : all_seen&& m <= max_runs ? triangulations(0, m - 1) : fans()) {
      std::optional<WallMeeting> found = meeting(triangles);
      if (!found || (best && !clearly_less(found->area, best->area)) || crosses_itself(*found)) continue;
      best = std::move(found);
    }
    if (best) complete(*best);
    return best;
  }

private:
  using Triangles = std::vector<std::array<std::size_t, 3>>;

  /// Whether three runs have a corner, or need none.
  bool meet(std::size_t i, std::size_t k, std::size_t j) {
    return wall(i) == wall(k) || wall(k) == wall(j) || wall(j) == wall(i) || corner_of({wall(i), wall(k), wall(j)});
  }

  /// Of the runs i to j.
  std::vector<Triangles> triangulations(std::size_t i, std::size_t j) {
    if (j < i + 2) return {{}};
    std::vector<Triangles> all;
    for (std::size_t k = i + 1; k < j; ++k) {
      if (!meet(i, k, j)) continue;
      for (const Triangles& before : triangulations(i, k))
        for (const Triangles& after : triangulations(k, j)) {
          all.push_back(before);
          all.back().insert(all.back().end(), after.begin(), after.end());
          all.back().push_back({i, k, j});
        }
    }
    return all;
  }

  /// One run meets all others.
  std::vector<Triangles> fans() {
    const std::size_t m = first_.size();
    std::vector<Triangles> all;
    for (std::size_t hub = 0; hub < m; ++hub) {
      Triangles fan;
      for (std::size_t k = 1; k + 1 < m; ++k)
        if (const std::size_t a = (hub + k) % m, b = (hub + k + 1) % m; meet(hub, a, b)) fan.push_back({hub, a, b});
      if (fan.size() + 2 == m) all.push_back(std::move(fan));
    }
    return all;
  }

  std::size_t wall(std::size_t run) const { return wall_[static_cast<std::size_t>(first_[run])]; }
  Vec3 at(Index corner) const { return corner < n_ ? Vec3(rim_.row(corner)) : nodes_[static_cast<std::size_t>(corner - n_)]; }

  /// Where three walls meet: a vertex of the rim, or a node.
  std::optional<Index> corner_of(std::array<std::size_t, 3> of) {
    std::ranges::sort(of);
    const auto known = corners_.find(of);
    return known != corners_.end() ? known->second : corners_.emplace(of, new_corner(of)).first->second;
  }
  std::optional<Index> new_corner(const std::array<std::size_t, 3>& of) {
    Eigen::Matrix3d normals;
    Vec3 distance;
    const Vec3 origin = rim_.row(0);
    for (int k = 0; k < 3; ++k) {
      normals.row(k) = walls_[of[k]].normal;
      distance[k] = walls_[of[k]].distance(origin);
    }
    const Vec3 node = origin - Vec3(normals.partialPivLu().solve(distance));
    Index nearest = 0;
    const double far = (rim_.rowwise() - node.transpose()).rowwise().norm().minCoeff(&nearest);
    if (!(far < farthest_node * across_)) return {};
    if (far < within_) return nearest;
    for (std::size_t k = 0; k < nodes_.size(); ++k)
      if ((nodes_[k] - node).norm() < within_) return n_ + static_cast<Index>(k);
    nodes_.push_back(node);
    return n_ + static_cast<Index>(nodes_.size()) - 1;
  }

  std::optional<WallMeeting> meeting(const Triangles& triangles) {
    std::map<std::array<std::size_t, 2>, std::size_t> third;  // of the triangle on the left of a side
    for (const auto& [i, k, j] : triangles) third[{i, k}] = j, third[{k, j}] = i, third[{j, i}] = k;
    WallMeeting out;
    out.runs = first_.size();
    std::vector<char> done(first_.size(), 0);
    for (std::size_t run = 0; run < first_.size(); ++run)
      if (!done[run]) split(around_part(run, third, done), wall(run), out);
    for (std::size_t k = 0; k < out.parts.size(); ++k) {
      const double towards = signed_area(outline(out, k)), own = walls_[out.wall[k]].has_faces ? towards : std::abs(towards);
      if (!(own > within_ * across_)) return {};
      out.area += own;
    }
    if (out.parts.empty()) return {};
    return out;
  }

  /// The corners of the part that begins with a run, which may continue beyond other runs of its wall.
  std::vector<Index> around_part(std::size_t start, const std::map<std::array<std::size_t, 2>, std::size_t>& third,
                                 std::vector<char>& done) {
    std::vector<Index> corners;
    std::size_t here = start;
    do {
      done[here] = 1;
      std::size_t other = (here + 1) % first_.size();
      Index corner = first_[other];
      for (Index k = first_[here]; k != corner; k = (k + 1) % n_) corners.push_back(k);
      for (auto next = third.find({here, other}); next != third.end(); next = third.find({here, other})) {
        const std::size_t run = next->second;
        if (wall(run) == wall(here)) {
          here = run;
          continue;
        }
        if (wall(run) != wall(other)) {
          const Index to = *corner_of({wall(here), wall(other), wall(run)});
          go(corner, to, corners);
          corner = to;
        }
        other = run;
      }
      go(corner, first_[here], corners);
    } while (here != start);
    return corners;
  }

  /// Along a crease, which vertices of the rim that lie on it divide; all but its end.
  void go(Index from, Index to, std::vector<Index>& corners) const {
    if (from == to) return;
    const Vec3 a = at(from), way = at(to) - a;
    std::vector<std::pair<double, Index>> on = {{0, from}};  // share of the way, corner
    for (Index v = 0; v < n_; ++v) {
      const Vec3 p = Vec3(rim_.row(v)) - a;
      const double share = p.dot(way) / way.squaredNorm();
      if (v != from && v != to && share > 0 && share < 1 && (p - share * way).norm() < within_) on.emplace_back(share, v);
    }
    std::ranges::sort(on);
    for (const auto& [share, v] : on) corners.push_back(v);
  }

  /// Where the border of a part comes back to a corner, both sides of that are parts.
  static void split(const std::vector<Index>& corners, std::size_t wall, WallMeeting& out) {
    const auto add = [&](std::vector<Index> part) {
      if (part.size() < 3) return;
      out.parts.push_back(std::move(part));
      out.wall.push_back(wall);
    };
    std::vector<Index> open;
    for (const Index corner : corners) {
      if (const auto before = std::ranges::find(open, corner); before != open.end()) {
        add({before, open.end()});
        open.erase(before, open.end());
      }
      open.push_back(corner);
    }
    add(std::move(open));
  }

  /// With the nodes that are used, and creases.
  void complete(WallMeeting& meeting) const {
    std::vector<Index> number(nodes_.size(), -1);
    for (std::vector<Index>& part : meeting.parts)
      for (Index& corner : part) {
        if (corner < n_) continue;
        Index& own = number[static_cast<std::size_t>(corner - n_)];
        if (own < 0) {
          own = n_ + static_cast<Index>(meeting.nodes.size());
          meeting.nodes.push_back(at(corner));
        }
        corner = own;
      }
    const auto is_edge = [&](Index a, Index b) { return a < n_ && b < n_ && ((a + 1) % n_ == b || (b + 1) % n_ == a); };
    for (const std::vector<Index>& part : meeting.parts)
      for (std::size_t k = 0; k < part.size(); ++k)
        if (const Index a = part[k], b = part[(k + 1) % part.size()]; !is_edge(a, b))
          meeting.creases.insert({std::min(a, b), std::max(a, b)});
  }

  /// Seen from outside.
  PlanePoints outline(const WallMeeting& meeting, std::size_t part) const {
    const Vec3 &normal = walls_[meeting.wall[part]].normal, along = normal.unitOrthogonal(), beside = normal.cross(along);
    PlanePoints out(static_cast<Index>(meeting.parts[part].size()), 2);
    for (Index k = 0; k < out.rows(); ++k) {
      const Vec3 p = at(meeting.parts[part][k]) - Vec3(rim_.row(0));
      out.row(k) << p.dot(along), p.dot(beside);
    }
    return out;
  }
  bool crosses_itself(const WallMeeting& meeting) const {
    for (std::size_t k = 0; k < meeting.parts.size(); ++k)
      if (crosses_its_sides(outline(meeting, k), 2 * within_)) return true;
    return false;
  }

  const std::vector<WallPlane>& walls_;
  const Points& rim_;
  const std::vector<std::size_t>& wall_;
  double across_, within_;
  Index n_;
  std::vector<Index> first_;  // places of the rim where runs begin
  std::vector<Vec3> nodes_;
  std::map<std::array<std::size_t, 3>, std::optional<Index>> corners_;
};

}  // namespace

std::optional<WallMeeting> least_meeting(const std::vector<WallPlane>& walls, const Points& rim,
                                         const std::vector<std::size_t>& wall, double across) {
  if (wall.empty()) return {};
  return MeetingSearch(walls, rim, wall, across).least();
}

}  // namespace tripatch
