// The numbers that a user is shown: how well the fill meets its surroundings, from exact derivatives by atan2.
#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "tripatch/boundary/side.h"
#include "tripatch/choices.h"
#include "tripatch/mesh/connectivity.h"
#include "tripatch/messages.h"
#include "tripatch/patch/surface.h"

namespace tripatch {

struct AdjacentFace;

/// What fills of one hole are compared by, in this order; less is better.
struct Quality {
  bool crosses = false;              ///< itself
  Index folds = 0;                   ///< folded edges beyond those that the boundary forces
  bool exceeds_hole_bounds = false;  ///< farther from the boundary than its diameter
  double expected_error = 0;         ///< how far off the new vertices are expected to be, scene units; NaN: not known
  double seam_deg = 0;               ///< largest seam angle: reported, not compared; NaN: not measured
};

enum class CandidateStatus { used, made, skipped, refused };

/// One way to fill a hole, and what became of it.
struct FillCandidate {
  std::string method;
  CandidateStatus status = CandidateStatus::skipped;
  Quality quality;  ///< of fills that were made
  Reason why;
};

/// What a fill keeps along a side. unknown: not measured; none: the patch misses its boundary.
enum class SeamContinuity { unknown, none, free, g0, g1, g2 };
template <>
inline constexpr std::array<Choice, 6> choices<SeamContinuity> = {
    {{"", "", ""}, {"none", "", ""}, {"Free", "", ""}, {"G0", "", ""}, {"G1", "", ""}, {"G2", "", ""}}};

/// Whether a side is met in position only: nothing of the surroundings is continued.
constexpr bool in_position(SeamContinuity c) { return c == SeamContinuity::free || c == SeamContinuity::g0; }

/// Of a patch that is tangent to its sides where nothing else is asked for.
constexpr SeamContinuity kept_by(SideContinuity asked) {
  switch (asked) {
    case SideContinuity::free: return SeamContinuity::free;
    case SideContinuity::g0: return SeamContinuity::g0;
    case SideContinuity::g2: return SeamContinuity::g2;
    default: return SeamContinuity::g1;
  }
}

struct Report {
  double seam_angle_max = 0;  ///< degrees, fill against the surroundings used
  double seam_angle_rms = 0;
  std::vector<double> seam_angle_max_by_side = {0, 0, 0};
  std::vector<double> seam_angle_rms_by_side = {0, 0, 0};
  std::vector<SeamContinuity> continuity =
      std::vector(3, SeamContinuity::unknown);  ///< by side, what was asked or what auto took
  double boundary_gap = 0;                      ///< largest distance of the patch from its boundary, scene units
  std::vector<double> corner_planes_angle;    ///< by corner, degrees: between the tangent planes of the two sides that meet there
  std::vector<double> corner_normals_spread;  ///< by corner, degrees: the largest angle between normals of the patch around it
  double surroundings_error = 0;              ///< degrees; 0 where the surroundings are known exactly
  std::string fairing;                        ///< name of the energy that was made small, empty: none
  double energy_before = 0;                   ///< of that energy, or of the one that was asked for where none serves
  double energy_after = 0;
  /// The optimiser's path where lambda of a Szilvasi-Nagy method was to be optimal: (lambda, thin-plate energy), the last was taken.
  std::vector<std::pair<std::array<double, 3>, double>> shape_path;
  std::string method;                     ///< name of the method used
  Reason method_reason;                   ///< and why it was
  std::vector<FillCandidate> candidates;  ///< the one that is used, then, of method auto and of cages, the others
  std::optional<double> deviation_max;    ///< largest of Fill::deviation, scene units; none: unknown
  /// Edges of the new faces that are folded, those of the rim over the faces beyond it too; of a cage those of its limit surface.
  Index triangles_folded = 0;
  /// The same of the rim's own triangulation, and of faces beyond that are turned over: such a rim leaves no other way.
  Index rim_folded = 0;
  Index folds = 0;             ///< of the patch, see FoldCounter
  std::vector<Index> corners;  ///< vertex indices: three, or those given for a rim of any number
  // Cages, scene units. Their seam angles are those between the limit surfaces on both sides of the rim.
  double cage_deviation_max = 0;  ///< fill's limit surface to the patch that it is fitted to; 0: to none
  double cage_deviation_rms = 0;
  double surroundings_moved_max = 0;  ///< the old limit surface within the first two rings
  double surroundings_moved_rms = 0;
  Index surroundings_moved_where = -1;  ///< a vertex of the face that moved most
  double corners_moved_max = 0;         ///< the limit at the three corners
  double seam_angle_median = 0;
  double seam_angle_max_inside = 0;  ///< without the rim edges that touch a corner
  int rows = 0;                      ///< quads and cages: extra rows of quads round the poles that were taken
  bool cage_in_rows = false;         ///< cages: the rows of quads around the hole continue across it
  bool crosses_itself = false;  ///< new faces go through each other (report/crossings.h); of a cage those of its limit surface
  std::vector<std::array<Index, 2>> poles;  ///< vertex, valence
  Messages warnings;
  std::map<std::string, std::string>
      not_applied;  ///< options that mean nothing for the fill, and why: see not_applied in options.h
  double seconds = 0;
};

/// What speaks against a fill where there is another: that it crosses itself, then its folded edges.
inline std::pair<bool, Index> harm(const Report& report) { return {report.crosses_itself, report.triangles_folded}; }
inline bool is_harmless(const Report& report) { return harm(report) == std::pair(false, Index{0}); }
/// Whether a fill is not what was asked for: it folds where its rim leaves another way, crosses itself or misses its boundary.
inline bool is_flawed(const Report& report) {
  return report.triangles_folded > report.rim_folded || report.crosses_itself ||
         std::ranges::count(report.continuity, SeamContinuity::none) > 0;
}

/// Takes the corners, places in the rim.
void take_corners(const std::vector<Index>& rim, std::span<const Index> corners, Report& report);
/// Tells of corners whose two sides are met tangentially though their planes differ by a degree or more: no patch has both.
void tell_corners(Report& report);
/// Tells of a patch of this size that misses its boundary by more than sides may be apart, and takes back that it has any continuity there.
void tell_gap(double size, Report& report);
/// What speaks against the faces that are delivered: vertices beyond those of the mesh are rows of `added`. border: of triangles which
/// are known to make a disc, its vertices as they go along it.
void measure_faces(const Mesh& mesh, const PointsRef& added, const Faces& faces, std::span<const AdjacentFace> beyond,
                   Report& report, std::vector<Index> border = {});
/// Where faces so measured go through each other; none: nowhere.
std::optional<Vec3> place_of_crossing(const Mesh& mesh, const PointsRef& added, const Faces& faces);
/// The vertex of a rim that is nearest to a place.
Index nearest_of(const PointsRef& vertices, const std::vector<Index>& rim, const Vec3& where);
/// Tells of faces that go through each other, and near which vertex of the rim.
void tell_crossing(const PointsRef& vertices, const std::vector<Index>& rim, const Vec3& where, Report& report, Code what);
/// Tells of faces beyond the rim that are turned over, and where one is; of those of a convex body nothing, which are only sharp.
void tell_turned_over(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim, Report& report);
/// Tells of a patch that folds.
void tell_folds(Report& report);

/// Seam angles of a patch over the triangle, `samples` points a side, ends included where the two planes of the corner agree to 1e-6 degrees,
/// else outside 1% of the side; its distance from the sides; its corners.
void measure_seam(const Surface& patch, const Sides& sides, Report& report, int samples = 200);
/// The same against surfaces over the triangle, surface i along side i.
void measure_seam(const Surface& patch, const std::array<SurfacePtr, 3>& surfaces, Report& report, int samples = 200);

}  // namespace tripatch
