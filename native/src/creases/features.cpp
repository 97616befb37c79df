#include "tripatch/creases/features.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tripatch/hole/rim_shape.h"
#include "tripatch/math/angle.h"
#include "tripatch/math/decompositions.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/math/tolerant_compare.h"
#include "tripatch/mesh/edge_key.h"
#include "tripatch/mesh/submesh.h"
#include "tripatch/mesh/vertex_normals.h"
#include "tripatch/spline/disc.h"

namespace tripatch {
namespace {

// Half and twice of these numbers were tried on 68 holes across creases in irregular triangles: straight, curved and turned ridges of 28 to 90
// degrees, edges of drums, corners of three planes, chamfers; without noise, with 2 and 6% of an edge. Two percentages tell by how much
// fills are farther in the geometric mean: with half, with twice of it.
constexpr double one_degree = std::numbers::pi / 180;
/// And so many times what three quarters of the edges around stay below, and the half of those next to the crease: noise of a tenth of an
/// edge, and coarse triangles of anything round, stay below that (-2%, 29%; share of 0.38: 3%).
constexpr double above_noise = deviations::clear, ordinary_share = share::most;
/// Between smooth faces (smooth_angle) a crease that is sharp at the rim is followed to half of that: where two pipes meet it gets blunt
/// by and by (0%, 3%).
constexpr double still_crease = share::half;
/// Where a crease turns by more it ends (57%, -3%; with 63 degrees 7%).
constexpr double sharpest_turn = angle::corner * one_degree;
/// A crease of a single edge is believed where the edge is this share of the diameter, or longer: a choice, for none of the 68 is so.
constexpr double long_edge = share::quarter;
/// One that gets blunt is believed to continue across the hole where it is this long; those of animals' faces and limbs seldom are. Where
/// ordinary edges turn by more than the angle it must be longer, and corners at which it could end cannot be told from others. The two
/// lengths: 0%, 35% and 0%, 30%; the angle: 40%, 0%.
constexpr double min_blunt_length = 0.35, min_rough_length = share::half;
constexpr double smooth_angle = angle::slight * one_degree;
/// Between the directions in which two ends continue and the line between them, at most. A circle's arc over a chord of 1.7 radii has 58.
/// (51%, 2%.)
constexpr double widest_view = 65 * one_degree;
/// Ends that see each other with less, both together, belong together whatever else meets there (0%, 46%).
constexpr double straight_on = 50 * one_degree;
/// Between the faces on the same side of the two ends, once turned as the crease turns (0%, 0%).
constexpr double same_face = angle::corner * one_degree;
/// One end's angle over the other's, at most: a choice, for creases of the 68 are as sharp at both ends (0%, 0%).
constexpr double same_angle = factor::strong;
/// Of the diameter: so near to a point go the lines of creases that meet there (0%, 0%).
constexpr double meeting_share = share::fifth;
/// Of the determinant of the sum of the projections along them, 0 for one direction: less, and lines are nearly parallel. Three lines
/// within 1.1 degrees of one direction have that (0%, 0%).
constexpr double min_spread = share::hundredth;
/// A rim edge continues along a crease if it leaves neither face by more than this, or by more than this times what the edges of
/// the crease do. Nor may it leave the direction of the crease by more than 25 degrees (0%, 0%; 14%, 0%; with 51 degrees 8%, not
/// at all 34%).
constexpr double in_face = 3 * one_degree, as_curved = factor::slight, along_crease = share::nearly_all;

Vec3 unit_normal(const Mesh& mesh, Index face) { return area_vector(mesh, face).stableNormalized(); }

/// The angles at the edges of the surroundings.
class EdgeAngles {
public:
  EdgeAngles(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& vertices) {
    std::vector<double> all;
    Numbering faces(mesh.faces.size());
    std::vector<Vec3> normals;  // of these
    const auto normal = [&](Index f) {
      if (faces.add(f)) normals.push_back(unit_normal(mesh, f));
      return normals[static_cast<std::size_t>(faces.find(f))];
    };
    for (Index v : vertices)
      for (Connectivity::Corner c : around.at(v)) {
        const Index w = around.next(c);
        const auto across = around.edge(w, v);
        if (!across || (v > w && std::binary_search(vertices.begin(), vertices.end(), w))) continue;
        const double angle = angle_between(normal(around.face(c)), normal(around.face(*across)));
        edges_.push_back({edge_key(v, w), angle});
        all.push_back(angle);
      }
    std::sort(edges_.begin(), edges_.end());
    if (all.empty()) return;
    const auto ordinary = all.begin() + static_cast<std::ptrdiff_t>(ordinary_share * static_cast<double>(all.size() - 1));
    std::nth_element(all.begin(), ordinary, all.end());
    ordinary_ = *ordinary;
    threshold_ = std::max(min_crease_angle, above_noise * ordinary_);
  }

