// Dynamic programming over the chords of the rim: the best fill of the polygon beyond chord (i, k) is the best apex m with the best
// fills beyond (i, m) and (m, k). A chord's apexes are compared in one go; angles by the signed square of their cosine, which needs no
// root. Equally good ones, but for rounding, are distinguished by their place in the rim: turned, moved or scaled it is the same fill.
#include "tripatch/triangulation/min_weight_triangulation.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <queue>
#include <tuple>
#include <unordered_map>

#include "tripatch/math/interruption.h"
#include "tripatch/math/lru_cache.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/math/tolerant_compare.h"
#include "tripatch/mesh/edge_key.h"
#include "tripatch/report/crossings.h"
#include "tripatch/triangulation/apexes.h"
#include "tripatch/triangulation/closed_line.h"
#include "tripatch/triangulation/rim_polygon.h"
#include "tripatch/triangulation/without_doubles.h"

namespace tripatch {
namespace {

using Row = Eigen::Array<double, 1, Eigen::Dynamic>;
using Square = Eigen::Array<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr Index largest_exact = count::hundreds;  // vertices: 1.3 million triangles are compared, in some 5 ms
/// Triangulations of a kind that are tried until one does not cross itself: those with the least worst angle, the same without triangles that the rim
/// goes through, then those with the least area. Of 76 rims of real meshes, up to 113 vertices, 39 have one of the first kind, 73 one of the
/// second, 61 at once, and 75 one of the third, 72 at once. Of 30,000 rims of 12 and 14 random vertices 15 are filled otherwise with one of the third
/// kind, none with three or seven.
constexpr int rounds_of_a_kind = count::half_dozen;
/// Of one try that are looked at. Only the time hangs on it: a thousand vertices strewn in a ball make 180,000, and ten seconds without it. Of 320
/// rims of 10 to 1,000 random vertices none is filled otherwise with 100 or with 100,000.
constexpr std::size_t max_crossings = count::quadratic;
constexpr Index largest_tried = count::quadratic;  // vertices: of more a try takes a tenth of a second, and the first is taken
/// Cosine between an ear of a large polygon and the faces beyond its edges. Staircase rims of 214 to 702 edges on balls are as near with 0.47
/// and 0.85; with 0 those on most of a ball take minutes.
constexpr double goes_on = 0.7;
constexpr double unknown = 2;     // in place of the cosine's square where no face lies beyond: more than any
constexpr double crossed = -1.5;  // in place of the square: worse than any angle
constexpr double joined_already = -2, impossible = -4;  // worse than that; an edge to itself

class Filler {
public:
  Filler(const PointsRef& points, std::vector<EdgeKey> joined, std::vector<EdgeKey> bridges)
      : points_(points), joined_(std::move(joined)), bridges_(std::move(bridges)), place_(points.rows(), -1) {}

  /// No chord of these any more.
  void avoid(const std::vector<Crossing>& crossings) {
    for (const Crossing& each : crossings) {
      avoided_.push_back(edge_key(each.edge[0], each.edge[1]));
      for (int k = 0; k < 3; ++k) avoided_.push_back(edge_key(each.triangle[k], each.triangle[(k + 1) % 3]));
    }
    std::sort(avoided_.begin(), avoided_.end());
  }
  /// No triangle through which that line goes, where there is another; what was avoided is no more.
  void leave_alone(const ClosedLine& line) {
    left_alone_ = &line;
    avoided_.clear();
  }
  void by_area() {
    by_area_ = true;
    avoided_.clear();
  }

