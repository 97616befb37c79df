#include "tripatch/report/report.h"

#include <algorithm>
#include <cmath>

#include "tripatch/math/angle.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/math/tolerant_compare.h"
#include "tripatch/patch/seam.h"
#include "tripatch/report/crossings.h"
#include "tripatch/report/folded_triangles.h"
#include "tripatch/report/one_to_one.h"

namespace tripatch {
namespace {

/// Degrees between the tangent planes of two sides at their corner from which on a user reads of it.
constexpr double corner_mismatch_warned = angle::flat;

/// Barycentric coordinates of side i at parameters t.
Points places_on_side(int i, const std::vector<double>& t) {
  Points b = Points::Zero(static_cast<Index>(t.size()), 3);
  for (Index k = 0; k < b.rows(); ++k) {
    b(k, (i + 1) % 3) = 1 - t[k];
    b(k, (i + 2) % 3) = t[k];
  }
  return b;
}

}  // namespace

void take_corners(const std::vector<Index>& rim, std::span<const Index> corners, Report& report) {
  report.corners.clear();
  for (Index place : corners) report.corners.push_back(rim[place]);
}

void tell_corners(Report& report) {
  const std::size_t n = report.corner_planes_angle.size();
  const auto tangential = [&](std::size_t side) { return !in_position(report.continuity[side % n]); };
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t after = n == 3 ? k + 2 : k, before = n == 3 ? k + 1 : k + n - 1;
    if (!(report.corner_planes_angle[k] > corner_mismatch_warned) || !tangential(after) || !tangential(before)) continue;
    const std::vector<Index> where = k < report.corners.size() ? std::vector<Index>{report.corners[k]} : std::vector<Index>();
    report.warnings.push_back(
        {Code::corner_planes_differ,
         {{"angle", report.corner_planes_angle[k]}, {"corner", k}, {"spread", report.corner_normals_spread[k]}},
         where});
  }
}

void tell_gap(double size, Report& report) {
  if (!(report.boundary_gap > tolerance::same * size)) return;
  report.continuity.assign(report.continuity.size(), SeamContinuity::none);
  report.warnings.push_back({Code::misses_boundary, {{"gap", report.boundary_gap}}});
}

Index nearest_of(const PointsRef& vertices, const std::vector<Index>& rim, const Vec3& where) {
  const auto far = [&](Index v) { return (Vec3(vertices.row(v)) - where).squaredNorm(); };
  return *std::min_element(rim.begin(), rim.end(), [&](Index a, Index b) { return clearly_less(far(a), far(b)); });
}

void tell_crossing(const PointsRef& vertices, const std::vector<Index>& rim, const Vec3& where, Report& report, Code what) {
  report.warnings.push_back({what, {}, {nearest_of(vertices, rim, where)}});
}

void tell_turned_over(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim, Report& report) {
  std::vector<char> turned = flipped(mesh, around, {rim});
  for (std::size_t k = 0; k < rim.size(); ++k)
    if (turned[k] && is_of_convex_body(mesh, around, around.face(*around.edge(rim[(k + 1) % rim.size()], rim[k])))) turned[k] = 0;
  const std::ptrdiff_t count = std::ranges::count(turned, 1), first = std::ranges::find(turned, 1) - turned.begin();
  if (count == 0) return;
  report.warnings.push_back({Code::faces_folded_beyond, {{"faces", count}}, {rim[first], rim[(first + 1) % rim.size()]}});
}

void tell_folds(Report& report) {
  if (report.folds > 0) report.warnings.push_back({Code::patch_folds, {{"places", report.folds}}});
}

