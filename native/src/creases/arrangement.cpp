#include "tripatch/creases/arrangement.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

#include "tripatch/creases/meetings.h"
#include "tripatch/creases/rim_labels.h"
#include "tripatch/math/ties.h"

namespace tripatch {
namespace {

/// Runs of the rim along one piece each: nine can meet in 429 ways.
constexpr std::size_t most_runs = 9;
/// Walls of a hole of which no face is left: what one vertex of a solid takes with it.
constexpr std::size_t most_lost = 3;
using Triangles3 = std::vector<std::array<std::size_t, 3>>;

/// All triangulations of a polygon's corners i to j.
std::vector<Triangles3> triangulations(std::size_t i, std::size_t j) {
  if (j < i + 2) return {{}};
  std::vector<Triangles3> all;
  for (std::size_t k = i + 1; k < j; ++k)
    for (const Triangles3& before : triangulations(i, k))
      for (const Triangles3& after : triangulations(k, j)) {
        all.push_back(before);
        all.back().insert(all.back().end(), after.begin(), after.end());
        all.back().push_back({i, k, j});
      }
  return all;
}

double cross2(const Eigen::RowVector2d& a, const Eigen::RowVector2d& b) { return a[0] * b[1] - a[1] * b[0]; }

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

double area_of(const PlanePoints& polygon) {
  double twice = 0;
  for (Index k = 1; k + 1 < polygon.rows(); ++k)
    twice += cross2(polygon.row(k) - polygon.row(0), polygon.row(k + 1) - polygon.row(0));
  return twice / 2;
}

/// One way in which runs of the rim meet: a triangulation of them. A triangle is a corner of three pieces, a side a crease of two.
class Meeting {
public:
  struct Curve {
    std::array<Index, 2> ends;
    std::array<std::size_t, 2> pieces;
    Points points;
  };
  struct Loop {
    std::size_t piece;
    std::vector<Arrangement::Step> steps;
  };

  Meeting(Meetings& meetings, const std::vector<SmoothPiece>& pieces, const Points& rim, const std::vector<std::size_t>& labels,
          double across)
      : meetings_(meetings), pieces_(pieces), rim_(rim), labels_(labels), across_(across), n_(rim.rows()) {
    for (Index k = 0; k < n_; ++k)
      if (labels[k] != labels[(k + n_ - 1) % n_]) first_.push_back(k);
  }

  std::size_t runs() const { return first_.size(); }
  const std::vector<Vec3>& nodes() const { return nodes_; }
  const std::vector<std::array<std::size_t, 3>>& pieces_of_nodes() const { return of_node_; }
  const std::vector<Curve>& curves() const { return curves_; }
  const std::vector<Loop>& loops() const { return loops_; }
  double area() const { return area_; }

  /// False where pieces do not meet so.
  bool follow(const Triangles3& triangles) {
    for (const auto& [i, k, j] : triangles) third_[{i, k}] = j, third_[{k, j}] = i, third_[{j, i}] = k;
    std::vector<char> done(runs(), 0);
    for (std::size_t run = 0; run < runs(); ++run) {
      if (done[run]) continue;
      std::vector<Arrangement::Step> steps;
      if (!walk(run, done, steps)) return false;
      split(label(run), steps);
    }
    area_ = 0;
    for (const Loop& loop : loops_) {
      const PlanePoints polygon = pieces_[loop.piece].in_plane(outline(loop.steps));
      const double within = pieces_[loop.piece].tolerance();
      const double own = pieces_[loop.piece].faces().empty() ? std::abs(area_of(polygon)) : area_of(polygon);
      if (!(own > within * across_) || crosses_its_sides(polygon, 2 * within)) return false;
      area_ += own;
    }
    return !loops_.empty();
  }

private:
  std::size_t label(std::size_t run) const { return labels_[static_cast<std::size_t>(first_[run])]; }
  Vec3 at(Index corner) const { return corner < n_ ? Vec3(rim_.row(corner)) : nodes_[static_cast<std::size_t>(corner - n_)]; }
  bool is_beside(Index a, Index b) const { return a < n_ && b < n_ && ((a + 1) % n_ == b || (b + 1) % n_ == a); }

