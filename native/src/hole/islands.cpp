#include "tripatch/hole/islands.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

#include "tripatch/math/box_tree.h"
#include "tripatch/math/thresholds.h"

namespace tripatch {
namespace {

/// Sine of 45 degrees: what lies farther off the faces at a border, seen from there, is above or below rather than ahead.
constexpr double off_faces = std::numbers::sqrt2 / 2;

/// Cosine of 70 degrees: so far ahead, in the mean, another border of the same part of the mesh lies that a person joins by hand. Of two holes
/// side by side in one surface it is about 0; across bent pipes it is more, up to bends of some 60 degrees.
const double ahead = std::cos(radians(angle::upright));

struct HoleBorder {
  std::vector<Vec3> points;
  std::vector<Vec3> onward, normal;  // of each edge, unit: away from the face next to it; of that face
  Vec3 middle = Vec3::Zero(), area = Vec3::Zero();
  double reach = 0;          // from the middle
  std::vector<Index> parts;  // of the mesh, by rising number
};

HoleBorder read_border(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& part,
                       const std::vector<Index>& loop) {
  HoleBorder border;
  for (Index v : loop) border.points.emplace_back(mesh.vertices.row(v));
  const std::size_t n = loop.size();
  border.middle = std::accumulate(border.points.begin(), border.points.end(), Vec3(Vec3::Zero())) / static_cast<double>(n);
  for (std::size_t k = 0; k < n; ++k) {
    const Vec3 &p = border.points[k], &q = border.points[(k + 1) % n];
    border.area += 0.5 * (p - border.middle).cross(q - border.middle);
    border.reach = std::max(border.reach, (p - border.middle).norm());
    const std::vector<Index> faces = around.faces_at_edge(loop[k], loop[(k + 1) % n]);
    if (faces.empty()) return {};
    border.parts.push_back(part[faces[0]]);
    Vec3 inside = Vec3::Zero();
    for (Index v : mesh.faces[faces[0]]) inside += Vec3(mesh.vertices.row(v));
    const Vec3 along = (q - p).stableNormalized(), back = inside / static_cast<double>(mesh.faces[faces[0]].size()) - p;
    border.onward.push_back(-(back - back.dot(along) * along).stableNormalized());
    border.normal.push_back(along.cross(border.onward.back()));
  }
  std::ranges::sort(border.parts);
  border.parts.erase(std::ranges::unique(border.parts).begin(), border.parts.end());
  return border;
}

bool share_part(const HoleBorder& a, const HoleBorder& b) {
  return std::ranges::any_of(a.parts, [&](Index part) { return std::ranges::binary_search(b.parts, part); });
}

/// The nearest vertex of a border.
Vec3 nearest(const HoleBorder& border, const Vec3& p) {
  return *std::ranges::min_element(border.points, {}, [&](const Vec3& q) { return (q - p).squaredNorm(); });
}

/// Whether the faces at a border, continued, lead to another one in the mean over its edges.
bool leads_to(const HoleBorder& from, const HoleBorder& to, double least = 0) {
  double forwards = 0, off = 0;
  for (std::size_t k = 0; k < from.points.size(); ++k) {
    const Vec3 p = 0.5 * (from.points[k] + from.points[(k + 1) % from.points.size()]);
    const Vec3 way = (nearest(to, p) - p).stableNormalized();
    forwards += way.dot(from.onward[k]);
    off += std::abs(way.dot(from.normal[k]));
  }
  return forwards > least * static_cast<double>(from.points.size()) && off < off_faces * static_cast<double>(from.points.size());
}

/// How often a border winds around a point, seen along its area.
double winding(const HoleBorder& border, const Vec3& point) {
  const Vec3 normal = border.area.stableNormalized();
  double angle = 0;
  for (std::size_t k = 0; k < border.points.size(); ++k) {
    const auto flat = [&](const Vec3& p) -> Vec3 { return p - point - (p - point).dot(normal) * normal; };
    const Vec3 a = flat(border.points[k]), b = flat(border.points[(k + 1) % border.points.size()]);
    angle += std::atan2(a.cross(b).dot(normal), a.dot(b));
  }
  return angle / (2 * std::numbers::pi);
}

double distance_between(const HoleBorder& a, const HoleBorder& b) {
  double least = INFINITY;
  for (const Vec3& p : a.points) least = std::min(least, (nearest(b, p) - p).norm());
  return least;
}

/// Pairs of borders, the lower number first, of which one may be an island in the other: of parts those alone where the balls around both
/// are nearer to each other than the larger is wide.
std::vector<std::array<std::size_t, 2>> pairs_among(const std::vector<HoleBorder>& borders, bool parts) {
  std::vector<std::array<std::size_t, 2>> pairs;
  std::vector<BoxTree::Box> balls;
  const auto ball = [](const HoleBorder& border, double reaches) {
    const Vec3 reach = Vec3::Constant(reaches * border.reach);
    return BoxTree::Box(border.middle - reach, border.middle + reach);
  };
  for (const HoleBorder& border : borders) balls.push_back(ball(border, 1));
  const BoxTree tree(std::move(balls));
  for (std::size_t a = 0; a < borders.size(); ++a) {
    const auto take = [&](std::size_t b) {
      if (a != b && (!parts || borders[b].reach <= borders[a].reach)) pairs.push_back({std::min(a, b), std::max(a, b)});
    };
    if (parts)
      tree.each_meeting(ball(borders[a], 3), take);
    else
      for (std::size_t b = a + 1; b < borders.size(); ++b) take(b);
  }
  std::ranges::sort(pairs);
  pairs.erase(std::ranges::unique(pairs).begin(), pairs.end());
  return pairs;
}

/// The distance between a hole and a border that is an island in it.
std::optional<double> island_at(const HoleBorder& hole, const HoleBorder& island, bool parts) {
  const bool one_part = share_part(hole, island);
  if ((parts && one_part) || hole.parts.empty() || island.parts.empty()) return {};
  // the balls around both are nearer to each other than the hole is wide, unless a person joins parts
  const bool near = (hole.middle - island.middle).norm() <= 3 * hole.reach + island.reach;
  if (!near && (parts || one_part)) return {};
  if (!parts) {
    const double least = one_part ? ahead : 0;
    const bool facing = leads_to(hole, island, least) && leads_to(island, hole, least);
    return facing ? std::optional(distance_between(hole, island)) : std::nullopt;
  }
  if (!(hole.area.dot(island.area) < 0) || !(winding(hole, island.middle) > 0.5)) return {};
  if (!leads_to(hole, island) || !leads_to(island, hole)) return {};
  return distance_between(hole, island);
}

}  // namespace

std::vector<std::vector<std::size_t>> islands_of(const Mesh& mesh, const Connectivity& around,
                                                 const std::vector<std::vector<Index>>& loops, bool parts) {
  std::vector<std::vector<std::size_t>> islands(loops.size());
  const std::vector<Index> part = components_of(around);
  if (parts && std::ranges::all_of(part, [](Index p) { return p == 0; })) return islands;
  std::vector<HoleBorder> borders;
  for (const std::vector<Index>& loop : loops) borders.push_back(read_border(mesh, around, part, loop));
  struct Pair {
    double distance;
    std::size_t hole, island;
  };
  std::vector<Pair> pairs;
  for (const auto& [a, b] : pairs_among(borders, parts)) {
    const bool first_is_larger =
        borders[a].reach > borders[b].reach || (borders[a].reach == borders[b].reach && loops[a] < loops[b]);
    const std::size_t hole = first_is_larger ? a : b, island = first_is_larger ? b : a;
    const std::optional<double> distance = island_at(borders[hole], borders[island], parts);
    // those that touch at a vertex are holes side by side
    if (distance && std::ranges::find_first_of(loops[a], loops[b]) == loops[a].end()) pairs.push_back({*distance, hole, island});
  }
  std::ranges::stable_sort(pairs, {}, &Pair::distance);
  std::vector<char> is_island(loops.size(), 0);
  for (const Pair& each : pairs) {
    std::vector<std::size_t>&own = islands[each.hole], &others = islands[each.island];
    if (is_island[each.hole] || is_island[each.island] || (!others.empty() && (parts || !own.empty()))) continue;
    is_island[each.island] = 1;
    own.push_back(each.island);
    own.insert(own.end(), others.begin(), others.end());  // of a joint with three arms, two of which are nearer to each other
    others.clear();
  }
  return islands;
}

}  // namespace tripatch