  /// -1 where the edge has not two faces, or lies farther off.
  double at(Index a, Index b) const {
    const auto found = std::lower_bound(edges_.begin(), edges_.end(), std::pair(edge_key(a, b), -1.0));
    return found != edges_.end() && found->first == edge_key(a, b) ? found->second : -1;
  }
  double ordinary() const { return ordinary_; }
  bool sharp(Index a, Index b) const { return clearly_more(at(a, b), threshold_); }
  bool still_sharp(Index a, Index b) const {
    const double least =
        ordinary_ < smooth_angle ? std::max(still_crease * min_crease_angle, above_noise * ordinary_) : threshold_;
    return clearly_more(at(a, b), least);
  }
  std::vector<EdgeKey> all_sharp() const {
    std::vector<EdgeKey> out;
    for (const auto& [edge, angle] : edges_)
      if (clearly_more(angle, threshold_)) out.push_back(edge);
    return out;
  }

private:
  std::vector<std::pair<EdgeKey, double>> edges_;
  double ordinary_ = 0, threshold_ = min_crease_angle;
};

/// Whether an edge at these vertices is one. At most holes none is, and a cosine tells.
bool any_is_crease(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& vertices) {
  static const double surely_flat = std::cos(share::nearly_all * min_crease_angle);
  for (Index v : vertices)
    for (Connectivity::Corner c : around.at(v)) {
      const auto across = around.edge(around.next(c), v);
      if (!across) continue;
      const Index f = around.face(c), g = around.face(*across);
      const Vec3 a = area_vector(mesh, f), b = area_vector(mesh, g);
      if (a.dot(b) > surely_flat * std::sqrt(a.squaredNorm() * b.squaredNorm())) continue;
      if (clearly_more(angle_between(unit_normal(mesh, f), unit_normal(mesh, g)), min_crease_angle)) return true;
    }
  return false;
}

class CreaseFinder {
public:
  CreaseFinder(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim, const EdgeAngles& angles,
               double diameter)
      : mesh_(mesh), around_(around), rim_(rim), angles_(angles), diameter_(diameter) {}

  std::vector<CreaseEnd> ends() const {
    std::vector<CreaseEnd> found;
    for (Index k = 0; k < static_cast<Index>(rim_.size()); ++k)
      for (Index w : neighbors(rim_[k])) {
        if (!angles_.sharp(rim_[k], w)) continue;
        if (std::optional<CreaseEnd> end = traced(k, w)) found.push_back(std::move(*end));
      }
    return found;
  }

  /// Pairs of ends that see each other, the best first, none across another; where three or more meet at a point, those that go
  /// straight_on on before, others after.
  std::vector<Crease> creases(std::vector<CreaseEnd> ends) const {
    std::vector<Crease> out = pairs(ends, straight_on);
    if (out.empty())
      if (std::optional<Crease> met = meet(ends)) return {std::move(*met)};
    std::vector<Crease> others = pairs(ends, 2 * widest_view);
    return others.size() > out.size() ? others : out;
  }

private:
  Vec3 point(Index v) const { return mesh_.vertices.row(v); }

  std::vector<Index> neighbors(Index v) const {
    std::vector<Index> out;
    for (Connectivity::Corner c : around_.at(v)) {
      out.push_back(around_.next(c));
      out.push_back(around_.previous(c));
    }
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
  }

  std::vector<Index> chain_from(Index v, Index w) const {
    std::vector<Index> chain = {v, w};
    double length = (point(w) - point(v)).norm();
    while (clearly_less(length, crease_reach * diameter_)) {
      const Index at = chain.back(), before = chain[chain.size() - 2];
      const Vec3 way = point(at) - point(before);
      Index best = -1;
      double least = sharpest_turn;
      for (Index next : neighbors(at)) {
        if (!angles_.still_sharp(at, next) || std::find(chain.begin(), chain.end(), next) != chain.end()) continue;
        if (const double turn = angle_between(way, point(next) - point(at)); clearly_less(turn, least)) least = turn, best = next;
      }
      if (best < 0) break;
      length += (point(best) - point(at)).norm();
      chain.push_back(best);
    }
    return chain;
  }

  /// Whether a crease gets blunt and is lost; it may also end at a corner, at a border, or where no angles are looked at.
  bool runs_out(const std::vector<Index>& chain) const {
    const Index last = chain.back();
    if (!around_.knows(last)) return false;
    const bool smooth_beside = angles_.ordinary() < smooth_angle;  // else what looks like a corner is chance
    int others = 0;
    for (Index w : neighbors(last)) {
      if (angles_.at(last, w) < 0) return false;
      others += w != chain[chain.size() - 2] && angles_.sharp(last, w);
    }
    return others < 2 || !smooth_beside;
  }

