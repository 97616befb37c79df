#include "tripatch/output/polygon_cover.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "tripatch/math/thresholds.h"

namespace tripatch {
namespace {

/// The largest distance of the quads' middles from the patch.
double middle_deviation(const PlaneLayout& layout, const Points& vertices, const Surface& patch) {
  PlanePoints uv = PlanePoints::Zero(layout.faces.size(), 2);
  Points middle = Points::Zero(layout.faces.size(), 3);
  for (Index f = 0; f < layout.faces.size(); ++f) {
    const double share = 1 / static_cast<double>(layout.faces[f].size());
    for (Index v : layout.faces[f]) {
      uv.row(f) += share * layout.uv.row(v);
      middle.row(f) += share * vertices.row(v);
    }
  }
  return (patch.positions(as_rows(uv)) - middle).rowwise().norm().maxCoeff();
}

/// Squares of a round rim's edges that a quad may cover on average where nobody says how many rows there are. Between quads as large as in a
/// disc (0.9 of them) and in a half sphere without extra rows (1.7).
constexpr double largest_quad = 1.25;

double squares_a_quad(const PlaneLayout& layout, const Points& vertices) {
  double area = 0, length = 0;
  for (Index f = 0; f < layout.faces.size(); ++f) {
    const auto face = layout.faces[f];
    const auto at = [&](std::size_t k) { return Vec3(vertices.row(face[k])); };
    for (std::size_t k = 2; k < face.size(); ++k) area += 0.5 * (at(k - 1) - at(0)).cross(at(k) - at(0)).norm();
  }
  for (Index k = 0; k < layout.rim; ++k) length += (vertices.row((k + 1) % layout.rim) - vertices.row(k)).norm();
  const double edge = length / static_cast<double>(layout.rim);
  return area / static_cast<double>(layout.faces.size()) / std::max(edge * edge, tolerance::tiny);
}

/// Rows of a rim, and after that of `place` another.
template <class Rows>
Rows with_row(const Rows& rim, Index place, const Eigen::RowVectorXd& row) {
  Rows more(rim.rows() + 1, rim.cols());
  more << rim.topRows(place + 1), row, rim.bottomRows(rim.rows() - place - 1);
  return more;
}

PlanePoints with_middle(const PlanePoints& rim, Index place) {
  return with_row(rim, place, 0.5 * (rim.row(place) + rim.row((place + 1) % rim.rows())));
}

/// Without a vertex of the rim, which lies amid an edge: of the two quads there a quad and a triangle are left. None where it is not in two.
std::optional<PlaneLayout> without_middle(PlaneLayout layout, Index middle) {
  Faces faces;
  int before = 0, after = 0;
  const auto left = [middle](Index v) { return v - (v > middle); };
  for (Index f = 0; f < layout.faces.size(); ++f) {
    std::vector<Index> face(layout.faces[f].begin(), layout.faces[f].end());
    const auto at = std::find(face.begin(), face.end(), middle);
    const bool beside = at != face.end();
    if (beside) std::rotate(face.begin(), at, face.end());  // the vertex, and the others forwards
    const bool ends = beside && face[3] == (middle + layout.rim - 1) % layout.rim;
    for (Index& v : face) v = left(v);
    if (ends) {  // the edge's beginning, and its end in place of its middle
      face[0] = left((middle + 1) % layout.rim);
      ++before;
    } else if (beside) {
      face.erase(face.begin());
      ++after;
    }
    faces.add(face);
  }
  if (before != 1 || after != 1) return {};
  layout.faces = std::move(faces);
  for (Index& pole : layout.poles) pole = left(pole);
  const Index behind = layout.uv.rows() - middle - 1;
  layout.uv.middleRows(middle, behind) = layout.uv.bottomRows(behind).eval();
  layout.uv.conservativeResize(layout.uv.rows() - 1, Eigen::NoChange);
  --layout.rim;
  return layout;
}

/// The vertices inside that are nearest to these places, the nearest of all first, each with its place; fewer where there are too few.
std::vector<std::pair<Index, Vec2>> nearest_inside(const PlaneLayout& layout, std::vector<Vec2> places) {
  std::vector<std::pair<Index, Vec2>> found;
  std::vector<bool> taken(static_cast<std::size_t>(layout.uv.rows()), false);
  while (!places.empty() && static_cast<Index>(found.size()) < layout.uv.rows() - layout.rim) {
    double least = INFINITY;
    Index vertex = 0;
    std::size_t place = 0;
    for (Index v = layout.rim; v < layout.uv.rows(); ++v)
      for (std::size_t k = 0; k < places.size() && !taken[v]; ++k) {
        const double apart = (layout.uv.row(v).transpose() - places[k]).norm();
        if (!(apart < least)) continue;
        least = apart;
        vertex = v;
        place = k;
      }
    found.emplace_back(vertex, places[place]);
    taken[vertex] = true;
    places.erase(places.begin() + static_cast<std::ptrdiff_t>(place));
  }
  return found;
}

/// Vertices go to their places in so many steps, each followed by so many sweeps over the others: no quad need turn over on the way.
constexpr int steps_to_places = 5, sweeps_on_the_way = 3;

/// The same with vertices at these places; nothing where there are too few, or a quad would turn over.
std::optional<Points> smoothed_at(PlaneLayout& layout, const Surface& patch, const Points& border,
                                  const std::vector<Vec2>& places) {
  const auto found = nearest_inside(layout, places);
  if (found.size() < places.size()) return {};
  std::vector<Index> held;
  for (const auto& [v, place] : found) held.push_back(v);
  PlaneLayout trial = layout;
  for (int step = 1; step <= steps_to_places; ++step) {
    for (const auto& [v, place] : found) {
      const Vec2 start = layout.uv.row(v);
      trial.uv.row(v) = step == steps_to_places ? place : Vec2(start + step * (place - start) / steps_to_places);
    }
    smooth_quads(trial, sweeps_on_the_way, 0, &patch, &border, held);
  }
  Points vertices = smoothed_on(trial, patch, border, held);
  if (!(quad_quality(vertices, trial.faces).least >= min_sine)) return {};
  layout = std::move(trial);
  return vertices;
}

}  // namespace

std::optional<PlaneLayout> disc_layout(Index edges, int rows) {
  PlanePoints rim(edges, 2);
  for (Index k = 0; k < edges; ++k) {
    const double turn = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(edges);
    rim.row(k) << std::cos(turn), std::sin(turn);
  }
  if (edges % 2 == 0) return polygon_layout(rim, {}, rows);
  return without_middle(polygon_layout(with_middle(rim, edges - 1), {}, rows), edges);
}

std::optional<PlaneLayout> square_layout(Index edges, const std::vector<Index>& corners, int rows) {
  if (corners.size() != 4 || corners[2] - corners[0] != edges - (corners[2] - corners[0]) ||
      corners[1] - corners[0] != corners[3] - corners[2])
    return {};
  PlanePoints rim(edges, 2);
  std::vector<RimCorner> square;
  for (std::size_t i = 0; i < 4; ++i) {
    const std::array<Vec2, 5> at = {{{1, 0}, {0, 1}, {-1, 0}, {0, -1}, {1, 0}}};
    const Index next = i < 3 ? corners[i + 1] : corners[0] + edges, count = next - corners[i];
    for (Index k = 0; k < count; ++k)
      rim.row((corners[i] + k) % edges) = at[i] + (at[i + 1] - at[i]) * (static_cast<double>(k) / static_cast<double>(count));
    square.push_back({corners[i], 1});
  }
  return polygon_layout(rim, square, rows);
}

PlaneCover cover_polygon_with_quads(const PlanePoints& given, const Points& points, std::vector<RimCorner> corners,
                                    const Surface& patch, const LayoutOptions& options, const std::vector<Vec2>& met) {
  PlaneCover cover;
  PlanePoints rim = given;
  Points border = points;
  for (Index k = 0; k < given.rows(); ++k) cover.rim_rows.push_back(k);
  const bool odd = given.rows() % 2 == 1, halved = odd && !options.split_odd && corners.empty();
  const Index place = odd ? static_cast<Index>(longest_edge(points)) : 0;
  if (odd && options.split_odd) {
    cover.split = {place, (place + 1) % given.rows()};
    cover.rim_rows.insert(cover.rim_rows.begin() + place + 1, -1);
    rim = with_middle(given, place);
    border = with_row(points, place, patch.positions(as_rows(rim.row(place + 1))));
    for (RimCorner& corner : corners) corner.place += corner.place > place;
  } else if (odd) {
    cover.warnings.push_back({Code::one_triangle});
  }
  cover.rim = rim.rows();
  // rows along the rim put two quads into each corner: none is added that is not asked for
  const bool as_rim = !options.tolerance && corners.empty();
  const int first = options.rows.value_or(0), last = options.rows || !(options.tolerance || as_rim) ? first : max_extra_rows;
  bool near = false, meets = met.empty();
  for (int rows = first; rows <= last && !(near && (meets || as_rim)); ++rows) {
    PlaneLayout layout = polygon_layout(halved ? with_middle(rim, place) : rim, corners, rows);
    if (halved) {
      std::optional<PlaneLayout> joined = without_middle(std::move(layout), place + 1);
      if (!joined) return {};
      layout = std::move(*joined);
    }
    Points vertices = smoothed_on(layout, patch, border);
    if (!met.empty()) {
      std::optional<Points> at = smoothed_at(layout, patch, border, met);
      meets = at.has_value();
      if (meets) vertices = std::move(*at);
    }
    near = first == last || (as_rim ? squares_a_quad(layout, vertices) <= largest_quad
                                    : middle_deviation(layout, vertices, patch) <= *options.tolerance);
    cover.uv = std::move(layout.uv);
    cover.faces = std::move(layout.faces);
    cover.poles = std::move(layout.poles);
    cover.rows = rows;
  }
  if (!near && !as_rim) cover.warnings.push_back({Code::tolerance_out_of_reach});
  if (!meets) cover.warnings.push_back({Code::points_without_vertices});
  return cover;
}

}  // namespace tripatch
