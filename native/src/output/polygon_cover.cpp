#include "tripatch/output/polygon_cover.h"

#include <algorithm>
#include <array>

namespace tripatch {
namespace {

/// Over all vertices inside: on the surface, then for the least angle. Choices.
constexpr int sweeps_on_surface = 10, sweeps_of_angles = 20;

Points surface_rows(const PlanePoints& uv) {
  Points rows = Points::Zero(uv.rows(), 3);
  rows.leftCols(2) = uv;
  return rows;
}

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
  return (patch.positions(surface_rows(uv)) - middle).rowwise().norm().maxCoeff();
}

Points on_surface(const PlaneLayout& layout, const Surface& patch, const Points& border) {
  Points vertices = patch.positions(surface_rows(layout.uv));
  vertices.topRows(layout.rim) = border;
  return vertices;
}

/// Smooths on the surface, as far as that helps the least angle. Returns the vertices.
Points smoothed(PlaneLayout& layout, const Surface& patch, const Points& border) {
  Points best = on_surface(layout, patch, border);
  double least = quad_quality(best, layout.faces).least;
  for (const auto& [sweeps, sharpening] : {std::array<int, 2>{sweeps_on_surface, 0}, {0, sweeps_of_angles}}) {
    PlaneLayout trial = layout;
    smooth_quads(trial, sweeps, sharpening, &patch, &border);
    Points there = on_surface(trial, patch, border);
    const double now = quad_quality(there, layout.faces).least;
    if (!(now >= least)) continue;
    least = now;
    best = std::move(there);
    layout = std::move(trial);
  }
  return best;
}

}  // namespace

PlaneCover cover_polygon_with_quads(const PlanePoints& given, const Points& points, std::vector<RimCorner> corners,
                                    const Surface& patch, const LayoutOptions& options) {
  PlaneCover cover;
  PlanePoints rim = given;
  Points border = points;
  for (Index k = 0; k < given.rows(); ++k) cover.rim_rows.push_back(k);
  if (given.rows() % 2 == 1 && options.split_odd) {
    const Index place = static_cast<Index>(longest_edge(points)), n = given.rows(), next = (place + 1) % n;
    cover.split = {place, next};
    cover.rim_rows.insert(cover.rim_rows.begin() + place + 1, -1);
    rim.resize(n + 1, 2);
    rim << given.topRows(place + 1), 0.5 * (given.row(place) + given.row(next)), given.bottomRows(n - place - 1);
    border.resize(n + 1, 3);
    border << points.topRows(place + 1), patch.positions(surface_rows(rim.row(place + 1))), points.bottomRows(n - place - 1);
    for (RimCorner& corner : corners) corner.place += corner.place > place;
  } else if (given.rows() % 2 == 1) {
    cover.warnings.emplace_back("The rim has an odd number of edges: the quads leave one triangle");
  }
  cover.rim = rim.rows();
  // rows along the rim put two quads into each corner: none is added that is not asked for
  const int first = options.rows.value_or(0), last = options.rows || !options.tolerance ? first : most_extra_rows;
  bool near = false;
  for (int rows = first; rows <= last && !near; ++rows) {
    PlaneLayout layout = polygon_layout(rim, corners, rows);
    Points vertices = smoothed(layout, patch, border);
    near = first == last || middle_deviation(layout, vertices, patch) <= *options.tolerance;
    cover.uv = std::move(layout.uv);
    cover.faces = std::move(layout.faces);
    cover.poles = std::move(layout.poles);
    cover.rows = rows;
  }
  if (!near) cover.warnings.emplace_back(too_few_rows);
  return cover;
}

}  // namespace tripatch
