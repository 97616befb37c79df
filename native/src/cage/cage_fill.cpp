#include "tripatch/cage/cage_fill.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "tripatch/output/quad_layout.h"
#include "tripatch/output/triangulate.h"

namespace tripatch {
namespace {

/// The mesh with the longest edge of each odd rim split, the holes in it and its creases.
struct Split {
  Points vertices;
  Faces faces;
  std::vector<Hole> holes;
  std::vector<Index> middle;  ///< of each hole; -1: none
  Subdivision settings;
  Mesh mesh() const { return {vertices, faces}; }
};

Split split_odd(const Mesh& mesh, const std::vector<CageRequest>& requests, const Subdivision& settings, bool wanted,
                std::vector<CageFill>& results) {
  Split split{mesh.vertices, mesh.faces, {}, {}, settings};
  std::vector<Vec3> added;
  for (std::size_t h = 0; h < requests.size(); ++h) {
    Hole hole = requests[h].hole;
    split.middle.push_back(-1);
    if (wanted && hole.rim.size() % 2 == 1) {
      const std::size_t place = longest_edge(mesh, hole);
      const Index a = hole.rim[place], b = hole.rim[(place + 1) % hole.rim.size()];
      const Index middle = split.middle[h] = mesh.vertices.rows() + static_cast<Index>(added.size());
      added.push_back(0.5 * (mesh.vertices.row(a) + mesh.vertices.row(b)));
      Faces faces;
      for (Index f = 0; f < split.faces.size(); ++f) {
        std::vector<Index> face(split.faces[f].begin(), split.faces[f].end());
        for (std::size_t k = 0; k < face.size(); ++k)
          if (std::minmax(face[k], face[(k + 1) % face.size()]) == std::minmax(a, b)) {
            face.insert(face.begin() + static_cast<Index>(k) + 1, middle);
            break;
          }
        faces.add(face);
      }
      split.faces = std::move(faces);
      for (std::size_t k = 0; k < settings.crease_edges.size(); ++k) {
        const auto [c, d] = settings.crease_edges[k];
        if (std::minmax(a, b) != std::minmax(c, d)) continue;
        split.settings.crease_edges[k] = {a, middle};
        split.settings.crease_edges.push_back({middle, b});
        split.settings.edge_creases.push_back(settings.edge_creases[k]);
      }
      results[h].split_edges.push_back({a, b});
      results[h].split_t.push_back(0.5);
      hole.rim.insert(hole.rim.begin() + static_cast<Index>(place) + 1, middle);
      for (Index& corner : hole.corners) corner += corner > static_cast<Index>(place);
    }
    split.holes.push_back(std::move(hole));
  }
  const Index n = mesh.vertices.rows();
  split.vertices.conservativeResize(n + static_cast<Index>(added.size()), 3);
  for (std::size_t k = 0; k < added.size(); ++k) split.vertices.row(n + static_cast<Index>(k)) = added[k];
  return split;
}

/// Each edge of the rim takes an equal share of its side, as it does of the limit rim.
std::array<std::vector<double>, 3> even_parameters(const Hole& hole) {
  std::array<std::vector<double>, 3> parameters;
  for (int i = 0; i < 3; ++i) {
    const std::size_t edges = hole.side(i).size() - 1;
    for (std::size_t k = 0; k <= edges; ++k) parameters[i].push_back(static_cast<double>(k) / static_cast<double>(edges));
  }
  return parameters;
}

/// Triangles that match the rim: the regular split where its counts are equal.
QuadLayout triangle_layout(const Hole& hole, const Points& vertices) {
  Eigen::Matrix3d corners;
  for (int k = 0; k < 3; ++k) corners.row(k) = vertices.row(hole.rim[hole.corners[k]]);
  TriangleMesh triangles =
      triangulate(even_parameters(hole), std::nullopt, [&](const PointsRef& b) { return Points(b * corners); });
  QuadLayout layout;
  layout.barycentric = std::move(triangles.barycentric);
  layout.rim = triangles.rim;
  std::vector<Index> valence(layout.barycentric.rows(), 0);
  for (const std::array<Index, 3>& triangle : triangles.triangles) {
    layout.faces.add(triangle);
    for (Index v : triangle) ++valence[v];
  }
  for (Index v = layout.rim; v < layout.barycentric.rows(); ++v)
    if (valence[v] != 6) layout.poles.push_back(v);
  return layout;
}

void write_seam(const CageFit& fit, const Hole& hole, Report& report) {
  std::vector<double> all;
  double squares = 0;
  for (int i = 0; i < 3; ++i) {
    double sum = 0;
    const std::vector<double>& angles = fit.seam_angles[i];
    const std::size_t edges = hole.side(i).size() - 1, per = angles.size() / edges, before = all.size();
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
  if (all.empty()) return;
  report.seam_angle_rms = std::sqrt(squares / static_cast<double>(all.size()));
  std::nth_element(all.begin(), all.begin() + static_cast<Index>(all.size() / 2), all.end());
  report.seam_angle_median = all[all.size() / 2];
}

/// For each vertex of the rims the border edges of the mesh without the replaced faces; two where one border passes.
std::map<Index, int> border_edges(const Mesh& mesh, const std::vector<CageRequest>& requests,
                                  const std::vector<Index>& replaced) {
  std::vector<char> on_rim(mesh.vertices.rows(), 0), gone(mesh.faces.size(), 0);
  for (const CageRequest& request : requests)
    for (Index v : request.hole.rim) on_rim[v] = 1;
  for (Index f : replaced) gone[f] = 1;
  std::map<std::pair<Index, Index>, int> uses;
  for (Index f = 0; f < mesh.faces.size(); ++f) {
    const auto face = mesh.faces[f];
    for (std::size_t k = 0; !gone[f] && k < face.size(); ++k) {
      const Index a = face[k], b = face[(k + 1) % face.size()];
      if (on_rim[a] || on_rim[b]) ++uses[std::minmax(a, b)];
    }
  }
  std::map<Index, int> count;
  for (const auto& [edge, faces] : uses)
    if (faces == 1) {
      ++count[edge.first];
      ++count[edge.second];
    }
  return count;
}

/// The fill in the numbering of the mesh as it was given: n .. are its own vertices, that of a split edge first.
void write(Index n, Index middle, const Hole& hole, const Points& vertices, const QuadLayout& layout, CageFit fit,
           CageFill& result) {
  const bool split = middle >= 0;
  const Index inside = fit.vertices.rows(), around = layout.rim;
  result.vertices.resize(inside + split, 3);
  result.barycentric.resize(inside + split, 3);
  result.rim_barycentric.resize(around - split, 3);
  std::vector<Index> index(layout.barycentric.rows());
  Index on_rim = 0;
  for (Index k = 0; k < around; ++k) {
    index[k] = hole.rim[k];
    if (split && hole.rim[k] == middle) {
      index[k] = n;
      result.vertices.row(0) = vertices.row(middle);
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
  std::vector<Vec3> moved_to;
  for (std::size_t k = 0; k < fit.moved.size(); ++k) {
    if (split && fit.moved[k] == middle) {
      result.vertices.row(0) = fit.moved_to.row(static_cast<Index>(k));
    } else {
      result.moved.push_back(fit.moved[k]);
      moved_to.push_back(fit.moved_to.row(static_cast<Index>(k)));
    }
  }
  result.moved_to.resize(static_cast<Index>(moved_to.size()), 3);
  for (std::size_t k = 0; k < moved_to.size(); ++k) result.moved_to.row(static_cast<Index>(k)) = moved_to[k];
  for (auto [a, b] : fit.creases) result.creases.push_back({a == middle ? n : a, b == middle ? n : b});

  Report& report = result.report;
  report.cage_deviation_max = fit.deviation_max;
  report.cage_deviation_rms = fit.deviation_rms;
  report.surroundings_moved_max = fit.surroundings_max;
  report.surroundings_moved_rms = fit.surroundings_rms;
  report.surroundings_moved_where = fit.surroundings_where;
  report.corners_moved_max = fit.corners_moved;
  report.triangles_folded = fit.triangles_folded;
  if (fit.fair_before > 0) {
    report.fairing = "minimum_variation";
    report.energy_before = fit.fair_before;
    report.energy_after = fit.fair_after;
  }
  write_seam(fit, hole, report);
  for (Index pole : layout.poles) {
    Index valence = 0;
    for (Index v : layout.faces.corners) valence += v == pole;
    report.poles.push_back({index[pole], valence});
    if (valence > (layout.faces[0].size() == 3 ? 7 : 5))
      report.warnings.push_back("Pole of valence " + std::to_string(valence) + " at new vertex " +
                                std::to_string(index[pole] - n));
  }
  result.patch = std::move(fit.patch);
  result.sides = std::move(fit.sides);
}

}  // namespace

std::vector<CageFill> fill_with_cages(const Mesh& mesh, const std::vector<CageRequest>& requests, const Subdivision& settings,
                                      const std::vector<Index>& replaced, const LayoutOptions& layout_options,
                                      const CageOptions& options) {
  if (settings.loop && layout_options.rows.value_or(0) > 0)
    throw InvalidArgument("a cage of triangles follows the rim: resolution must be 0 or none");
  const std::size_t count = requests.size();
  std::vector<CageFill> results(count);
  const Split split = split_odd(mesh, requests, settings, layout_options.split_odd && !settings.loop, results);
  std::vector<CageHole> holes(count);
  std::vector<QuadLayout> layouts(count);
  std::vector<double> tolerance(count);
  for (std::size_t h = 0; h < count; ++h) {
    holes[h].hole = split.holes[h];
    holes[h].build = requests[h].build;
    Points rim(static_cast<Index>(holes[h].hole.rim.size()), 3);
    for (Index k = 0; k < rim.rows(); ++k) rim.row(k) = split.vertices.row(holes[h].hole.rim[k]);
    tolerance[h] = layout_options.tolerance.value_or(1e-3 * diameter(rim));
  }
  std::vector<CageFit> fits;
  std::vector<char> open(count, 1);  ///< asks for another layout
  // But for an exact rim quads as large as those around come first: only with them do the lines of the surroundings run on, as a
  // fair cage needs them.
  const int last = settings.loop ? 0 : layout_options.rows.value_or(4);
  for (int rows = options.rim != CageRim::exact || !layout_options.rows ? 0 : last; rows <= last;
       rows = layout_options.rows ? std::max(last, rows + 1) : rows + 1) {
    for (std::size_t h = 0; h < count; ++h) {
      if (!open[h]) continue;
      layouts[h] = settings.loop ? triangle_layout(holes[h].hole, split.vertices)
                                 : quad_layout(even_parameters(holes[h].hole), rows, layout_options.pole_offset);
      holes[h].barycentric = layouts[h].barycentric;
      holes[h].layout = layouts[h].faces;
    }
    fits = fit_cages(split.mesh(), holes, split.settings, replaced, options, fits);
    for (std::size_t h = 0; h < count; ++h) open[h] = layout_options.rows || fits[h].deviation_rms > tolerance[h];
    if (std::find(open.begin(), open.end(), 1) == open.end()) break;
  }
  const std::map<Index, int> border = border_edges(mesh, requests, replaced);
  for (std::size_t h = 0; h < count; ++h) {
    write(mesh.vertices.rows(), split.middle[h], holes[h].hole, split.vertices, layouts[h], std::move(fits[h]), results[h]);
    for (Index v : requests[h].hole.rim)
      if (const auto edges = border.find(v); edges != border.end() && edges->second > 2)
        results[h].report.warnings.push_back(std::string("Another border touches the rim at vertex ") + std::to_string(v) +
                                             ": the limit surface is sharp there");
    if (!layout_options.rows && !settings.loop && open[h]) results[h].report.warnings.push_back(too_few_rows);
  }
  return results;
}

}  // namespace tripatch
