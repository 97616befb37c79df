#include "tripatch/hole/hole.h"

#include <algorithm>
#include <utility>

#include "tripatch/hole/corners.h"
#include "tripatch/hole/outer_borders.h"
#include "tripatch/hole/rim_checks.h"
#include "tripatch/mesh/border_loops.h"
#include "tripatch/messages.h"

namespace tripatch {
namespace {

using Loop = std::vector<Index>;

std::array<Index, 3> places_of(const std::array<Index, 3>& corners, const Loop& rim, Index vertices) {
  std::array<Index, 3> places;
  check_vertices(corners, vertices, "corners");
  check_distinct(corners, "corners");
  for (int i = 0; i < 3; ++i) {
    const auto found = std::find(rim.begin(), rim.end(), corners[i]);
    if (found == rim.end()) throw CodedRefusal(Code::corner_not_on_rim, {corners[i]});
    places[i] = found - rim.begin();
  }
  return places;
}

}  // namespace

std::vector<Index> Hole::side(int i) const {
  const Index n = static_cast<Index>(rim.size());
  const Index first = corners[(i + 1) % 3], last = corners[(i + 2) % 3];
  std::vector<Index> vertices;
  for (Index k = first; k != last; k = (k + 1) % n) vertices.push_back(rim[k]);
  vertices.push_back(rim[last]);
  return vertices;
}

std::vector<std::vector<Index>> find_holes(const FacesRef& faces) { return border_loops(Connectivity(faces)); }

Hole make_hole(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim,
               const std::optional<std::array<Index, 3>>& corners) {
  Hole hole;
  hole.rim = check_topology(around, rim);
  check_positions(mesh, around, hole.rim);
  std::rotate(hole.rim.begin(), std::min_element(hole.rim.begin(), hole.rim.end()), hole.rim.end());
  std::array<Index, 3> places =
      corners ? places_of(*corners, hole.rim, mesh.vertices.rows()) : three_corners(mesh, around, hole.rim);
  const Index n = static_cast<Index>(hole.rim.size());
  if (!corners)
    std::rotate(places.begin(),
                std::min_element(places.begin(), places.end(), [&](Index a, Index b) { return hole.rim[a] < hole.rim[b]; }),
                places.end());
  std::rotate(hole.rim.begin(), hole.rim.begin() + places[0], hole.rim.end());
  for (int i = 0; i < 3; ++i) hole.corners[i] = (places[i] - places[0] + n) % n;
  std::sort(hole.corners.begin() + 1, hole.corners.end());
  return hole;
}

Hole make_hole(const Mesh& mesh, const std::vector<Index>& rim, const std::optional<std::array<Index, 3>>& corners,
               const std::vector<Index>& replaced) {
  return make_hole(mesh, Connectivity::around(mesh, rim, 0, replaced), rim, corners);
}

Hole find_hole(const Mesh& mesh, const Connectivity& around) {
  std::vector<Loop> loops;
  std::vector<Loop> unclosed;
  const std::vector<Border> borders = borders_of(mesh, around, border_loops(around, &unclosed));
  for (const Border& border : borders)
    if (!border.outer) loops.push_back(border.loop);
  if (loops.empty()) refuse_no_hole(borders, unclosed);
  std::vector<Hole> found;
  std::optional<CodedRefusal> refusal;  // of the shortest
  for (const Loop& loop : loops) {
    try {
      found.push_back(make_hole(mesh, around, loop, std::nullopt));
    } catch (const CodedRefusal& r) {
      if (!refusal) refusal = r;
    }
  }
  if (found.size() == 1) return found[0];
  if (found.empty()) {
    if (loops.size() == 1) throw *refusal;
    throw CodedRefusal(Code::no_hole_fillable,
                       {{"count", loops.size()}, {"shortest", std::vector<Index>{loops[0][0]}}, {"reason", refusal->message()}},
                       refusal->where());
  }
  std::vector<Loop> rims;
  for (Hole& hole : found) rims.push_back(std::move(hole.rim));
  refuse_several(rims, Code::several_three_cornered_holes);
}

Hole find_hole(const Mesh& mesh) { return find_hole(mesh, Connectivity(mesh)); }

}  // namespace tripatch
