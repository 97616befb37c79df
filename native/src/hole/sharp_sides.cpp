#include "tripatch/hole/sharp_sides.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <queue>

#include "tripatch/hole/rim_shape.h"
#include "tripatch/math/angle.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/math/tolerant_compare.h"
#include "tripatch/mesh/vertex_normals.h"

namespace tripatch {
namespace {

/// Degrees between the plane next to a side and that of the rim at its corner up to which coarse and noisy meshes of smooth surfaces
/// come; the least angle of the real CAD faces with sharp neighbors is 30.
constexpr double surely_smooth = 20;
/// Of what direction and plane change from one edge to the next: carried on to the corner they are off by a quarter of that on circles.
constexpr double of_bend = share::half;
/// Of the tolerance: a side is off at both of its corners by more than that, and by more than the tolerance on average.
constexpr double min_share = share::quarter;
/// Degrees that direction and plane may change along a side of a single edge, at its half: a rounded corner of a box in one segment lies
/// 35 off.
constexpr double turn_of_one_edge = angle::upright;
/// Degrees between the planes next to two sides of an edge each and that of the rim at their corner, and between those two planes, from
/// which on they are walls: those of prisms of four to six sides. Of balls as coarse as an octahedron they are 55 and 71; between three
/// sides of one edge there is a triangle and nothing to choose.
constexpr double min_upright = angle::upright, min_apart = 55;
/// Sine of the angle between two sides from which on their tangents tell a plane: below 12 degrees only the faces next to them do.
constexpr double tells_plane = share::fifth;
/// Degrees between two faces from which on the surface is not the same one, as for features across holes.
constexpr double crease = angle::crease;

/// Radians by which the sides of a hole together turn in the surroundings from which on these reach around it: a half turn.
constexpr double turns_around = std::numbers::pi;

/// Whether the sides between the corners turn to the hole in the planes next to them, as the rim of a hole in one surface does. Walls meet
/// it at straight sides, or at the ends of tongues.
bool reach_around(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim, std::span<const Index> places) {
  std::vector<double> turn = measure(mesh, around, rim).turn;
  for (Index k : places) turn[static_cast<std::size_t>(k)] = 0;
  return std::accumulate(turn.begin(), turn.end(), 0.0) > turns_around;
}

/// A side as its ends show it.
struct SideEnd {
  Vec3 tangent, normal;  ///< unit; along the rim, of the faces next to it, on the mesh's outer side
  double bend = 0;       ///< degrees: by how much direction and plane may change from there to the next edge
  bool single = false;   ///< one edge is all there is
};

Vec3 face_normal(const Mesh& mesh, Index f) { return area_vector(mesh, f).stableNormalized(); }

/// The face next to rim edge k.
std::optional<Index> face_beside(const Connectivity& around, const std::vector<Index>& rim, Index k) {
  const Index n = static_cast<Index>(rim.size());
  const auto corner = around.edge(rim[(k + 1) % n], rim[k]);
  if (!corner) return {};
  return around.face(*corner);
}

/// Direction and plane at the beginning of a rim edge, carried on from its middle and that of the next edge; the other way round for the
/// end of a side.
SideEnd end_of_side(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim, Index edge, Index next,
                    bool single) {
  const Index n = static_cast<Index>(rim.size());
  const auto chord = [&](Index k) -> Vec3 { return mesh.vertices.row(rim[(k + 1) % n]) - mesh.vertices.row(rim[k]); };
  const auto plane = [&](Index k) {
    const std::optional<Index> f = face_beside(around, rim, k);
    return f ? face_normal(mesh, *f) : Vec3(Vec3::Zero());
  };
  const Vec3 a = chord(edge), b = chord(next);
  SideEnd end{a.stableNormalized(), plane(edge), turn_of_one_edge, single};
  if (single || !(end.normal.norm() > 0)) return end;
  const Vec3 direction = b.stableNormalized(), normal = plane(next);
  end.bend = degrees_between(end.tangent, direction) + degrees_between(end.normal, normal);
  const double share = a.norm() / (a.norm() + b.norm());
  end.tangent = (end.tangent + share * (end.tangent - direction)).stableNormalized();
  end.normal = (end.normal + share * (end.normal - normal)).stableNormalized();
  return end;
}

/// Degrees by which the planes next to the sides that end and begin at a corner are off, and how much of that may be the mesh's
/// coarseness.
struct CornerAngles {
  std::array<double, 2> off;
  double tolerance;
  bool walls = false;  ///< between two sides of an edge each
};

CornerAngles angles_at_corner(const SideEnd& in, const SideEnd& out) {
  const double tolerance = surely_smooth + of_bend * (in.bend + out.bend);
  const Vec3 across = in.tangent.cross(out.tangent);
  const double sine = across.norm();
  std::array<double, 2> off;
  if (clearly_less(sine, tells_plane)) {
    off.fill(degrees_between(in.normal, out.normal));
  } else {  // where the rim turns back, the other way up
    const double a = degrees_between(in.normal, across), b = degrees_between(out.normal, across);
    const bool up = !clearly_more(std::max(a, b), 180 - std::min(a, b));
    off = {up ? a : 180 - a, up ? b : 180 - b};
  }
  if (in.single && out.single) {
    const bool walls =
        !clearly_less(std::min(off[0], off[1]), min_upright) && !clearly_less(degrees_between(in.normal, out.normal), min_apart);
    return walls ? CornerAngles{off, surely_smooth, true} : CornerAngles{{0, 0}, tolerance};
  }
  return {off, tolerance};
}

}  // namespace

std::vector<double> sharp_sides(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim,
                                std::span<const Index> places) {
  const std::size_t sides = places.size();
  const Index n = static_cast<Index>(rim.size());
  std::vector<double> angles(sides, 0.0);
  if (sides < 2 || zigzag(mesh, rim, places) > smooth_sides || reach_around(mesh, around, rim, places)) return angles;
  std::vector<SideEnd> first, last;
  bool any_short = false;
  for (std::size_t i = 0; i < sides; ++i) {
    const Index from = places[i], edges = (places[(i + 1) % sides] - from + n - 1) % n + 1;
    const bool single = edges == 1;
    any_short = any_short || edges == 2;
    first.push_back(end_of_side(mesh, around, rim, from, (from + 1) % n, single));
    last.push_back(end_of_side(mesh, around, rim, (from + edges - 1) % n, (from + edges - 2 + n) % n, single));
  }
  std::vector<CornerAngles> at;  // where side i ends and the next one begins
  for (std::size_t i = 0; i < sides; ++i) at.push_back(angles_at_corner(last[i], first[(i + 1) % sides]));
  for (std::size_t i = 0; i < sides; ++i) {
    const CornerAngles &start = at[(i + sides - 1) % sides], &end = at[i];
    const double sum = start.off[1] + end.off[0];
    const bool tells = !first[i].single || (sides > 3 && start.walls && end.walls);
    const bool both =
        tells && clearly_more(start.off[1], min_share * start.tolerance) && clearly_more(end.off[0], min_share * end.tolerance);
    if (both && clearly_more(sum, start.tolerance + end.tolerance)) angles[i] = sum / 2;
  }
  // two edges alone do not tell a coarse mesh from a sharp one, unless all around it is the same
  if (any_short && std::find(angles.begin(), angles.end(), 0.0) != angles.end()) angles.assign(sides, 0.0);
  return angles;
}

bool any_sharp(const std::vector<double>& angles) {
  return std::any_of(angles.begin(), angles.end(), [](double angle) { return angle > 0; });
}

SideTerms terms_of_sides(const BySide<SideContinuity>& given, std::vector<double>& angles) {
  SideTerms terms;
  for (std::size_t i = 0; i < angles.size(); ++i) {
    if (given[i] != SideContinuity::automatic) angles[i] = 0;
    const SideContinuity own = angles[i] > 0 ? SideContinuity::free : given[i];
    terms.continuity.push_back(own);
    terms.alone.push_back(own == SideContinuity::free || own == SideContinuity::g0);
  }
  return terms;
}

void tell_sharp(const std::vector<double>& angles, Messages& warnings) {
  const auto [least, most] = std::minmax_element(angles.begin(), angles.end());
  if (least != angles.end() && *least > 0) {
    warnings.push_back({Code::all_sides_sharp, {{"angle", std::lround(*most)}}});
    return;
  }
  for (std::size_t i = 0; i < angles.size(); ++i)
    if (angles[i] > 0) warnings.push_back({Code::side_sharp, {{"angle", std::lround(angles[i])}, {"side", i}}});
}

std::vector<Index> not_continued(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim,
                                 std::span<const Index> places, const std::vector<double>& angles) {
  const Index n = static_cast<Index>(rim.size());
  enum : char { unseen, continued, beyond };
  std::vector<char> state(static_cast<std::size_t>(mesh.faces.size()), unseen);
  std::queue<Index> front;
  for (const char kind : {continued, beyond})
    for (std::size_t i = 0; i < places.size(); ++i)
      for (Index k = places[i]; (angles[i] > 0) == (kind == beyond) && k != places[(i + 1) % places.size()]; k = (k + 1) % n)
        if (const std::optional<Index> f = face_beside(around, rim, k); f && state[*f] == unseen) {
          state[*f] = kind;
          front.push(*f);
        }
  for (; !front.empty(); front.pop()) {
    const Index f = front.front();
    const auto face = mesh.faces[f];
    const Vec3 normal = face_normal(mesh, f);
    for (std::size_t k = 0; k < face.size(); ++k)
      for (Index g : around.faces_at_edge(face[k], face[(k + 1) % face.size()]))
        if (state[g] == unseen && degrees_between(normal, face_normal(mesh, g)) < crease) {
          state[g] = state[f];
          front.push(g);
        }
  }
  std::vector<Index> faces;
  for (Index f = 0; f < mesh.faces.size(); ++f)
    if (state[f] != continued) faces.push_back(f);
  return faces;
}

}  // namespace tripatch