  /// Around the part that begins with a run, which may continue beyond other runs of the same piece.
  bool walk(std::size_t start, std::vector<char>& done, std::vector<Arrangement::Step>& steps) {
    const std::size_t m = runs();
    std::size_t here = start;
    do {
      done[here] = 1;
      std::size_t other = (here + 1) % m;
      Index corner = first_[other];
      for (Index k = first_[here]; k != corner; k = (k + 1) % n_) steps.push_back({k});
      for (;;) {
        const auto found = third_.find({here, other});
        const Index to = found == third_.end() ? first_[here] : -1;
        if (found == third_.end()) {
          if (!meet(corner, to, label(here), label(other), steps)) return false;
          break;
        }
        const std::size_t next = found->second;
        if (label(next) == label(here))
          here = next;
        else if (label(next) == label(other))
          other = next;
        else {
          const std::optional<Index> node = node_of({label(here), label(other), label(next)});
          if (!node || !meet(corner, *node, label(here), label(other), steps)) return false;
          corner = *node;
          other = next;
        }
      }
    } while (here != start);
    return true;
  }

  /// A vertex of the rim, where it is there.
  std::optional<Index> node_of(std::array<std::size_t, 3> of) {
    const std::optional<Vec3> node = meetings_.node(of);
    if (!node) return {};
    double within = 0;
    for (const std::size_t p : of) within = std::max(within, pieces_[p].tolerance());
    Index nearest = 0;
    if ((rim_.rowwise() - node->transpose()).rowwise().norm().minCoeff(&nearest) < within) return nearest;
    for (std::size_t k = 0; k < nodes_.size(); ++k)
      if ((nodes_[k] - *node).norm() < within) return n_ + static_cast<Index>(k);
    nodes_.push_back(*node);
    of_node_.push_back(of);
    return n_ + static_cast<Index>(nodes_.size()) - 1;
  }

  /// Steps along a crease, which vertices of the rim that lie on it divide.
  bool meet(Index from, Index to, std::size_t here, std::size_t other, std::vector<Arrangement::Step>& steps) {
    if (from == to) return true;
    const std::array<Index, 2> ends = {std::min(from, to), std::max(from, to)};
    const std::array<std::size_t, 2> pieces = {std::min(here, other), std::max(here, other)};
    const auto key = std::pair(ends, pieces);
    auto known = divided_.find(key);
    if (known == divided_.end()) {
      const std::optional<Points> points = meetings_.crease(pieces[0], pieces[1], at(ends[0]), at(ends[1]));
      if (!points) return false;
      known = divided_.emplace(key, divide(ends, pieces, *points)).first;
    }
    std::vector<Arrangement::Step> way = known->second;
    if (from == ends[0]) {
      steps.insert(steps.end(), way.begin(), way.end());
      return true;
    }
    for (std::size_t k = way.size(); k-- > 0;) {
      const Index begin = k + 1 < way.size() ? way[k + 1].corner : ends[1];
      steps.push_back({begin, way[k].crease, true});
    }
    return true;
  }

  std::vector<Arrangement::Step> divide(const std::array<Index, 2>& ends, const std::array<std::size_t, 2>& pieces,
                                        const Points& points) {
    const double within = meetings_.within(pieces[0], pieces[1]);
    std::vector<std::pair<double, Index>> on;  // place along the points, vertex
    for (Index v = 0; v < n_; ++v) {
      if (v == ends[0] || v == ends[1]) continue;
      double least = within, place = -1;
      for (Index k = 0; k + 1 < points.rows(); ++k) {
        const Vec3 a = points.row(k), way = points.row(k + 1).transpose() - a, p = rim_.row(v);
        const double t = std::clamp((p - a).dot(way) / std::max(way.squaredNorm(), 1e-300), 0.0, 1.0);
        if (const double far = (p - a - t * way).norm(); far < least) least = far, place = static_cast<double>(k) + t;
      }
      if (place > 0 && place < static_cast<double>(points.rows() - 1)) on.emplace_back(place, v);
    }
    std::sort(on.begin(), on.end());
    on.emplace_back(static_cast<double>(points.rows() - 1), ends[1]);
    std::vector<Arrangement::Step> way;
    double begin = 0;
    Index corner = ends[0];
    for (const auto& [end, v] : on) {
      way.push_back({corner});
      if (!is_beside(corner, v)) {
        way.back().crease = static_cast<Index>(curves_.size());
        std::vector<Index> inner;
        for (Index k = static_cast<Index>(std::floor(begin)) + 1; static_cast<double>(k) < end; ++k) inner.push_back(k);
        Curve curve{{corner, v}, pieces, Points(static_cast<Index>(inner.size()) + 2, 3)};
        curve.points.row(0) = at(corner).transpose();
        for (std::size_t k = 0; k < inner.size(); ++k) curve.points.row(static_cast<Index>(k) + 1) = points.row(inner[k]);
        curve.points.row(curve.points.rows() - 1) = at(v).transpose();
        curves_.push_back(std::move(curve));
      }
      begin = end;
      corner = v;
    }
    return way;
  }

