#include "tripatch/hole/corners.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "tripatch/hole/rim_shape.h"
#include "tripatch/hole/sharp_sides.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/math/tolerant_compare.h"
#include "tripatch/messages.h"

namespace tripatch {
namespace {

using Loop = std::vector<Index>;

// Seen over the window, a round rim turns by 15 degrees, the ten test holes by 65 to 155 at their corners and by no more than 27
// elsewhere.
constexpr double clear_turn = 40 * std::numbers::pi / 180;  ///< a corner turns by at least this
constexpr double sure_turn =
    55 * std::numbers::pi / 180;                  ///< and is one whatever the number of edges (a hexagon has six corners)
constexpr double over_round = factor::slight;     ///< less sure ones: by this many times what a round rim of such edges turns,
constexpr double over_neighbors = factor::clear;  ///< or by this many times what it turns at the vertices next to it
constexpr double crisp_turn =
    75 * std::numbers::pi / 180;          ///< a single vertex that turns by this is never part of another corner,
constexpr double crisp_share = 1.0 / 12;  ///< given that its edges are this long, in windows: those of no length turn by noise
constexpr std::size_t max_corners = count::dozen;  ///< counted; a rim with more has none that is clear

/// How far the rim turns around each vertex: the mean direction over a window after it against that before it. That weights
/// the turns at the vertices by a tent, so noise, whose turns cancel, counts little and uneven spacing not at all.
std::vector<double> turns_over_window(const std::vector<double>& turn, const std::vector<double>& length, double total) {
  const Index n = static_cast<Index>(turn.size());
  const double window = window_share * total;
  // direction and its integral at the vertices, over three rounds
  std::vector<double> s(3 * n + 1, 0), direction(3 * n + 1, 0), integral(3 * n + 1, 0);
  for (Index k = 0; k < 3 * n; ++k) {
    if (k > 0) direction[k] = direction[k - 1] + turn[k % n];
    s[k + 1] = s[k] + length[k % n];
    integral[k + 1] = integral[k] + direction[k] * length[k % n];
  }
  const auto integral_at = [&](double x, Index& k) {
    while (s[k + 1] < x) ++k;
    return integral[k] + direction[k] * (x - s[k]);
  };
  std::vector<double> over(n);
  Index behind = 0, ahead = 0;
  for (Index k = 0; k < n; ++k) {
    const Index m = n + k;
    over[k] = (integral_at(s[m] + window, ahead) - 2 * integral[m] + integral_at(s[m] - window, behind)) / window;
  }
  return over;
}

/// Where the rim turns: places in it, in rim order.
std::vector<Index> turning_corners(RimShape shape, const Loop& rim) {
  const Index n = static_cast<Index>(rim.size());
  auto& [length, turn, without_area] = shape;
  const double total = std::accumulate(length.begin(), length.end(), 0.0);
  const double window = window_share * total;
  const std::vector<double> at_vertex = turn;

  // the strongest corner first; it takes with it what turns within its window
  std::vector<Index> corners;
  std::vector<char> is_corner(n, 0);
  while (corners.size() <= max_corners) {
    const std::vector<double> over = turns_over_window(turn, length, total);
    Index best = -1;
    for (Index k = 0; k < n; ++k) {
      const Index before = (k + n - 1) % n, after = (k + 1) % n;
      const double round = 2 * std::numbers::pi * std::max(window, 0.5 * (length[before] + length[k])) / total;
      const bool clear =
          at_least(over[k], clear_turn) && (at_least(over[k], std::min(over_round * round, sure_turn)) ||
                                            at_least(over[k], over_neighbors * std::max(at_vertex[before], at_vertex[after])));
      if (is_corner[k] || !clear) continue;
      // equally strong ones: the lowest vertex, not the last bit
      const double lead = best < 0 ? 1 : over[k] - over[best];
      if (lead > tolerance::same || (lead > -tolerance::same && rim[k] < rim[best])) best = k;
    }
    if (best < 0) break;
    corners.push_back(best);
    is_corner[best] = 1;
    turn[best] = 0;
    for (int step : {1, -1}) {
      double way = 0;
      for (Index k = best; clearly_less(way, window);) {
        way += length[step > 0 ? k : (k + n - 1) % n];
        k = (k + step + n) % n;
        const bool long_enough = at_least(0.5 * (length[k] + length[(k + n - 1) % n]), crisp_share * window);
        if (clearly_less(way, window) && !(at_least(std::abs(turn[k]), crisp_turn) && long_enough)) turn[k] = 0;
      }
    }
  }
  std::sort(corners.begin(), corners.end());
  return corners;
}

/// Where a rim of quads leaves the lines of its grid: three of their faces meet there, two at every other vertex of the rim. Empty
/// where it is not so.
std::vector<Index> grid_corners(const Connectivity& around, const Loop& rim) {
  std::vector<Index> corners;
  for (std::size_t k = 0; k < rim.size(); ++k) {
    const auto faces = around.at(rim[k]);
    if (faces.size() < 2 || faces.size() > 3) return {};
    for (const Connectivity::Corner c : faces)
      if (around.faces()[around.face(c)].size() != 4) return {};
    if (faces.size() == 3) corners.push_back(static_cast<Index>(k));
  }
  return corners;
}

}  // namespace

std::vector<Index> detect_corners(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim) {
  if (rim.size() == 3) return {0, 1, 2};
  const RimShape shape = measure(mesh, around, rim);
  if (shape.without_area) throw CodedRefusal(Code::faces_without_area, {rim[0]});
  // Faces that meet the hole at an angle tell of another plane than the one in which the rim turns.
  const std::vector<Index> alone = turning_corners(measure_alone(mesh, rim), rim);
  if (alone.size() >= 2 && alone.size() <= max_corners && any_sharp(sharp_sides(mesh, around, rim, alone))) return alone;
  std::vector<Index> corners = turning_corners(shape, rim);
  if (corners.size() == 3) return corners;
  // on a round shape the lines themselves turn, as they do over the edges of a cube made a sphere
  std::vector<Index> of_grid = grid_corners(around, rim);
  return of_grid.size() == 3 ? of_grid : corners;
}

std::array<Index, 3> three_corners(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim) {
  const std::vector<Index> corners = detect_corners(mesh, around, rim);
  if (corners.size() == 3) return {corners[0], corners[1], corners[2]};
  Loop where;
  for (Index k : corners) where.push_back(rim[k]);
  if (corners.empty()) throw CodedRefusal(Code::no_clear_corners, {rim[0]});
  if (corners.size() > max_corners) throw CodedRefusal(Code::too_many_corners, {{"most", max_corners}}, where);
  throw CodedRefusal(Code::not_three_corners, {{"count", corners.size()}}, where);
}

}  // namespace tripatch