  /// Whether a crease stands out from what is next to it.
  bool stands_out(const std::vector<Index>& chain) const {
    double sum = 0, length = 0;
    std::vector<double> beside;
    for (std::size_t k = 0; k + 1 < chain.size(); ++k) {
      sum += angles_.at(chain[k], chain[k + 1]);
      length += (point(chain[k + 1]) - point(chain[k])).norm();
      for (Index w : neighbors(chain[k])) {
        const bool own = w == chain[k + 1] || (k > 0 && w == chain[k - 1]);
        if (const double angle = angles_.at(chain[k], w); !own && angle >= 0) beside.push_back(angle);
      }
    }
    const double blunt = angles_.ordinary() < smooth_angle ? min_blunt_length : min_rough_length;
    if (clearly_less(length, (runs_out(chain) ? blunt : chain.size() < 3 ? long_edge : 0) * diameter_)) return false;
    if (beside.empty()) return true;
    const auto middle = beside.begin() + static_cast<std::ptrdiff_t>(beside.size() / 2);
    std::nth_element(beside.begin(), middle, beside.end());
    return clearly_more(sum / static_cast<double>(chain.size() - 1), above_noise * *middle);
  }

  std::optional<CreaseEnd> traced(Index place, Index w) const {
    CreaseEnd end;
    end.place = place;
    end.chain = chain_from(rim_[place], w);
    if (!stands_out(end.chain)) return {};
    end.left = end.right = Vec3::Zero();
    const std::size_t near = std::min<std::size_t>(end.chain.size() - 1, 3);
    for (std::size_t k = 0; k < near; ++k) {
      const Index to = end.chain[k], from = end.chain[k + 1];
      const auto left = around_.edge(from, to), right = around_.edge(to, from);
      if (!left || !right) return {};  // the faces are turned against each other
      end.left += unit_normal(mesh_, around_.face(*left)) / static_cast<double>(k + 1);
      end.right += unit_normal(mesh_, around_.face(*right)) / static_cast<double>(k + 1);
    }
    end.left = end.left.stableNormalized();
    end.right = end.right.stableNormalized();
    follow_rim(end);
    aim(end);
    const double sign = end.left.cross(end.right).dot(end.into) > 0 ? 1 : -1;
    end.angle = sign * angle_between(end.left, end.right);
    return end;
  }

  /// How far a step leaves the faces next to the edge of a chain before it: the sines of both angles, the larger.
  double leaves(const Vec3& way, Index from, Index to) const {
    const auto left = around_.edge(from, to), right = around_.edge(to, from);
    if (!left || !right) return 1;
    const Vec3 unit = way.stableNormalized();
    return std::max(std::abs(unit.dot(unit_normal(mesh_, around_.face(*left)))),
                    std::abs(unit.dot(unit_normal(mesh_, around_.face(*right)))));
  }

  /// The rim itself may continue along the crease for some edges: where they leave its faces no more than its own edges do.
  void follow_rim(CreaseEnd& end) const {
    const Index n = static_cast<Index>(rim_.size());
    const Index from = end.chain[1], to = end.chain[0];
    double own = std::sin(in_face);
    for (std::size_t k = 0; k + 2 < end.chain.size() && k < 4; ++k)
      own = std::max(own, as_curved * leaves(point(end.chain[k]) - point(end.chain[k + 1]), end.chain[k + 2], end.chain[k + 1]));
    for (const Index step : {Index{1}, n - 1})
      for (Index taken = 1; 2 * taken < n; ++taken) {
        const Index next = rim_[(end.place + step) % n];
        const Vec3 way = point(next) - point(end.chain[0]), before = point(end.chain[0]) - point(end.chain[1]);
        if (clearly_less(way.stableNormalized().dot(before.stableNormalized()), along_crease)) break;
        if (clearly_more(leaves(way, from, to), static_cast<double>(taken) * own)) break;
        if (std::find(end.chain.begin(), end.chain.end(), next) != end.chain.end()) break;
        end.place = (end.place + step) % n;
        end.chain.insert(end.chain.begin(), next);
      }
  }

  void aim(CreaseEnd& end) const {
    std::size_t k = 1;  // over three edges, or as far as there are
    while (k + 1 < end.chain.size() && k < 3) ++k;
    end.into = (point(end.chain[0]) - point(end.chain[k])).stableNormalized();
  }

