#include "tripatch/report/report.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "tripatch/math/angle.h"
#include "tripatch/math/ties.h"
#include "tripatch/patch/seam.h"
#include "tripatch/report/crossings.h"
#include "tripatch/report/folded_triangles.h"
#include "tripatch/report/one_to_one.h"

namespace tripatch {
namespace {

/// Degrees between the tangent planes of two sides at their corner from which on a person is told.
constexpr double corner_mismatch_warned = 1;
/// Degrees: from here on a sentence has three digits instead of two, for 99.6 of two are 1e+02.
constexpr double three_digits = 99.5;

std::string degrees(double angle) {
  std::ostringstream text;
  text.precision(angle < three_digits ? 2 : 3);
  text << angle << " degrees";
  return text.str();
}

}  // namespace

void report_corners(const std::vector<Index>& rim, std::span<const Index> corners, const std::vector<double>& mismatch_deg,
                    Report& report) {
  report.corners.clear();
  for (Index place : corners) report.corners.push_back(rim[place]);
  for (std::size_t k = 0; k < mismatch_deg.size(); ++k)
    if (mismatch_deg[k] > corner_mismatch_warned)
      report.warnings.push_back("The tangent planes of the two sides differ by " + degrees(mismatch_deg[k]) + " at corner " +
                                std::to_string(k) + " (vertex " + std::to_string(report.corners[k]) + ")");
}

Index nearest_of(const PointsRef& vertices, const std::vector<Index>& rim, const Vec3& where) {
  const auto far = [&](Index v) { return (Vec3(vertices.row(v)) - where).squaredNorm(); };
  return *std::min_element(rim.begin(), rim.end(), [&](Index a, Index b) { return clearly_less(far(a), far(b)); });
}

void tell_crossing(const PointsRef& vertices, const std::vector<Index>& rim, const Vec3& where, Report& report,
                   const std::string& what) {
  report.warnings.push_back(what + " near vertex " + std::to_string(nearest_of(vertices, rim, where)) + " of the rim");
}

void tell_turned_over(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim, Report& report) {
  std::vector<char> turned = turned_over(mesh, around, {rim});
  for (std::size_t k = 0; k < rim.size(); ++k)
    if (turned[k] && is_of_convex_body(mesh, around, around.face(*around.edge(rim[(k + 1) % rim.size()], rim[k])))) turned[k] = 0;
  const std::ptrdiff_t count = std::ranges::count(turned, 1), first = std::ranges::find(turned, 1) - turned.begin();
  if (count == 0) return;
  const std::string from = std::to_string(rim[first]), to = std::to_string(rim[(first + 1) % rim.size()]);
  const std::string where = "the edge between vertices " + from + " and " + to;
  report.warnings.push_back((count == 1 ? "The face beside the rim at " + where +
                                              " is folded over those around it: the fill goes on as those do, and "
                                              "folds there too. Delete or smooth it first"
                                        : std::to_string(count) + " faces beside the rim, one at " + where +
                                              ", are folded over those around them: the "
                                              "fill goes on as those do, and folds there too. Delete or smooth them first"));
}

void tell_folds(Report& report) {
  if (report.folds > 0)
    report.warnings.push_back("The patch folds over itself at " + std::to_string(report.folds) +
                              (report.folds == 1 ? " place" : " places"));
}

void measure_faces(const Mesh& mesh, const PointsRef& added, const Faces& faces, std::span<const FaceBeyond> beyond,
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

void measure_seam(const Surface& patch, const Sides& sides, Report& report, int samples) {
  std::array<bool, 3> clear;  // corner: one tangent plane for both sides
  for (int k = 0; k < 3; ++k)
    clear[k] = degrees_between(sides[(k + 1) % 3].normal(1), sides[(k + 2) % 3].normal(0)) <= same_plane;

  double sum = 0;
  Index count = 0;
  report.seam_angle_max = 0;
  for (int i = 0; i < 3; ++i) {
    const double first = clear[(i + 1) % 3] ? 0 : beside_corner, last = clear[(i + 2) % 3] ? 1 : 1 - beside_corner;
    Points b = Points::Zero(samples, 3);
    for (int k = 0; k < samples; ++k) {
      const double t = samples > 1 ? first + (last - first) * k / (samples - 1) : 0.5;
      b(k, (i + 1) % 3) = 1 - t;
      b(k, (i + 2) % 3) = t;
    }
    const Points normals = patch.normals(b);
    double largest = 0, squares = 0;
    Index used = 0;
    for (int k = 0; k < samples; ++k) {
      const Vec3 n = sides[i].normal(b(k, (i + 2) % 3));
      if (!(n.norm() > 0)) continue;  // the surroundings have no plane there
      // no plane of the fill: as bad as at a right angle
      const double a = normals.row(k).norm() > 0 ? degrees_between(normals.row(k), n) : 90;
      largest = std::max(largest, a);
      squares += a * a;
      ++used;
    }
    report.seam_angle_max_by_side[i] = largest;
    report.seam_angle_rms_by_side[i] = used ? std::sqrt(squares / static_cast<double>(used)) : 0;
    report.seam_angle_max = std::max(report.seam_angle_max, largest);
    sum += squares;
    count += used;
  }
  report.seam_angle_rms = count ? std::sqrt(sum / static_cast<double>(count)) : 0;
}

}  // namespace tripatch