  void fill(const RimPolygon& polygon, std::vector<std::array<Index, 3>>& out) {
    if (polygon.size() > largest_exact) {
      by_parts(without_ears(polygon, out), out);
      return;
    }
    for (const auto& t : exact(polygon)) out.push_back({polygon.vertices[t[0]], polygon.vertices[t[1]], polygon.vertices[t[2]]});
  }

private:
  /// What is left of a large polygon without the ears that continue from the faces beyond their two edges, that with the shortest chord first:
  /// at every vertex where a jagged hole sticks out, then at the next, until few enough are left.
  RimPolygon without_ears(const RimPolygon& polygon, std::vector<std::array<Index, 3>>& out) const {
    const Index n = polygon.size();
    RimPolygon left = polygon;
    std::vector<Index> next(n), previous(n);
    std::vector<char> gone(n, 0);
    struct Ear {
      double chord;
      Index middle, before, after;
      bool operator<(const Ear& other) const { return std::tie(other.chord, other.middle) < std::tie(chord, middle); }
    };
    std::priority_queue<Ear> ears;
    const auto normal_of = [&](Index a, Index b, Index c) -> Vec3 {
      const Vec3 x = points_.row(polygon.vertices[a]), y = points_.row(polygon.vertices[b]), z = points_.row(polygon.vertices[c]);
      const Vec3 normal = (y - x).cross(z - x);
      const double longest = std::max({(y - x).squaredNorm(), (z - x).squaredNorm(), (z - y).squaredNorm()});
      return normal.squaredNorm() > without_normal * longest * longest ? normal.stableNormalized() : Vec3(Vec3::Zero());
    };
    const auto consider = [&](Index b) {
      const Index a = previous[b], c = next[b], v = polygon.vertices[a], w = polygon.vertices[c];
      if (v == w || is_one(joined_, v, w) || is_one(bridges_, v, w) || is_one(avoided_, v, w)) return;
      const Vec3 normal = normal_of(a, b, c);
      if (!(std::min(normal.dot(left.normals[a]), normal.dot(left.normals[b])) > goes_on)) return;
      ears.push({(points_.row(v) - points_.row(w)).squaredNorm(), b, a, c});
    };
    for (Index k = 0; k < n; ++k) next[k] = (k + 1) % n, previous[k] = (k + n - 1) % n;
    for (Index k = 0; k < n; ++k) consider(k);
    Index count = n;
    while (count > largest_exact && !ears.empty()) {
      const auto [chord, b, a, c] = ears.top();
      ears.pop();
      if (gone[b] || previous[b] != a || next[b] != c) continue;
      out.push_back({polygon.vertices[a], polygon.vertices[b], polygon.vertices[c]});
      left.normals[a] = normal_of(a, b, c);
      gone[b] = 1;
      next[a] = c;
      previous[c] = a;
      --count;
      consider(a);
      consider(c);
    }
    RimPolygon result;
    for (Index k = 0; k < n; ++k) {
      if (gone[k]) continue;
      result.vertices.push_back(left.vertices[k]);
      result.normals.push_back(left.normals[k]);
    }
    return result;
  }

  /// Triangulates every so-maniest vertex first, and then what lies between each of that fill's edges and the rim.
  void by_parts(const RimPolygon& polygon, std::vector<std::array<Index, 3>>& out) {
    if (polygon.size() <= largest_exact) {
      fill(polygon, out);
      return;
    }
    const std::vector<Index> sample = samples(polygon);
    const Index s = static_cast<Index>(sample.size()), n = polygon.size();
    RimPolygon coarse;
    for (Index j = 0; j < s; ++j) {
      coarse.vertices.push_back(polygon.vertices[sample[j]]);
      Vec3 sum = Vec3::Zero();
      for (Index k = sample[j]; k < (j + 1 < s ? sample[j + 1] : n); ++k) sum += polygon.normals[k];
      coarse.normals.push_back(sum.stableNormalized());
    }
    for (const auto& t : exact(coarse)) {
      out.push_back({coarse.vertices[t[0]], coarse.vertices[t[1]], coarse.vertices[t[2]]});
      const Vec3 normal = triangle_normal(points_, out.back()).stableNormalized();
      for (int e = 0; e < 3; ++e) {
        const Index from = t[e], to = t[(e + 1) % 3];
        if (to != (from + 1) % s) continue;
        const Index first = sample[from], last = to ? sample[to] : n;
        if (last - first < 2) continue;
        RimPolygon part;
        for (Index k = first; k <= last; ++k) {
          part.vertices.push_back(polygon.vertices[k % n]);
          part.normals.push_back(k < last ? polygon.normals[k] : normal);
        }
        fill(part, out);
      }
    }
  }

