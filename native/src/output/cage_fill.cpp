#include "tripatch/output/cage_fill.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "tripatch/output/quad_layout.h"

namespace tripatch {
namespace {

/// The mesh with its longest rim edge split, and the hole in it: the new vertex is the last, a corner of the face beside the rim.
Hole split_mesh(const Mesh& mesh, const Hole& hole, Points& vertices, Faces& faces, CageFill& result) {
  const std::size_t n = hole.rim.size(), place = longest_edge(mesh, hole);
  const Index a = hole.rim[place], b = hole.rim[(place + 1) % n], middle = mesh.vertices.rows();
  vertices.resize(middle + 1, 3);
  vertices << Points(mesh.vertices), 0.5 * (mesh.vertices.row(a) + mesh.vertices.row(b));
  for (Index f = 0; f < mesh.faces.size(); ++f) {
    std::vector<Index> face(mesh.faces[f].begin(), mesh.faces[f].end());
    for (std::size_t k = 0; k < face.size(); ++k) {
      const Index from = face[k], to = face[(k + 1) % face.size()];
      if ((from == a && to == b) || (from == b && to == a)) {
        face.insert(face.begin() + static_cast<Index>(k) + 1, middle);
        break;
      }
    }
    faces.add(face);
  }
  result.split_edges.push_back({a, b});
  result.split_t.push_back(0.5);
  Hole split = hole;
  split.rim.insert(split.rim.begin() + static_cast<Index>(place) + 1, middle);
  for (Index& corner : split.corners) corner += corner > static_cast<Index>(place);
  return split;
}

}  // namespace

CageFill fill_with_cage(const Mesh& mesh, const Hole& hole, const Subdivision& settings, const std::vector<Index>& replaced,
                        const LayoutOptions& layout_options, const CageOptions& options,
                        const std::function<SurfacePtr(const Sides&)>& build) {
  CageFill result;
  Points split_vertices;
  Faces split_faces;
  const bool split = hole.rim.size() % 2 == 1 && layout_options.split_odd;
  const Hole rim = split ? split_mesh(mesh, hole, split_vertices, split_faces, result) : hole;
  const Points& vertices = split ? split_vertices : (split_vertices = mesh.vertices);
  const Mesh cage = {vertices, split ? split_faces : mesh.faces};

  std::array<std::vector<double>, 3> parameters;
  for (int i = 0; i < 3; ++i) {
    const std::size_t edges = rim.side(i).size() - 1;
    for (std::size_t k = 0; k <= edges; ++k) parameters[i].push_back(static_cast<double>(k) / static_cast<double>(edges));
  }
  Points rim_points(static_cast<Index>(rim.rim.size()), 3);
  for (std::size_t k = 0; k < rim.rim.size(); ++k) rim_points.row(static_cast<Index>(k)) = vertices.row(rim.rim[k]);
  const double tolerance = layout_options.tolerance.value_or(1e-3 * diameter(rim_points));

  QuadLayout layout;
  CageFit fit;
  const int first = layout_options.rows.value_or(0), last = layout_options.rows.value_or(4);
  for (int rows = first; rows <= last; ++rows) {
    layout = quad_layout(parameters, rows, layout_options.pole_offset);
    fit = fit_cage(cage, rim, settings, replaced, layout.barycentric, layout.faces, build, options, fit);
    if (fit.deviation_max <= tolerance) break;
  }
  Report& report = result.report;
  if (!layout_options.rows && fit.deviation_max > tolerance) report.warnings.push_back(too_few_rows);

  const Index inside = fit.vertices.rows(), around = layout.rim, n = mesh.vertices.rows();
  result.patch = fit.patch;
  result.sides = fit.sides;
  result.vertices.resize(inside + split, 3);  // a split edge's vertex comes first
  result.barycentric.resize(inside + split, 3);
  std::vector<Index> index(layout.barycentric.rows());
  Index on_rim = 0;
  result.rim_barycentric.resize(static_cast<Index>(hole.rim.size()), 3);
  for (Index k = 0; k < around; ++k) {
    index[k] = rim.rim[k];
    if (split && rim.rim[k] == n) {
      result.vertices.row(0) = vertices.row(n);
      result.barycentric.row(0) = layout.barycentric.row(k);
    } else {
      result.rim_barycentric.row(on_rim++) = layout.barycentric.row(k);
    }
  }
  for (Index k = 0; k < inside; ++k) index[around + k] = n + split + k;
  result.vertices.bottomRows(inside) = fit.vertices;
  result.barycentric.bottomRows(inside) = layout.barycentric.bottomRows(inside);
  for (Index f = 0; f < layout.faces.size(); ++f) {
    std::vector<Index> face;
    for (Index v : layout.faces[f]) face.push_back(index[v]);
    result.faces.add(face);
  }
  for (std::size_t k = 0; k < fit.moved.size(); ++k) {
    if (fit.moved[k] == n && split) {
      result.vertices.row(0) = fit.moved_to.row(static_cast<Index>(k));
    } else {
      result.moved.push_back(fit.moved[k]);
    }
  }
  result.moved_to.resize(static_cast<Index>(result.moved.size()), 3);
  for (std::size_t k = 0, row = 0; k < fit.moved.size(); ++k)
    if (!(fit.moved[k] == n && split)) result.moved_to.row(static_cast<Index>(row++)) = fit.moved_to.row(static_cast<Index>(k));
  result.creases = fit.creases;

  report.cage_deviation_max = fit.deviation_max;
  report.cage_deviation_rms = fit.deviation_rms;
  report.surroundings_moved_max = fit.surroundings_max;
  report.surroundings_moved_rms = fit.surroundings_rms;
  report.surroundings_moved_where = fit.surroundings_where;
  report.corners_moved_max = fit.corners_moved;
  std::vector<double> all;
  double squares = 0;
  for (int i = 0; i < 3; ++i) {
    double sum = 0;
    const std::vector<double>& angles = fit.seam_angles[i];
    const std::size_t edges = parameters[i].size() - 1, per = angles.size() / edges, before = all.size();
    for (std::size_t k = 0; k < angles.size(); ++k) {
      if (angles[k] < 0) continue;
      report.seam_angle_max_by_side[i] = std::max(report.seam_angle_max_by_side[i], angles[k]);
      if (k >= per && k < (edges - 1) * per) report.seam_angle_max_inside = std::max(report.seam_angle_max_inside, angles[k]);
      sum += angles[k] * angles[k];
      all.push_back(angles[k]);
    }
    squares += sum;
    report.seam_angle_rms_by_side[i] = std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, all.size() - before)));
    report.seam_angle_max = std::max(report.seam_angle_max, report.seam_angle_max_by_side[i]);
  }
  if (!all.empty()) {
    report.seam_angle_rms = std::sqrt(squares / static_cast<double>(all.size()));
    std::nth_element(all.begin(), all.begin() + static_cast<Index>(all.size() / 2), all.end());
    report.seam_angle_median = all[all.size() / 2];
  }
  for (Index pole : layout.poles) {
    Index valence = 0;
    for (Index v : layout.faces.corners) valence += v == pole;
    report.poles.push_back({index[pole], valence});
    if (valence > 5)
      report.warnings.push_back("Pole of valence " + std::to_string(valence) + " at new vertex " +
                                std::to_string(index[pole] - n));
  }
  return result;
}

}  // namespace tripatch
