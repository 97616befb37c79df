#include "tripatch/creases/wall_meeting.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "tripatch/math/plane.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/math/tolerant_compare.h"
#include "tripatch/mesh/edge_key.h"

namespace tripatch {
namespace {

/// Runs of the rim along one wall each of which all ways to meet are tried: nine have 429. Of more, one meets all others.
constexpr std::size_t max_runs = 9;
/// Of the volume that three unit normals span, or the area of two: less, and it is chance where their curved walls meet.
constexpr double min_span = share::trace;
/// Points along a curved crease: over a quarter of a circle what is smooth through them is 1e-9 of the radius off, their chords 1e-4.
constexpr Index curve_points = 49;

/// Moves points along a curve so that its ends are these, and what lies between them by its share of that.
void put_ends(Points& points, const Vec3& from, const Vec3& to) {
  const Eigen::VectorXd t = Eigen::VectorXd::LinSpaced(points.rows(), 0, 1);
  const Eigen::RowVector3d first = from.transpose() - points.row(0), last = to.transpose() - points.row(points.rows() - 1);
  points += (1 - t.array()).matrix() * first + t * last;
}

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
    const double far = cross2(way, polygon.row(v % n) - a) / std::max(way.norm(), tolerance::tiny);
    return far > within ? 1 : far < -within ? -1 : 0;
  };
  for (Index i = 0; i < n; ++i)
    for (Index j = i + 2; j < n; ++j)
      if (side_of(i, j) * side_of(i, j + 1) < 0 && side_of(j, i) * side_of(j, i + 1) < 0) return true;
  return false;
}

class MeetingSearch {
public:
  MeetingSearch(const std::vector<Wall>& walls, const Points& rim, const std::vector<std::size_t>& wall, double across)
      : walls_(walls), rim_(rim), wall_(wall), across_(across), within_(tolerance::close * across), n_(rim.rows()) {
    for (Index k = 0; k < n_; ++k)
      if (wall[k] != wall[(k + n_ - 1) % n_]) first_.push_back(k);
  }

  std::optional<WallMeeting> least() {
    const std::size_t m = first_.size();
    if (m < 2) return {};
    const bool all_seen = std::ranges::all_of(wall_, [&](std::size_t w) { return walls_[w].has_faces(); });
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
    const std::optional<Vec3> node = common_point(of);
    if (!node) return {};
    Index nearest = 0;
    const double far = (rim_.rowwise() - node->transpose()).rowwise().norm().minCoeff(&nearest);
    if (!(far < across_)) return {};  // the fill would leave the hole
    const double within = std::max({walls_[of[0]].within(), walls_[of[1]].within(), walls_[of[2]].within()});
    if (far < within) return nearest;
    for (std::size_t k = 0; k < nodes_.size(); ++k)
      if ((nodes_[k] - *node).norm() < within) return n_ + static_cast<Index>(k);
    nodes_.push_back(*node);
    deviation_.push_back(deviation({of.begin(), of.end()}, node->transpose())[0]);
    return n_ + static_cast<Index>(nodes_.size()) - 1;
  }

  /// By Newton's steps, of which planes need one.
  std::optional<Vec3> common_point(const std::array<std::size_t, 3>& of) const {
    const bool flat = std::ranges::all_of(of, [&](std::size_t w) { return walls_[w].is_flat(); });
    Vec3 node = flat ? Vec3(rim_.row(0)) : Vec3(rim_.colwise().mean().transpose());
    for (int step = 0; step < tolerance::newton_steps; ++step) {
      Eigen::Matrix3d normals;
      Vec3 distance;
      for (int k = 0; k < 3; ++k) {
        const Wall::At at = walls_[of[k]].at(node.transpose());
        normals.row(k) = at.normal.row(0);
        distance[k] = at.distance[0];
      }
      const Vec3 way = normals.partialPivLu().solve(distance);
      node -= way;
      if (flat) return node;
      if (!(std::abs(normals.determinant()) > min_span) || !(way.norm() < 3 * across_)) return {};
      if (way.norm() < tie * across_) return node;
    }
    return {};
  }

  /// Points of two walls' crease, from one of its points to another.
  std::optional<Points> crease(const std::array<std::size_t, 2>& of, const Vec3& from, const Vec3& to) const {
    const Wall &a = walls_[of[0]], &b = walls_[of[1]];
    const bool straight = a.is_flat() && b.is_flat();
    const Index n = straight ? 2 : curve_points;
    const Eigen::VectorXd t = Eigen::VectorXd::LinSpaced(n, 0, 1);
    Points points = (1 - t.array()).matrix() * from.transpose() + t * to.transpose();
    if (straight) return points;
    const Vec3 along = (to - from).stableNormalized();
    double longest = across_;
    for (int step = 0; step < tolerance::newton_steps && longest > tie * across_; ++step) {
      const Wall::At one = a.at(points), other = b.at(points);
      longest = 0;
      for (Index k = 0; k < n; ++k) {  // at a right angle to the chord
        Eigen::Matrix<double, 2, 3> slopes;
        slopes << one.normal.row(k), other.normal.row(k);
        slopes -= slopes * along * along.transpose();
        const Eigen::Matrix2d among = slopes * slopes.transpose();
        if (!(among.determinant() > min_span * min_span)) return {};
        const Vec3 way = slopes.transpose() * among.inverse() * Vec2(one.distance[k], other.distance[k]);
        points.row(k) -= way.transpose();
        longest = std::max(longest, way.norm());
      }
      if (!(longest < across_)) return {};
    }
    if (!(longest < std::max(a.within(), b.within()))) return {};
    put_ends(points, from, to);  // they lie in both walls but for noise
    return points;
  }