  /// Where a loop comes back to a corner, the parts on both sides of that are filled by themselves.
  void split(std::size_t piece, const std::vector<Arrangement::Step>& steps) {
    std::vector<Arrangement::Step> open;
    for (const Arrangement::Step& step : steps) {
      const auto before = std::ranges::find(open, step.corner, &Arrangement::Step::corner);
      if (before != open.end()) {
        add({before, open.end()}, piece);
        open.erase(before, open.end());
      }
      open.push_back(step);
    }
    add(open, piece);
  }
  void add(const std::vector<Arrangement::Step>& steps, std::size_t piece) {
    if (steps.size() > 2) loops_.push_back({piece, steps});
  }

  Points outline(const std::vector<Arrangement::Step>& steps) const {
    std::vector<Vec3> points;
    for (const Arrangement::Step& step : steps) {
      points.push_back(at(step.corner));
      if (step.crease < 0) continue;
      const Points& own = curves_[static_cast<std::size_t>(step.crease)].points;
      for (Index k = 1; k + 1 < own.rows(); ++k) points.emplace_back(own.row(step.reversed ? own.rows() - 1 - k : k));
    }
    Points out(static_cast<Index>(points.size()), 3);
    for (Index k = 0; k < out.rows(); ++k) out.row(k) = points[static_cast<std::size_t>(k)].transpose();
    return out;
  }