  /// Some `largest_exact` places of the polygon evenly, those where a loop is left or entered among them, none next to another by an
  /// edge that the mesh has already.
  std::vector<Index> samples(const RimPolygon& polygon) const {
    const Index n = polygon.size(), stride = (2 * n + largest_exact - 1) / largest_exact;
    std::vector<char> keep(n, 0);
    for (Index k = 0; k < n; k += stride) keep[k] = 1;
    for (Index k = 0; k < n; ++k)
      if (is_one(bridges_, polygon.vertices[k], polygon.vertices[(k + 1) % n])) keep[k] = keep[(k + 1) % n] = 1;
    for (Index last = 0, k = 1; k < n; ++k) {
      if (!keep[k]) continue;
      const bool bad = k - last > 1 && is_one(joined_, polygon.vertices[last], polygon.vertices[k]);
      if (bad) keep[k - 1] = 1;
      last = k;
    }
    std::vector<Index> sample;
    for (Index k = 0; k < n; ++k)
      if (keep[k]) sample.push_back(k);
    return sample;
  }

  static bool is_one(const std::vector<EdgeKey>& pairs, Index a, Index b) {
    return std::binary_search(pairs.begin(), pairs.end(), edge_key(a, b));
  }

  /// What is asked of chord (i, k) itself: `unknown` or more for nothing.
  void mark(const RimPolygon& polygon, Square& worst) {
    const Index n = polygon.size();
    worst.setConstant(n, n, unknown);
    std::vector<Index> next(n, -1);  // the place before it of the same vertex
    for (Index k = 0; k < n; ++k) {
      next[k] = place_[polygon.vertices[k]];
      place_[polygon.vertices[k]] = k;
    }
    const auto forbid = [&](Index a, Index b, double how) {
      for (Index i = place_[a]; i >= 0; i = next[i])
        for (Index k = place_[b]; k >= 0; k = next[k]) {
          const Index apart = std::abs(i - k);
          if (apart > 1 && apart < n - 1) worst(i, k) = worst(k, i) = std::min(worst(i, k), how);
        }
    };
    for (const auto& [a, b] : avoided_) forbid(a, b, crossed);
    for (const auto& [a, b] : joined_) forbid(a, b, joined_already);
    for (const auto& [a, b] : bridges_) forbid(a, b, impossible), forbid(a, a, impossible), forbid(b, b, impossible);
    for (Index v : polygon.vertices) place_[v] = -1;
  }

  /// Triangles of the best fill by places in the polygon.
  std::vector<std::array<Index, 3>> exact(const RimPolygon& polygon) {
    const Index n = polygon.size();
    prepare(polygon);
    for (Index i = n - 2; i-- > 0;) {
      check_interruption();
      for (Index k = i + 2; k < n; ++k) choose(i, k, n, polygon);
    }
    std::vector<std::array<Index, 3>> out;
    std::vector<EdgeKey> open = {{0, n - 1}};
    while (!open.empty()) {
      const auto [i, k] = open.back();
      open.pop_back();
      if (k - i < 2) continue;
      const Index m = apex_(i, k);
      out.push_back({i, m, k});
      open.push_back({i, m});
      open.push_back({m, k});
    }
    return out;
  }

  void prepare(const RimPolygon& polygon) {
    const Index n = polygon.size();
    mark(polygon, worst_);
    apex_.setConstant(n, n, -1);
    area_.setZero(n, n);
    score_.resize(n);
    for (Row& row : work_) row.resize(n);
    Vec3 middle = Vec3::Zero();
    for (Index v : polygon.vertices) middle += points_.row(v) / static_cast<double>(n);
    double size = 0;
    for (Index v : polygon.vertices) size = std::max(size, (Vec3(points_.row(v)) - middle).norm());
    const double scale = size > 0 ? 1 / size : 1;
    for (int c = 0; c < 3; ++c) {
      normal_[c].setZero(n, n);
      x_[c].resize(n);
      for (Index k = 0; k < n; ++k) x_[c][k] = (points_(polygon.vertices[k], c) - middle[c]) * scale;
      for (Index k = 0; k + 1 < n; ++k) normal_[c](k, k + 1) = normal_[c](k + 1, k) = polygon.normals[k][c];
    }
  }