  std::vector<Crease> pairs(const std::vector<CreaseEnd>& ends, double most) const {
    struct Candidate {
      double cost;
      std::size_t i, j;
    };
    std::vector<Candidate> candidates;
    for (std::size_t i = 0; i < ends.size(); ++i)
      for (std::size_t j = i + 1; j < ends.size(); ++j)
        if (const double cost = mismatch(ends[i], ends[j], most); std::isfinite(cost)) candidates.push_back({cost, i, j});
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const auto& a, const auto& b) { return coarse(1 + a.cost) < coarse(1 + b.cost); });
    std::vector<Crease> out;
    std::vector<std::array<Index, 2>> chords;
    for (const Candidate& c : candidates) {
      const Index a = ends[c.i].place, b = ends[c.j].place;
      const auto hinders = [&](const auto& x) {
        const bool shared = x[0] == a || x[0] == b || x[1] == a || x[1] == b;
        const auto between = [&](Index p) { return p > std::min(a, b) && p < std::max(a, b); };
        return shared || between(x[0]) != between(x[1]);
      };
      if (std::any_of(chords.begin(), chords.end(), hinders)) continue;
      chords.push_back({a, b});
      out.push_back({{ends[c.i], ends[c.j]}, Vec3::Zero()});
    }
    return out;
  }

  /// How badly two ends fit; infinite where they do not see each other, or turn by more than `most`.
  double mismatch(const CreaseEnd& a, const CreaseEnd& b, double most) const {
    const double none = std::numeric_limits<double>::infinity();
    const Index n = static_cast<Index>(rim_.size()), apart = std::abs(a.place - b.place);
    if (apart < 2 || n - apart < 2) return none;
    const Vec3 across = point(b.chain[0]) - point(a.chain[0]);
    const double from_a = angle_between(a.into, across), from_b = angle_between(b.into, -across);
    if (!(clearly_less(from_a, widest_view) && clearly_less(from_b, widest_view) && clearly_less(from_a + from_b, most)))
      return none;
    const double larger = std::max(std::abs(a.angle), std::abs(b.angle)),
                 smaller = std::min(std::abs(a.angle), std::abs(b.angle));
    if (a.angle * b.angle < 0 || clearly_more(larger, same_angle * smaller)) return none;
    const Eigen::Matrix3d turn = rotation_between(a.into, -b.into);
    const double left = angle_between(turn * a.left, b.right), right = angle_between(turn * a.right, b.left);
    if (!(clearly_less(left, same_face) && clearly_less(right, same_face))) return none;
    return from_a + from_b + left + right;
  }

  std::optional<Crease> meet(std::vector<CreaseEnd> ends) const {
    if (ends.size() < 3) return {};
    for (std::size_t k = 0; k < ends.size(); ++k)
      for (std::size_t j = k + 1; j < ends.size(); ++j)
        if (ends[k].place == ends[j].place) return {};
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    Vec3 right = Vec3::Zero();
    for (const CreaseEnd& end : ends) {
      const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - end.into * end.into.transpose();
      sum += across;
      right += across * point(end.chain[0]);
    }
    if (!clearly_more(sum.determinant(), min_spread)) return {};
    const Vec3 node = sum.ldlt().solve(right);
    for (const CreaseEnd& end : ends) {
      const Vec3 to = node - point(end.chain[0]);
      const double along = to.dot(end.into);
      const bool ahead = clearly_more(along, tie * diameter_) && clearly_less(along, diameter_);
      if (!ahead || !clearly_less((to - along * end.into).norm(), meeting_share * diameter_)) return {};
    }
    std::sort(ends.begin(), ends.end(), [](const auto& a, const auto& b) { return a.place < b.place; });
    return Crease{std::move(ends), node};
  }

  const Mesh& mesh_;
  const Connectivity& around_;
  const std::vector<Index>& rim_;
  const EdgeAngles& angles_;
  double diameter_;
};

}  // namespace

bool may_have_features(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim) {
  const double across = diameter(mesh, rim);
  if (!(across > 0) || !std::isfinite(across)) return false;
  return any_is_crease(mesh, around, rim) || find_walls(mesh, around, rim, across, {});
}

Features find_features(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim) {
  Features features;
  if (!may_have_features(mesh, around, rim)) return features;
  const double across = diameter(mesh, rim);
  const Disc disc = disc_around(mesh, around, {rim}, crease_reach * across, max_crease_rings);
  features.vertices = disc.vertices;
  std::sort(features.vertices.begin(), features.vertices.end());
  const EdgeAngles angles(mesh, around, features.vertices);
  const CreaseFinder finder(mesh, around, rim, angles, across);
  features.creases = finder.creases(finder.ends());
  const std::vector<EdgeKey> sharp = angles.all_sharp();
  features.walls = find_walls(mesh, around, rim, across, features.vertices, &sharp);
  if (!features.creases.empty()) features.barred = sharp;
  return features;
}

}  // namespace tripatch
