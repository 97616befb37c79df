#include "tripatch/quads/spread.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "tripatch/quads/row_widths.h"
#include "tripatch/quads/weighted_means.h"

namespace tripatch {
namespace {

double twice_area(const Vec2& a, const Vec2& b) { return a[0] * b[1] - a[1] * b[0]; }

/// Barycentric coordinates; none in a triangle without area.
std::optional<Vec3> coordinates_in(const std::array<Vec2, 3>& triangle, const Vec2& place) {
  const auto& [a, b, c] = triangle;
  const double area = twice_area(b - a, c - a);
  if (!(area > 0)) return {};
  const double u = twice_area(c - b, place - b) / area, v = twice_area(a - c, place - c) / area;
  return Vec3(u, v, 1 - u - v);
}

/// Turns less the whole ones that are nearest.
double part_of_turn(double turns) { return turns - std::round(turns); }

/// A point inside a loop: in the middle of the widest line across it at half of its height.
Vec2 inside_of(const PlanePoints& loop) {
  const double height = 0.5 * (loop.col(1).minCoeff() + loop.col(1).maxCoeff());
  std::vector<double> crossings;
  for (Index k = 0; k < loop.rows(); ++k) {
    const Vec2 a = loop.row(k), b = loop.row((k + 1) % loop.rows());
    if ((a[1] > height) != (b[1] > height)) crossings.push_back(a[0] + (b[0] - a[0]) * (height - a[1]) / (b[1] - a[1]));
  }
  std::sort(crossings.begin(), crossings.end());
  Vec2 found(loop.col(0).mean(), height);
  double widest = 0;
  for (std::size_t k = 0; k + 1 < crossings.size(); k += 2)
    if (crossings[k + 1] - crossings[k] > widest) {
      widest = crossings[k + 1] - crossings[k];
      found[0] = 0.5 * (crossings[k] + crossings[k + 1]);
    }
  return found;
}

double twice_area(const PlanePoints& loop) {
  double area = 0;
  for (Index k = 0; k < loop.rows(); ++k) area += twice_area(Vec2(loop.row(k)), Vec2(loop.row((k + 1) % loop.rows())));
  return area;
}

std::array<Index, 2> edge_between(Index a, Index b) { return {std::min(a, b), std::max(a, b)}; }

/// Triangles whose edges between vertices of one loop that are not of its border are halved: beyond such an edge all would come to lie on the
/// straight end of a cylinder. points: two loops, the first with so many, and what is inside; the middles follow.
std::vector<std::array<Index, 3>> with_chords_halved(const std::vector<std::array<Index, 3>>& triangles, Index of_first,
                                                     Index ends, PlanePoints& points) {
  std::map<std::array<Index, 2>, int> uses;
  for (const std::array<Index, 3>& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) ++uses[edge_between(t[k], t[(k + 1) % 3])];
  std::map<std::array<Index, 2>, Index> middle;
  for (const auto& [edge, count] : uses)
    if (count > 1 && edge[1] < ends && (edge[0] < of_first) == (edge[1] < of_first))
      middle[edge] = points.rows() + static_cast<Index>(middle.size());
  const Index given = points.rows();
  points.conservativeResize(given + static_cast<Index>(middle.size()), Eigen::NoChange);
  for (const auto& [edge, m] : middle) points.row(m) = 0.5 * (points.row(edge[0]) + points.row(edge[1]));
  std::vector<std::array<Index, 3>> left = triangles, halved;
  while (!left.empty()) {
    std::array<Index, 3> t = left.back();
    left.pop_back();
    const auto middle_of_first = [&] { return middle.find(edge_between(t[0], t[1])); };
    int turns = 0;
    while (turns < 3 && middle_of_first() == middle.end()) {
      std::rotate(t.begin(), t.begin() + 1, t.end());
      ++turns;
    }
    if (turns == 3) {
      halved.push_back(t);
      continue;
    }
    const Index m = middle_of_first()->second;
    left.push_back({t[0], m, t[2]});
    left.push_back({m, t[1], t[2]});
  }
  return halved;
}

}  // namespace

void spread_inside(const Faces& faces, Index rim, Points& rows) {
  double mean = 0;
  for (Index k = 0; k < rim; ++k) mean += (rows.row(k) - rows.row((k + 1) % rim)).norm() / static_cast<double>(rim);
  RowWidths widths(faces, rim);
  widths.measure(rows, mean);
  std::vector<NetEdge> edges;
  for (const auto& [a, b] : widths.edges())
    edges.push_back({a, b, std::pow(mean / widths.width(static_cast<Index>(edges.size())), 2)});
  to_weighted_means(edges, first_rows(rim, rows.rows()), rows);
}

void embed(PlaneLayout& layout) {
  Points rows = as_rows(layout.uv);
  spread_inside(layout.faces, layout.rim, rows);
  layout.uv = rows.leftCols(2);
}

PlaneTriangles::PlaneTriangles(std::vector<std::array<Index, 3>> triangles, PlanePoints at)
    : triangles_(std::move(triangles)),
      at_(std::move(at)),
      cells_(static_cast<Index>(std::sqrt(static_cast<double>(triangles_.size()))) + 1),
      lowest_(at_.colwise().minCoeff()),
      cell_((at_.rowwise() - lowest_).maxCoeff() / static_cast<double>(cells_)) {
  in_cell_.resize(static_cast<std::size_t>(cells_ * cells_));
  for (std::size_t k = 0; k < triangles_.size(); ++k) {
    const PlanePoints corners = at_(triangles_[k], Eigen::all);
    const auto [first, last] = std::pair(cell(corners.colwise().minCoeff()), cell(corners.colwise().maxCoeff()));
    for (Index x = first[0]; x <= last[0]; ++x)
      for (Index y = first[1]; y <= last[1]; ++y) in_cell_[static_cast<std::size_t>(x * cells_ + y)].push_back(k);
  }
}

Eigen::MatrixXd PlaneTriangles::carried(const PlanePoints& places, const Eigen::MatrixXd& values) const {
  Eigen::MatrixXd found = Eigen::MatrixXd::Zero(places.rows(), values.cols());
  for (Index row = 0; row < places.rows(); ++row) {
    const std::array<Index, 2> own = cell(places.row(row));
    double best = -INFINITY;
    for (const std::size_t k : in_cell_[static_cast<std::size_t>(own[0] * cells_ + own[1])]) {
      const std::array<Index, 3>& t = triangles_[k];
      const std::optional<Vec3> in =
          coordinates_in({Vec2(at_.row(t[0])), Vec2(at_.row(t[1])), Vec2(at_.row(t[2]))}, Vec2(places.row(row)));
      if (!in || !(in->minCoeff() > best)) continue;
      best = in->minCoeff();
      found.row(row) = in->transpose() * values(t, Eigen::all);
    }
  }
  return found;
}

std::array<Index, 2> PlaneTriangles::cell(const Eigen::RowVector2d& place) const {
  const Eigen::RowVector2d in_cells = (place - lowest_) / cell_;
  const auto of = [&](double x) { return std::clamp<Index>(static_cast<Index>(x), 0, cells_ - 1); };
  return {of(in_cells[0]), of(in_cells[1])};
}

PlaneTriangles spread_triangles(const std::vector<std::array<Index, 3>>& triangles, Index count, const PlanePoints& rim_at) {
  Faces faces;
  for (const std::array<Index, 3>& t : triangles) faces.add(t);
  Points rows = Points::Zero(count, 3);
  rows.topRows(rim_at.rows()).leftCols(2) = rim_at;
  spread_inside(faces, rim_at.rows(), rows);
  return PlaneTriangles(triangles, rows.leftCols(2));
}

SpreadRing::SpreadRing(const std::vector<std::array<Index, 3>>& triangles, const PlanePoints& points, const PlanePoints& ends_at)
    : points_(points) {
  const Index ends = ends_at.rows(), of_first = std::count(ends_at.col(1).begin(), ends_at.col(1).end(), 0.0);
  triangles_ = with_chords_halved(triangles, of_first, ends, points_);
  turn_.resize(points_.rows());
  at_ = PlanePoints::Zero(points_.rows(), 2);
  const std::array<PlanePoints, 2> loops = {points_.topRows(of_first), points_.middleRows(of_first, ends - of_first)};
  const std::array<double, 2> areas = {twice_area(loops[0]), twice_area(loops[1])};
  const double direction = areas[0] > 0 ? 1 : -1;  // inside out where the first loop is the inner one
  const Vec2 middle = inside_of(std::abs(areas[0]) < std::abs(areas[1]) ? loops[0] : loops[1]);
  for (Index k = 0; k < points_.rows(); ++k)
    turn_[k] = direction * std::atan2(points_(k, 1) - middle[1], points_(k, 0) - middle[0]) / (2 * std::numbers::pi);
  // How much farther a vertex has turned than in the plane has one value, where its turn has as many as there are ways to it.
  const auto farther = [&](Index from, Index to) {
    return part_of_turn(ends_at(to, 0) - ends_at(from, 0)) - part_of_turn(turn_[to] - turn_[from]);
  };
  at_.topRows(ends) = ends_at;
  for (const auto& [first, last] : {std::array{Index{0}, of_first}, std::array{of_first, ends}}) {
    at_(first, 0) = part_of_turn(ends_at(first, 0) - turn_[first]);
    for (Index k = first + 1; k < last; ++k) at_(k, 0) = at_(k - 1, 0) + farther(k - 1, k);
  }
  const double apart = at_.col(0).segment(of_first, ends - of_first).mean() - at_.col(0).head(of_first).mean();
  at_.col(0).segment(of_first, ends - of_first).array() -= std::round(apart);
  std::set<std::array<Index, 2>> joined;
  for (const std::array<Index, 3>& t : triangles_)
    for (std::size_t k = 0; k < 3; ++k) joined.insert(edge_between(t[k], t[(k + 1) % 3]));
  std::vector<NetEdge> edges;
  for (const auto& [a, b] : joined) edges.push_back({a, b, 1, part_of_turn(turn_[b] - turn_[a])});
  to_weighted_means(edges, first_rows(ends, points_.rows()), at_);
}

std::array<Vec2, 3> SpreadRing::corners(const std::array<Index, 3>& triangle) const {
  std::array<Vec2, 3> found;
  for (std::size_t k = 0; k < 3; ++k)
    found[k] << turn_[triangle[0]] + part_of_turn(turn_[triangle[k]] - turn_[triangle[0]]) + at_(triangle[k], 0),
        at_(triangle[k], 1);
  return found;
}

Vec2 SpreadRing::carried(const Vec2& place) const {
  double best = -INFINITY;
  Vec2 found = Vec2::Zero();
  for (const std::array<Index, 3>& t : triangles_) {
    const std::array<Vec2, 3> own = corners(t);
    const double middle = (own[0][0] + own[1][0] + own[2][0]) / 3;
    const std::optional<Vec3> in = coordinates_in(own, Vec2(middle + part_of_turn(place[0] - middle), place[1]));
    if (!in || !(in->minCoeff() > best)) continue;
    best = in->minCoeff();
    found = (in->transpose() * points_(t, Eigen::all)).transpose();
  }
  return found;
}

}  // namespace tripatch