  struct Apex {
    Index place;
    double worst, area;
  };
  /// Of those of chord (i, k) whose scores are equally good, but for rounding, the one with the least area.
  Apex best_apex(Index i, Index k) const {
    const Index first = i + 1, count = k - i - 1;
    Apex best = {-1, std::min(score_.head(count).maxCoeff(), worst_(i, k)), std::numeric_limits<double>::infinity()};
    for (Index j = 0; j < count; ++j) {
      if (score_[j] < best.worst) continue;
      const double area = triangle(i, first + j, k).norm() + area_(i, first + j) + area_(k, first + j);
      if (best.place < 0 || clearly_less(area, best.area)) best.area = area, best.place = first + j;
    }
    return best;
  }
  /// The best apex of chord (i, k).
  void choose(Index i, Index k, Index n, const RimPolygon& polygon) {
    const Index first = i + 1, count = k - i - 1;
    if (by_area_)
      for (Index j = 0; j < count; ++j) score_[j] = std::min(worst_(i, first + j), worst_(first + j, k));
    else
      score_angles(i, k, n, polygon);
    Apex best = best_apex(i, k);
    const auto& of = polygon.vertices;
    for (; left_alone_ && best.worst > crossed; best = best_apex(i, k)) {
      if (!is_pierced({of[i], of[best.place], of[k]})) break;
      score_[best.place - first] = crossed;
    }
    apex_(i, k) = static_cast<int>(best.place);
    worst_(i, k) = worst_(k, i) = best.worst;
    area_(i, k) = area_(k, i) = best.area;
    const Eigen::Vector3d normal = triangle(i, best.place, k).stableNormalized();
    for (int c = 0; c < 3; ++c) normal_[c](i, k) = normal_[c](k, i) = normal[c];
  }

  /// Whether the line that is left alone goes through a triangle. One triangulation after the other asks for the same triangles.
  bool is_pierced(const std::array<Index, 3>& triangle) {
    std::uint64_t key = 0;
    for (const Index v : triangle) key = key * static_cast<std::uint64_t>(points_.rows()) + static_cast<std::uint64_t>(v);
    const auto [entry, is_new] = pierced_.try_emplace(key, false);
    if (is_new) entry->second = left_alone_->goes_through(triangle);
    return entry->second;
  }

  /// The scores of all apexes of chord (i, k) where the worst angle counts, that over the faces beyond among them.
  void score_angles(Index i, Index k, Index n, const RimPolygon& polygon) {
    const Index first = i + 1, count = k - i - 1;
    const bool are_final = !left_alone_ && k - i < n - 1 && !polygon.normals[i].isZero() && !polygon.normals[k - 1].isZero();
    compare(i, k, n, are_final);
    double* const score = score_.data();
    if (polygon.normals[i].isZero()) rescore(score[0], i, first, k, normal_at(k, first), worst_(k, first));
    if (polygon.normals[k - 1].isZero()) rescore(score[count - 1], i, k - 1, k, normal_at(i, k - 1), worst_(i, k - 1));
    if (k - i == n - 1 && !polygon.normals[n - 1].isZero()) {
      const Eigen::Vector3d beyond = polygon.normals[n - 1];
      for (Index j = 0; j < count; ++j) score[j] = std::min(score[j], rounded(signed_square(i, first + j, k, beyond)));
    }
  }

