#include "tripatch/hole/clear_corners.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "tripatch/hole/corners.h"
#include "tripatch/hole/rim_shape.h"
#include "tripatch/hole/sharp_sides.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/math/tolerant_compare.h"

namespace tripatch {
namespace {

/// A corner turns by at least this (radians, 12 degrees): as much as the domain of a patch of n sides does at each of its corners.
constexpr double min_turn = 12 * std::numbers::pi / 180;
/// And by this many times what the vertices next to it turn, two to either side. Smooth sides bend alike from vertex to vertex; where an
/// arc begins at a straight line it is twice as much.
constexpr double over_beside = 2.5;
constexpr Index beside = count::pair;
/// But a bend within an edge of a corner that turns this many times as much is none: where fillets of three radii meet, curves of CAD
/// programs bend by 16 to 17 degrees next to corners of 100.
constexpr double over_bend = factor::large;
/// Corners are edges apart, three in the mean: of shorter sides nobody knows which way they run.
constexpr Index min_edges = count::pair, mean_edges = count::few;
constexpr Index max_clear = count::dozen;
constexpr Index min_round_edges = count::octet;
/// The end of a prism of so few walls has a corner at every vertex: of more it may be a coarse tube.
constexpr std::size_t max_walls = count::half_dozen;

/// Whether no face around is a triangle: lines of quads tell of three corners more surely than turns do.
bool between_lines(const Connectivity& around, const std::vector<Index>& rim) {
  for (Index v : rim)
    for (const Connectivity::Corner c : around.at(v))
      if (around.faces()[around.face(c)].size() < 4) return false;
  return true;
}

/// As clear_corners, by the turns of the rim.
std::vector<Index> clear_by(const RimShape& shape, const Mesh& mesh, const std::vector<Index>& rim) {
  const Index n = static_cast<Index>(rim.size());
  if (n < 2 * mean_edges || shape.without_area) return {};
  std::vector<Index> order(n);
  std::iota(order.begin(), order.end(), Index{0});
  const auto size = [&](Index k) { return std::abs(shape.turn[k]); };
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return coarse(size(a)) > coarse(size(b)); });
  std::vector<Index> corners;
  std::vector<char> is_corner(n, 0);
  const auto bends_beside_corner = [&](Index k) {
    for (Index step = 1; step < min_edges; ++step)
      for (Index other : {(k + step) % n, (k + n - step) % n})
        if (is_corner[other] && clearly_less(over_bend * size(k), size(other))) return true;
    return false;
  };
  for (Index k : order) {
    if (clearly_less(size(k), min_turn)) break;
    double near = 0;
    for (Index step = 1; step <= beside; ++step)
      for (Index other : {(k + step) % n, (k + n - step) % n})
        if (!is_corner[other]) near = std::max(near, size(other));
    if (clearly_less(size(k), over_beside * near) || bends_beside_corner(k)) continue;
    if (shape.turn[k] < 0) return {};  // such holes are not convex
    corners.push_back(k);
    is_corner[k] = 1;
  }
  const Index count = static_cast<Index>(corners.size());
  if (count < 2 || count > max_clear || count * mean_edges > n) return {};
  const double least = size(corners.back());
  for (Index k = 0; k < n; ++k)
    if (!is_corner[k] && at_least(size(k), least)) return {};
  std::sort(corners.begin(), corners.end());
  for (Index k = 0; k < count; ++k)
    if ((corners[(k + 1) % count] - corners[k] + n) % n < min_edges) return {};
  if (zigzag(mesh, rim, corners) > smooth_sides) return {};
  return corners;
}

bool meet_at_angle(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim,
                   const std::vector<Index>& places) {
  return places.size() >= 2 && std::cmp_less_equal(places.size(), max_clear) && any_sharp(sharp_sides(mesh, around, rim, places));
}

}  // namespace

std::vector<Index> clear_corners(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim) {
  // faces that meet the hole at an angle tell of another plane than the one in which the rim turns
  const std::vector<Index> alone = clear_by(measure_alone(mesh, rim), mesh, rim);
  return meet_at_angle(mesh, around, rim, alone) ? alone : clear_by(measure(mesh, around, rim), mesh, rim);
}

bool is_round(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim) {
  const Index n = static_cast<Index>(rim.size());
  if (n < min_round_edges) return false;
  const RimShape shape = measure(mesh, around, rim);
  if (shape.without_area) return false;
  double most = 0;
  for (double turn : shape.turn) most = std::max(most, std::abs(turn));
  if (clearly_more(most, std::max(over_beside * 2 * std::numbers::pi / static_cast<double>(n), min_turn))) return false;
  return zigzag(mesh, rim, {}) <= smooth_sides;
}

std::vector<Index> corners_between_sides(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim) {
  std::vector<Index> clear = clear_corners(mesh, around, rim), seen;
  try {
    seen = detect_corners(mesh, around, rim);
  } catch (const Refusal&) {  // the faces around tell nothing
    return {};
  }
  if (clear.size() > 3 && !(seen.size() == 3 && between_lines(around, rim))) return clear;
  if (seen.size() == 3) return seen;
  return clear.size() == 2 ? clear : std::vector<Index>();
}

std::vector<Index> corners_between_sharp(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim) {
  try {
    std::vector<Index> places = detect_corners(mesh, around, rim);
    if (places.empty() && rim.size() <= max_walls) {
      places.resize(rim.size());
      std::iota(places.begin(), places.end(), Index{0});
    }
    if (meet_at_angle(mesh, around, rim, places)) return places;
  } catch (const Refusal&) {  // faces without area
  }
  return {};
}

std::vector<Index> corners_of_fill(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim) {
  std::vector<Index> places = corners_between_sides(mesh, around, rim);
  return places.empty() ? corners_between_sharp(mesh, around, rim) : places;
}

}  // namespace tripatch