void measure_faces(const Mesh& mesh, const PointsRef& added, const Faces& faces, std::span<const AdjacentFace> beyond,
                   Report& report, std::vector<Index> border) {
  if (!border.empty() && surely_unfolded(mesh.vertices, added, faces, beyond)) {
    std::rotate(border.begin(), std::min_element(border.begin(), border.end()), border.end());  // wherever the rim was begun
    report.triangles_folded = 0;
    report.crosses_itself = false;
    if (surely_one_to_one(mesh.vertices, added, faces, border)) return;
  }
  Faces with_quads;  // not a copy of millions of triangles
  for (Index f = 0; f < faces.size() && with_quads.size() == 0; ++f)
    if (faces[f].size() == 4) with_quads = faces;
  begin_at_shorter_diagonals(mesh.vertices, added, with_quads);
  const Faces& cut = with_quads.size() > 0 ? with_quads : faces;
  EdgesByVertex edges = edges_of_triangles(mesh.vertices.rows(), added.rows(), cut, beyond);
  report.triangles_folded = count_folded_edges(mesh.vertices, added, cut, beyond, edges);
  report.crosses_itself = !find_crossings(mesh.vertices, added, cut, edges, 1).empty();
}

std::optional<Vec3> place_of_crossing(const Mesh& mesh, const PointsRef& added, const Faces& faces) {
  Faces cut = faces;
  begin_at_shorter_diagonals(mesh.vertices, added, cut);
  const std::vector<Crossing> found = find_crossings(mesh.vertices, added, cut, 1);
  return found.empty() ? std::nullopt : std::optional(found[0].where);
}

namespace {

/// side(i, t): points and normals of side i at parameters t.
template <class AlongSide>
void measure(const Surface& patch, const AlongSide& side, Report& report, int samples) {
  report.corner_planes_angle.clear();
  report.corner_normals_spread.clear();
  for (int k = 0; k < 3; ++k) {
    const int before = (k + 1) % 3, after = (k + 2) % 3;
    report.corner_planes_angle.push_back(
        degrees_between(side(before, std::vector<double>{1}).second.row(0), side(after, std::vector<double>{0}).second.row(0)));
    report.corner_normals_spread.push_back(normals_spread(patch, places_on_side(before, {1 - tolerance::same}).row(0),
                                                          places_on_side(after, {tolerance::same}).row(0)));
  }
  double sum = 0;
  Index count = 0;
  report.seam_angle_max = report.boundary_gap = 0;
  for (int i = 0; i < 3; ++i) {
    const auto is_clear = [&](int k) { return report.corner_planes_angle[k % 3] <= tolerance::same; };
    const double first = is_clear(i + 1) ? 0 : beside_corner, last = is_clear(i + 2) ? 1 : 1 - beside_corner;
    std::vector<double> t;
    for (int k = 0; k < samples; ++k) t.push_back(samples > 1 ? first + (last - first) * k / (samples - 1) : 0.5);
    const auto [points, normals] = side(i, t);
    const SeamOfSide seam = seam_of(patch, places_on_side(i, t), points, normals);
    report.seam_angle_max_by_side[i] = seam.angle_max;
    report.seam_angle_rms_by_side[i] = seam.angle_rms;
    report.seam_angle_max = std::max(report.seam_angle_max, seam.angle_max);
    report.boundary_gap = std::max(report.boundary_gap, seam.gap);
    sum += seam.angle_rms * seam.angle_rms * static_cast<double>(seam.compared);
    count += seam.compared;
  }
  report.seam_angle_rms = count ? std::sqrt(sum / static_cast<double>(count)) : 0;
}

}  // namespace

void measure_seam(const Surface& patch, const Sides& sides, Report& report, int samples) {
  const auto along = [&](int i, const std::vector<double>& t) {
    std::pair<Points, Points> out(Points(t.size(), 3), Points(t.size(), 3));
    for (std::size_t k = 0; k < t.size(); ++k) {
      out.first.row(static_cast<Index>(k)) = sides[i].c(t[k]);
      out.second.row(static_cast<Index>(k)) = sides[i].normal(t[k]);
    }
    return out;
  };
  measure(patch, along, report, samples);
}

void measure_seam(const Surface& patch, const std::array<SurfacePtr, 3>& surfaces, Report& report, int samples) {
  const auto along = [&](int i, const std::vector<double>& t) {
    return surfaces[i]->positions_and_normals(places_on_side(i, t));
  };
  measure(patch, along, report, samples);
}

}  // namespace tripatch