  /// The scores of all apexes of chord (i, k): the worst angle of the triangle with the two fills beyond it, and theirs. Written so
  /// that Eigen takes four at a time: without a branch.
  void compare(Index i, Index k, Index n, [[maybe_unused]] bool only_best) {
    const Index from = i + 1, count = k - i - 1;
#ifdef TRIPATCH_PACKS
    if (has_packs() && count >= lanes) {
      const auto row = [&](const Square& square, Index of) { return square.data() + of * n + from; };
      Apexes apexes;
      for (int c = 0; c < 3; ++c) {
        apexes.x[c] = x_[c].data() + from;
        apexes.start[c] = x_[c][i];
        apexes.chord[c] = x_[c][k] - x_[c][i];
        apexes.before[c] = row(normal_[c], i);
        apexes.after[c] = row(normal_[c], k);
      }
      apexes.worst_before = row(worst_, i);
      apexes.worst_after = row(worst_, k);
      apexes.count = count;
      compare_packed(apexes, only_best, score_.data());
      return;
    }
#endif
    const auto of = [&](const Square& square, Index row) { return Eigen::Map<const Row>(square.data() + row * n + from, count); };
    auto nx = work_[0].head(count), ny = work_[1].head(count), nz = work_[2].head(count), square = work_[3].head(count),
         least = work_[4].head(count), score = score_.head(count);
    const double ex = x_[0][k] - x_[0][i], ey = x_[1][k] - x_[1][i], ez = x_[2][k] - x_[2][i], e2 = ex * ex + ey * ey + ez * ez;
    const auto ux = x_[0].segment(from, count) - x_[0][i], uy = x_[1].segment(from, count) - x_[1][i],
               uz = x_[2].segment(from, count) - x_[2][i];
    nx = uy * ez - uz * ey;
    ny = uz * ex - ux * ez;
    nz = ux * ey - uy * ex;
    square = nx.square() + ny.square() + nz.square();
    least = (e2 + ux.square() + uy.square() + uz.square()).square() * without_normal + std::numeric_limits<double>::min();
    least = (square / least).min(1.0);  // below 1: the triangle has no normal to speak of
    score = (nx * of(normal_[0], i) + ny * of(normal_[1], i) + nz * of(normal_[2], i))
                .min(nx * of(normal_[0], k) + ny * of(normal_[1], k) + nz * of(normal_[2], k));
    score = score * score.abs() / (square + std::numeric_limits<double>::min()) * least - (1 - least);
    score = ((score + score_rounder) - score_rounder).min(of(worst_, i)).min(of(worst_, k));
  }
  void rescore(double& score, Index i, Index m, Index k, const Eigen::Vector3d& beyond, double worst) const {
    const bool alone = m - i == 1 && k - m == 1 && beyond.isZero();
    const Eigen::Vector3d normal = triangle(i, m, k);
    score = std::min(rounded(alone ? signed_square(i, m, k, normal.stableNormalized()) : signed_square(i, m, k, beyond)), worst);
  }
  static double rounded(double s) { return (s + score_rounder) - score_rounder; }
  /// Of the cosine of the angle between a triangle's normal and a unit normal; towards -1 where the triangle has none, as in compare().
  double signed_square(Index i, Index m, Index k, const Eigen::Vector3d& beyond) const {
    const Eigen::Vector3d normal = triangle(i, m, k);
    const double c = normal.dot(beyond), square = normal.squaredNorm(), lengths = edge_square(i, m) + edge_square(i, k);
    const double least = std::min(square / (lengths * lengths * without_normal + std::numeric_limits<double>::min()), 1.0);
    return std::clamp(c * std::abs(c) / (square + std::numeric_limits<double>::min()), -1.0, 1.0) * least - (1 - least);
  }
  double edge_square(Index i, Index k) const {
    double sum = 0;
    for (int c = 0; c < 3; ++c) sum += (x_[c][k] - x_[c][i]) * (x_[c][k] - x_[c][i]);
    return sum;
  }
  Eigen::Vector3d triangle(Index i, Index m, Index k) const {
    const Eigen::Vector3d a(x_[0][i], x_[1][i], x_[2][i]), b(x_[0][m], x_[1][m], x_[2][m]), c(x_[0][k], x_[1][k], x_[2][k]);
    return (b - a).cross(c - a);
  }
  Eigen::Vector3d normal_at(Index i, Index k) const { return {normal_[0](i, k), normal_[1](i, k), normal_[2](i, k)}; }