  Meetings& meetings_;
  const std::vector<SmoothPiece>& pieces_;
  const Points& rim_;
  const std::vector<std::size_t>& labels_;
  double across_;
  Index n_;
  std::vector<Index> first_;
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> third_;  // of the triangle on the left of a side
  std::vector<Vec3> nodes_;
  std::vector<std::array<std::size_t, 3>> of_node_;
  std::vector<Curve> curves_;
  std::map<std::pair<std::array<Index, 2>, std::array<std::size_t, 2>>, std::vector<Arrangement::Step>> divided_;
  std::vector<Loop> loops_;
  double area_ = 0;
};

Arrangement arranged(const Meeting& meeting, const Meetings& meetings, const std::vector<SmoothPiece>& pieces) {
  Arrangement out;
  out.nodes = meeting.nodes();
  out.node_deviation.resize(static_cast<Index>(out.nodes.size()));
  for (std::size_t k = 0; k < out.nodes.size(); ++k) {
    const auto& of = meeting.pieces_of_nodes()[k];
    out.node_deviation[static_cast<Index>(k)] = meetings.deviation({of.begin(), of.end()}, out.nodes[k].transpose())[0];
  }
  for (const Meeting::Curve& curve : meeting.curves()) {
    const std::vector<std::size_t> of(curve.pieces.begin(), curve.pieces.end());
    out.creases.emplace_back(curve.points, meetings.deviation(of, curve.points));
    out.creases.back().ends = curve.ends;
  }
  for (const Meeting::Loop& loop : meeting.loops()) out.parts.push_back({loop.steps, pieces[loop.piece].faces()});
  return out;
}

/// A plane in which all of the rim lies, and which continues next to some of it.
std::optional<Arrangement> one_plane_of(const std::vector<std::size_t>& labels, const PiecesFound& found, const Points& rim) {
  if (labels.empty() || std::ranges::count(labels, labels[0]) < std::ssize(labels)) return {};
  const SmoothPiece& piece = found.pieces[labels[0]];
  if (!piece.is_plane() || std::ranges::count(found.beside, labels[0]) == 0) return {};
  if (!(piece.at(rim).distance.cwiseAbs().maxCoeff() < piece.tolerance())) return {};
  Arrangement out;
  out.parts.push_back({{}, piece.faces()});
  for (Index k = 0; std::cmp_less(k, labels.size()); ++k) out.parts[0].loop.push_back({k});
  return out;
}

}  // namespace

Arrangement::Crease::Crease(Points points, Eigen::VectorXd deviation)
    : points_(std::move(points)), deviation_(std::move(deviation)), along_(points_.rows()) {
  along_[0] = 0;
  for (Index k = 1; k < points_.rows(); ++k) along_[k] = along_[k - 1] + (points_.row(k) - points_.row(k - 1)).norm();
}

Points Arrangement::Crease::at(const Eigen::VectorXd& shares) const {
  Points out(shares.size(), 3);
  for (Index k = 0; k < shares.size(); ++k) {
    const double place = shares[k] * length();
    Index j = 1;
    while (j + 1 < along_.size() && along_[j] < place) ++j;
    const double t = (place - along_[j - 1]) / std::max(along_[j] - along_[j - 1], 1e-300);
    out.row(k) = (1 - t) * points_.row(j - 1) + t * points_.row(j);
  }
  return out;
}

Eigen::VectorXd Arrangement::Crease::deviation(const Eigen::VectorXd& shares) const {
  Eigen::VectorXd out(shares.size());
  for (Index k = 0; k < shares.size(); ++k) {
    const double place = shares[k] * length();
    Index j = 1;
    while (j + 1 < along_.size() && along_[j] < place) ++j;
    const double t = (place - along_[j - 1]) / std::max(along_[j] - along_[j - 1], 1e-300);
    out[k] = (1 - t) * deviation_[j - 1] + t * deviation_[j];
  }
  return out;
}

namespace {

/// Of all ways to meet that with the least area.
std::optional<Meeting> best_meeting(const std::vector<SmoothPiece>& pieces, const Points& rim,
                                    const std::vector<std::size_t>& labels, double across, Meetings& meetings) {
  if (labels.empty()) return {};
  const Meeting begun(meetings, pieces, rim, labels, across);
  if (begun.runs() < 2 || begun.runs() > most_runs) return {};
  std::optional<Meeting> best;
  for (const Triangles3& triangles : triangulations(0, begun.runs() - 1)) {
    Meeting meeting = begun;
    if (meeting.follow(triangles) && (!best || clearly_less(meeting.area(), best->area()))) best.emplace(std::move(meeting));
  }
  return best;
}

/// Sets of `taken` of so many, in order.
std::vector<std::vector<std::size_t>> subsets(std::size_t of, std::size_t taken) {
  std::vector<char> mask(of, 0);
  std::fill(mask.begin(), mask.begin() + static_cast<std::ptrdiff_t>(taken), 1);
  std::vector<std::vector<std::size_t>> all;
  do {
    all.emplace_back();
    for (std::size_t k = 0; k < of; ++k)
      if (mask[k]) all.back().push_back(k);
  } while (std::prev_permutation(mask.begin(), mask.end()));
  return all;
}

}  // namespace

std::optional<Arrangement> arrangement_of(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim,
                                          const PiecesFound& found, double across) {
  if (found.pieces.empty()) return {};
  const RimLabels rim_labels(mesh, around, rim, found);
  const Points points = mesh.vertices(rim, Eigen::all);
  if (std::optional<Arrangement> flat = one_plane_of(rim_labels.labels({}), found, points)) return flat;
  if (found.pieces.size() < 2) return {};
  std::vector<SmoothPiece> unseen;
  for (std::size_t lost = 0; lost <= std::min(most_lost, unseen.size()); ++lost) {
    std::optional<Arrangement> best;
    std::pair<std::size_t, double> least;  // runs, area
    for (const std::vector<std::size_t>& some : subsets(unseen.size(), lost)) {
      std::vector<SmoothPiece> planes, pieces = found.pieces;
      for (const std::size_t k : some) planes.push_back(unseen[k]);
      pieces.insert(pieces.end(), planes.begin(), planes.end());
      const std::vector<std::size_t> labels = rim_labels.labels(planes);
      Meetings meetings(pieces, points, across);
      const std::optional<Meeting> meeting = best_meeting(pieces, points, labels, across, meetings);
      if (!meeting || (best && std::pair(meeting->runs(), meeting->area()) >= least)) continue;
      least = {meeting->runs(), meeting->area()};
      best = arranged(*meeting, meetings, pieces);
    }
    if (best) return best;
    if (lost == 0 && std::ranges::all_of(found.pieces, &SmoothPiece::is_plane)) unseen = rim_labels.unseen(across);
  }
  return {};
}

}  // namespace tripatch
