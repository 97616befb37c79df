#include "tripatch/annulus/annulus_fill.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tripatch/annulus/annulus_layout.h"
#include "tripatch/annulus/closed_side.h"
#include "tripatch/math/canonical_start.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/output/doubled_edges.h"
#include "tripatch/report/folded_triangles.h"
#include "tripatch/spline/plane_patch.h"

namespace tripatch {
namespace {

/// Degrees that ribs turn in one ring of faces at most, or a fillet would be a chamfer.
constexpr double turn_of_ring = angle::corner;
/// Rings of faces, at most: a bound against boundaries far apart whose edges are short.
constexpr int max_rings_of_faces = 400;

/// A closed boundary with t of its vertices, in its order.
struct ReadBoundary {
  ClosedSide known;
  std::vector<double> t;
  double edge = 0;  ///< mean length
};

ReadBoundary read_boundary(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& loop) {
  const Index n = static_cast<Index>(loop.size());
  const auto [first, backwards] = beginning_of_closed(mesh, around, loop);
  std::vector<Index> own = loop;
  std::rotate(own.begin(), own.begin() + first, own.end());
  ReadBoundary out{closed_side(mesh, around, own, backwards), {}, 0};
  mend_planes(out.known);
  for (Index k = 0; k < n; ++k) {
    out.t.push_back(out.known.t[static_cast<std::size_t>((k - first + n) % n)]);
    out.edge += (mesh.vertices.row(loop[(k + 1) % n]) - mesh.vertices.row(loop[k])).norm() / static_cast<double>(n);
  }
  return out;
}

/// Rings of faces as wide as the edges along them are long.
int square_rings(const AnnulusPatch& made, double edge) {
  const double by_length = std::round(made.rib_length / edge),
               by_turn = std::ceil(made.rib_turn / turn_of_ring - tolerance::same);
  return static_cast<int>(std::clamp(std::max(by_length, by_turn), 1.0, static_cast<double>(max_rings_of_faces)));
}

/// Without extra rows of quads.
int rings_of(const AnnulusPatch& made, double edge, bool uneven, const FillOptions& options) {
  if (options.output == Output::quads) return std::max(square_rings(made, edge), uneven ? 2 : 1);
  return std::min(options.resolution.value_or(square_rings(made, edge)), max_rings_of_faces);
}

/// Triangles of faces that begin at their shorter diagonals.
Faces halved(const Faces& faces) {
  Faces halves;
  for (Index f = 0; f < faces.size(); ++f)
    for (std::size_t k = 2; k < faces[f].size(); ++k) halves.add(std::array{faces[f][0], faces[f][k - 1], faces[f][k]});
  return halves;
}

/// Faces of a layout by vertices of a mesh with so many, halved where triangles are asked for.
Faces faces_in_mesh(const Mesh& mesh, const AnnulusLayout& layout, const Fill& fill, bool quads) {
  const Index r = static_cast<Index>(fill.rim.size()), n = mesh.vertices.rows();
  Faces faces = layout.faces;
  for (Index& v : faces.corners) v = v < r ? fill.rim[static_cast<std::size_t>(v)] : n + v - r;
  if (quads) return faces;
  begin_at_shorter_diagonals(mesh.vertices, fill.vertices, faces);
  return halved(faces);
}

}  // namespace

void report_patch(const AnnulusPatch& made, Report& report) {
  report.method = annulus_method;
  report.continuity = {made.continuity[0], made.continuity[1]};
  report.seam_angle_max_by_side = {made.seam_angle_max[0], made.seam_angle_max[1]};
  report.seam_angle_rms_by_side = {made.seam_angle_rms[0], made.seam_angle_rms[1]};
  report.seam_angle_max = std::max(made.seam_angle_max[0], made.seam_angle_max[1]);
  report.seam_angle_rms = std::hypot(made.seam_angle_rms[0], made.seam_angle_rms[1]) / std::sqrt(2.0);
}

AnnulusTriangles triangulate_annulus(const OverAnnulus& ring, const std::vector<double>& first, const std::vector<double>& second,
                                     std::optional<int> rings) {
  const AnnulusPatch& made = ring.made();
  std::vector<double> of_second;
  for (const double t : second) of_second.push_back(made.u_of_second(t));
  double edge = 0;
  for (const int side : {0, 1}) {
    const std::vector<double>& t = side == 0 ? first : second;
    if (t.size() < 3) throw InvalidArgument("a closed side has three edges or more");
    edge += length_around(Points(ring.positions(as_rows(ring.on_side(side, t))))) / static_cast<double>(2 * t.size());
  }
  AnnulusLayout layout = annulus_layout(first, of_second, rings.value_or(square_rings(made, edge)), false);
  AnnulusTriangles out;
  out.uv.resize(layout.uv.rows(), 2);
  for (Index k = 0; k < out.uv.rows(); ++k) out.uv.row(k) = made.patch->place(layout.uv(k, 0), layout.uv(k, 1));
  begin_at_shorter_diagonals(ring.positions(as_rows(out.uv)), Points(0, 3), layout.faces);
  out.faces = halved(layout.faces);
  return out;
}

Fill fill_with_annulus(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim,
                       const std::vector<Index>& island, const FillOptions& options) {
  const ReadBoundary first = read_boundary(mesh, around, rim), second = read_boundary(mesh, around, island);
  check_count(options.continuity, 2, "continuity");
  const std::vector<SideContinuity> continuity = options.continuity.values();
  const AnnulusPatch made = annulus_patch(first.known.side, second.known.side, {{continuity.front(), continuity.back()}, {1, 1}});
  std::vector<double> of_island;
  for (const double t : second.t) of_island.push_back(made.u_of_second(t));
  Fill fill;
  fill.rim = rim;
  fill.rim.insert(fill.rim.end(), island.begin(), island.end());
  fill.patch = made.patch;
  const bool quads = options.output == Output::quads, uneven = rim.size() + 1 < island.size() || island.size() + 1 < rim.size();
  const int least = rings_of(made, (first.edge + second.edge) / 2, uneven, options);
  int rings = std::min(least + (quads ? options.resolution.value_or(0) : 0), max_rings_of_faces);
  AnnulusLayout layout;
  for (;; ++rings) {
    layout = annulus_layout(first.t, of_island, rings, quads);
    PlanePoints places(layout.uv.rows(), 2);
    for (Index k = 0; k < places.rows(); ++k) places.row(k) = made.patch->place(layout.uv(k, 0), layout.uv(k, 1));
    fill.rim_uv = places.topRows(static_cast<Index>(fill.rim.size()));
    fill.uv = places.bottomRows(places.rows() - fill.rim_uv.rows());
    std::tie(fill.vertices, fill.normals) = made.patch->positions_and_normals(as_rows(fill.uv));
    fill.faces = faces_in_mesh(mesh, layout, fill, quads);
    if (rings > 1 || !doubles_edges_of_mesh(around, fill.rim, fill.faces)) break;  // two boundaries that an edge joins
  }
  fill.rim_normals = made.patch->normals(as_rows(fill.rim_uv));
  fill.patch = std::make_shared<PlanePatch>(made.patch, fill.rim_uv);
  fill.sides = {first.known.side, second.known.side};
  report_patch(made, fill.report);
  fill.report.surroundings_error = std::max(first.known.surroundings_error, second.known.surroundings_error);
  fill.report.rows = rings - least;
  for (const Index pole : quads ? layout.poles : std::vector<Index>())
    fill.report.poles.push_back({mesh.vertices.rows() + pole - fill.rim_uv.rows(),
                                 std::count(layout.faces.corners.begin(), layout.faces.corners.end(), pole)});
  measure_faces(mesh, fill.vertices, fill.faces, faces_beyond(mesh, around, {rim, island}), fill.report);
  return fill;
}

}  // namespace tripatch