  const PointsRef& points_;
  std::vector<EdgeKey> joined_, bridges_;  // ordered pairs, sorted
  std::vector<EdgeKey> avoided_;
  const ClosedLine* left_alone_ = nullptr;
  std::unordered_map<std::uint64_t, bool> pierced_;  // what is_pierced found
  bool by_area_ = false;
  std::vector<Index> place_;
  std::array<Square, 3> normal_;  // of the triangle at chord (i, k), and at (k, i) again; of the faces beyond for (k, k + 1)
  Square worst_, area_;           // worst angle, twice the area
  Eigen::Array<int, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> apex_;
  std::array<Row, 3> x_;
  Row score_;
  std::array<Row, 5> work_;
};

/// What a filler makes, and where that goes through itself.
struct Try {
  Triangles triangles;
  std::vector<Crossing> crossings;
};

Try tried(const PointsRef& points, const RimPolygon& polygon, Filler& filler) {
  Try result;
  filler.fill(polygon, result.triangles);
  result.crossings = find_crossings(points, Points(0, 3), faces_of(result.triangles), max_crossings);
  return result;
}

/// The first of some tries that does not cross itself, each without the chords that cross something in those before.
std::optional<Try> next_without_crossings(const PointsRef& points, const RimPolygon& polygon, int rounds, Filler& filler) {
  for (int round = 0; round < rounds; ++round) {
    Try made = tried(points, polygon, filler);
    if (made.crossings.empty()) return made;
    filler.avoid(made.crossings);
  }
  return {};
}

/// The first triangulation that does not cross itself and folds no more than what crosses, else the one of these that folds least; what
/// crosses where every one that is tried does.
RoughFill without_crossings(const PointsRef& points, const RimPolygon& polygon, Filler filler) {
  if (polygon.size() > largest_tried) {
    RoughFill untried;
    filler.fill(polygon, untried.triangles);
    return untried;
  }
  Try first = tried(points, polygon, filler);
  if (first.crossings.empty()) return {std::move(first.triangles), {}};
  const auto folds = [&](const Try& each) { return count_folded_edges(points, each.triangles, beyond_of(polygon)); };
  std::optional<Try> best;
  const auto seek = [&](int rounds) {
    if (best && folds(*best) <= folds(first)) return;
    std::optional<Try> next = next_without_crossings(points, polygon, rounds, filler);
    if (next && (!best || folds(*next) < folds(*best))) best = std::move(next);
  };
  filler.avoid(first.crossings);
  seek(rounds_of_a_kind - 1);
  const ClosedLine line(points, polygon.vertices);
  filler.leave_alone(line);
  seek(rounds_of_a_kind);
  filler.by_area();
  seek(rounds_of_a_kind);
  if (!best) return {std::move(first.triangles), {}};
  return {std::move(best->triangles), std::move(first.triangles)};
}

RoughFill made_anew(const PointsRef& points, const RimSurroundings& rim) {
  std::vector<EdgeKey> joined, bridges;
  for (const auto& [a, b] : rim.joined) joined.push_back(edge_key(a, b));
  std::sort(joined.begin(), joined.end());
  const RimPolygon polygon = one_polygon(points, rim, joined, bridges);
  RoughFill result = without_crossings(points, polygon, Filler(points, joined, bridges));
  joined.erase(std::unique(joined.begin(), joined.end()), joined.end());
  result.doubles_edges = !without_doubles(result.triangles, joined);
  return result;
}

}  // namespace

RoughFill min_weight_triangulation(const PointsRef& points, const RimSurroundings& rim) {
  static LruCache<RoughFill> last;  // a hole is filled several times, each time with less of its surroundings
  Key key;
  key.add(rim.islands);
  for (const Points& each : {Points(points), rim.normals}) {
    key.add(static_cast<double>(each.rows()));
    key.add(each.reshaped());
  }
  for (const auto& [a, b] : rim.joined) key.add(static_cast<double>(a)), key.add(static_cast<double>(b));
  if (const auto found = last.find(key)) return *found;
  return *last.keep(std::move(key), std::make_shared<RoughFill>(made_anew(points, rim)));
}

}  // namespace tripatch
