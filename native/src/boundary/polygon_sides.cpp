#include "tripatch/boundary/polygon_sides.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tripatch/boundary/mesh_sides.h"
#include "tripatch/fairing/curvature.h"
#include "tripatch/math/canonical_start.h"
#include "tripatch/messages.h"

namespace tripatch {
namespace {

/// The derivative across turned at a right angle to the side at the rim's vertices, within the tangent planes. As read it leans towards
/// the corners of a triangle.
Side upright(Side side) {
  const std::vector<double>& t = side.rim;
  std::vector<double> lean, bend;
  for (double at : t) {
    const SideForm form = side_form(side, at);
    const double b = form.r.dot(form.dc) / form.dc.squaredNorm();
    lean.push_back(b);
    const Vec3 q = (form.rr - 2 * b * form.rc + b * b * form.cc) * form.n;
    bend.insert(bend.end(), q.data(), q.data() + 3);
  }
  side.r = side.r - PiecewisePolynomial::spline(t, lean, 1) * side.c.derivative();
  if (!side.q.empty()) side.q = PiecewisePolynomial::spline(t, bend, 3);
  return side;
}

/// Sides that are read together as those of a hole of three corners, which begins at a corner of the polygon.
struct ReadTogether {
  Index corner;
  std::vector<std::array<Index, 2>> sides;  // of the hole, of the polygon
};

/// By twos around the polygon from where its geometry begins it: however it is given, the same are read together.
std::vector<ReadTogether> read_together(Index n, const CanonicalStart& begin, Index corner) {
  std::vector<ReadTogether> out;
  const auto at = [&](Index k) { return (corner + k + 2 * n) % n; };
  if (n == 2) return {{0, {{2, 0}}}, {1, {{2, 1}}}};
  for (Index k = 0; k < n; k += 2) {
    const bool both = k + 1 < n;
    if (!begin.backwards) {
      out.push_back({at(k), {{2, at(k)}}});
      if (both) out.back().sides.push_back({0, at(k + 1)});
    } else {
      out.push_back({at(-k - 2), {{0, at(-k - 1)}}});
      if (both) out.back().sides.push_back({2, at(-k - 2)});
    }
  }
  return out;
}

/// Between three corners, in the order of polygons.
PolygonSides sides_of_three(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim,
                            const std::vector<Index>& corners, const std::vector<bool>& alone, const VertexPlanes& planes) {
  Hole hole;
  hole.rim = rim;
  hole.corners = {corners[0], corners[1], corners[2]};
  if (!alone.empty()) hole.alone = {alone[1], alone[2], alone[0]};
  MeshSides sides = mesh_sides(mesh, around, hole, planes);
  PolygonSides known;
  known.surroundings_error = sides.surroundings_error;
  for (const int i : {2, 0, 1}) {
    known.sides.push_back(std::move(sides.sides[i]));
    known.parameters.push_back(std::move(sides.parameters[i]));
  }
  return known;
}

}  // namespace

PolygonSides polygon_sides(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim,
                           const std::vector<Index>& corners, const std::vector<bool>& alone, const VertexPlanes& planes) {
  const Index n = static_cast<Index>(corners.size()), edges = static_cast<Index>(rim.size());
  if (n == 3) return sides_of_three(mesh, around, rim, corners, alone, planes);
  PolygonSides out;
  out.sides.resize(n);
  out.parameters.resize(n);
  CanonicalStarts beginnings(mesh.vertices(rim, Eigen::all), {}, corners);
  beginnings.compare_along();
  const CanonicalStart begin = beginnings.left()[0];
  const Index first = std::find(corners.begin(), corners.end(), begin.place) - corners.begin();
  double squares = 0, counted = 0;  // of the errors of the sides, by their vertices
  for (const ReadTogether& together : read_together(n, begin, first)) {
    // a hole of three corners: k, the next and the one after it, of which the third side is read for its beginning and end only; of a
    // lens the third corner is in the middle of the other side
    Hole hole;
    const Index k = together.corner, start = corners[k], second = (corners[(k + 1) % n] - start + edges) % edges;
    Index third = (corners[(k + 2) % n] - start + edges) % edges;
    if (n == 2) third = (second + edges + (begin.backwards ? 1 : 0)) / 2;
    if (third == second || third == edges) throw CodedRefusal(Code::side_too_short, {rim[start]});
    for (Index j = 0; j < edges; ++j) hole.rim.push_back(rim[(start + j) % edges]);
    hole.corners = {0, second, third};
    if (!alone.empty())
      hole.alone = {alone[(k + 1) % n], alone[n == 2 ? 1 - k : (k + 2) % n] || alone[(k + n - 1) % n], alone[k]};
    MeshSides three = mesh_sides(mesh, around, hole, planes);
    for (const auto& [i, side] : together.sides) {
      const double vertices = static_cast<double>(three.parameters[i].size());
      squares += vertices * std::pow(three.side_error[i], 2);
      counted += alone.empty() || !alone[side] ? vertices : 0;
      out.sides[side] = upright(std::move(three.sides[i]));
      out.parameters[side] = std::move(three.parameters[i]);
    }
  }
  out.surroundings_error = counted > 0 ? std::sqrt(squares / counted) : 0;
  return out;
}

}  // namespace tripatch