  /// Of points where walls meet: each wall's own, across it.
  Eigen::VectorXd deviation(const std::vector<std::size_t>& of, const Points& points) const {
    const Index m = static_cast<Index>(of.size());
    std::vector<Eigen::VectorXd> own;
    std::vector<Wall::At> at;
    for (const std::size_t w : of) own.push_back(walls_[w].deviation(points)), at.push_back(walls_[w].at(points));
    Eigen::VectorXd out(points.rows());
    for (Index k = 0; k < points.rows(); ++k) {
      Eigen::MatrixXd normals(m, 3), errors = Eigen::MatrixXd::Zero(m, m);
      for (Index w = 0; w < m; ++w) normals.row(w) = at[w].normal.row(k), errors(w, w) = own[w][k];
      out[k] = (normals.transpose() * (normals * normals.transpose()).ldlt().solve(errors)).norm();
    }
    return out;
  }

  std::optional<WallMeeting> meeting(const Triangles& triangles) {
    std::map<std::array<std::size_t, 2>, std::size_t> third;  // of the triangle on the left of a side
    for (const auto& [i, k, j] : triangles) third[{i, k}] = j, third[{k, j}] = i, third[{j, i}] = k;
    WallMeeting out;
    out.runs = first_.size();
    std::vector<char> done(first_.size(), 0);
    for (std::size_t run = 0; run < first_.size(); ++run)
      if (!done[run]) {
        const std::optional<std::vector<Index>> corners = around_part(run, third, done, out);
        if (!corners) return {};
        split(*corners, wall(run), out);
      }
    for (std::size_t k = 0; k < out.parts.size(); ++k) {
      const double towards = signed_area(outline(out, k)), own = walls_[out.wall[k]].has_faces() ? towards : std::abs(towards);
      if (!(own > within_ * across_)) return {};
      out.area += own;
    }
    if (out.parts.empty()) return {};
    return out;
  }

  /// The corners of the part that begins with a run, which may continue beyond other runs of its wall. None where two walls do not meet.
  std::optional<std::vector<Index>> around_part(std::size_t start, const std::map<std::array<std::size_t, 2>, std::size_t>& third,
                                                std::vector<char>& done, WallMeeting& out) {
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
          if (!go(corner, to, {wall(here), wall(other)}, corners, out)) return {};
          corner = to;
        }
        other = run;
      }
      if (!go(corner, first_[here], {wall(here), wall(other)}, corners, out)) return {};
    } while (here != start);
    return corners;
  }

  /// Along a crease, which vertices of the rim that lie on it divide; all but its end. False where there is none.
  bool go(Index from, Index to, std::array<std::size_t, 2> of, std::vector<Index>& corners, WallMeeting& out) {
    if (from == to) return true;
    std::ranges::sort(of);
    const bool turned = from > to;
    const EdgeKey ends = edge_key(from, to);
    auto known = ways_.find({ends, of});
    if (known == ways_.end()) known = ways_.emplace(std::pair(ends, of), divided(ends, of)).first;
    const std::vector<Step>& steps = known->second;
    if (steps.empty()) return false;
    for (const Step& step : steps)
      if (step.points.rows() > 0) {
        const auto [crease, added] =
            out.creases.try_emplace(edge_key(step.from, step.to), WallCrease{step.points, step.deviation, of});
        if (!added && crease->second.walls != of && step.points.rows() > 2) return false;
        if (added && step.from > step.to) {
          crease->second.points = step.points.colwise().reverse().eval();
          crease->second.deviation = step.deviation.reverse().eval();
        }
      }
    for (std::size_t k = 0; k < steps.size(); ++k) corners.push_back(turned ? steps[steps.size() - 1 - k].to : steps[k].from);
    return true;
  }

  /// Between two vertices of the rim or nodes that follow each other along a crease; points: none along an edge of the rim.
  struct Step {
    Index from, to;
    Points points;
    Eigen::VectorXd deviation;
  };

  std::vector<Step> divided(const std::array<Index, 2>& ends, const std::array<std::size_t, 2>& of) const {
    const std::optional<Points> points = crease(of, at(ends[0]), at(ends[1]));
    if (!points) return {};
    const double within = std::max(walls_[of[0]].within(), walls_[of[1]].within()),
                 last = static_cast<double>(points->rows() - 1);
    const PiecewisePolynomial curve = smooth_through(*points);
    std::vector<std::pair<double, Index>> on = {{0, ends[0]}};  // place among the points, corner
    for (Index v = 0; v < n_; ++v) {
      if (v == ends[0] || v == ends[1]) continue;
      double least = within, place = 0;
      for (Index k = 0; k + 1 < points->rows(); ++k) {
        const Vec3 a = points->row(k), way = points->row(k + 1).transpose() - a, p = Vec3(rim_.row(v)) - a;
        const double share = std::clamp(p.dot(way) / way.squaredNorm(), 0.0, 1.0);
        if (const double far = (p - share * way).norm(); far < least) least = far, place = static_cast<double>(k) + share;
      }
      if (place > 0 && place < last) on.emplace_back(place, v);
    }
    std::ranges::sort(on);
    on.emplace_back(last, ends[1]);
    std::vector<Step> steps;
    for (std::size_t k = 0; k + 1 < on.size(); ++k) {
      const auto [begin, from] = on[k];
      const auto [end, to] = on[k + 1];
      steps.push_back({from, to, Points(0, 3), {}});
      if (is_edge(from, to)) continue;
      Points& own = steps.back().points;
      own.resize(std::max<Index>(static_cast<Index>(std::ceil(end) - std::floor(begin)), 1) + 1, 3);
      for (Index j = 0; j < own.rows(); ++j)
        own.row(j) = curve(std::lerp(begin, end, static_cast<double>(j) / static_cast<double>(own.rows() - 1)) / last);
      put_ends(own, at(from), at(to));
      steps.back().deviation = deviation({of.begin(), of.end()}, own);
    }
    return steps;
  }

  bool is_edge(Index a, Index b) const { return a < n_ && b < n_ && ((a + 1) % n_ == b || (b + 1) % n_ == a); }

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

  /// With the nodes that are used.
  void complete(WallMeeting& meeting) const {
    std::vector<Index> number(nodes_.size(), -1);
    const auto own = [&](Index corner) {
      if (corner < n_) return corner;
      Index& found = number[static_cast<std::size_t>(corner - n_)];
      if (found < 0) {
        found = n_ + static_cast<Index>(meeting.nodes.size());
        meeting.nodes.push_back(at(corner));
        meeting.deviation.push_back(deviation_[static_cast<std::size_t>(corner - n_)]);
      }
      return found;
    };
    for (std::vector<Index>& part : meeting.parts)
      for (Index& corner : part) corner = own(corner);
    std::map<std::array<Index, 2>, WallCrease> creases;
    for (auto& [ends, crease] : meeting.creases) {
      std::array<Index, 2> key = {own(ends[0]), own(ends[1])};
      if (key[0] > key[1]) {
        std::swap(key[0], key[1]);
        crease.points = crease.points.colwise().reverse().eval();
        crease.deviation = crease.deviation.reverse().eval();
      }
      creases.emplace(key, std::move(crease));
    }
    meeting.creases = std::move(creases);
  }

  PlanePoints outline(const WallMeeting& meeting, std::size_t part) const {
    const std::vector<Index>& corners = meeting.parts[part];
    std::vector<Vec3> points;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const Index from = corners[k], to = corners[(k + 1) % corners.size()];
      points.push_back(at(from));
      const auto found = meeting.creases.find(edge_key(from, to));
      const Index inner = found == meeting.creases.end() ? 0 : found->second.points.rows() - 2;
      for (Index j = 1; j <= inner; ++j) points.emplace_back(found->second.points.row(from < to ? j : inner + 1 - j));
    }
    Points rows(static_cast<Index>(points.size()), 3);
    for (Index k = 0; k < rows.rows(); ++k) rows.row(k) = points[static_cast<std::size_t>(k)].transpose();
    return walls_[meeting.wall[part]].seen_from_outside(rows);
  }
  bool crosses_itself(const WallMeeting& meeting) const {
    for (std::size_t k = 0; k < meeting.parts.size(); ++k)
      if (crosses_its_sides(outline(meeting, k), 2 * walls_[meeting.wall[k]].within())) return true;
    return false;
  }

  const std::vector<Wall>& walls_;
  const Points& rim_;
  const std::vector<std::size_t>& wall_;
  double across_, within_;
  Index n_;
  std::vector<Index> first_;  // places of the rim where runs begin
  std::vector<Vec3> nodes_;
  std::vector<double> deviation_;                                                                  // of the nodes
  std::map<std::pair<std::array<Index, 2>, std::array<std::size_t, 2>>, std::vector<Step>> ways_;  // by ends and walls
  std::map<std::array<std::size_t, 3>, std::optional<Index>> corners_;
};

}  // namespace

PiecewisePolynomial smooth_through(const Points& points) {
  const Eigen::VectorXd t = Eigen::VectorXd::LinSpaced(points.rows(), 0, 1);
  return PiecewisePolynomial::spline({t.data(), static_cast<std::size_t>(t.size())},
                                     {points.data(), static_cast<std::size_t>(points.size())}, 3);
}

std::optional<WallMeeting> least_meeting(const std::vector<Wall>& walls, const Points& rim, const std::vector<std::size_t>& wall,
                                         double across) {
  if (wall.empty()) return {};
  return MeetingSearch(walls, rim, wall, across).least();
}

}  // namespace tripatch
