#include "tripatch/fill/fill_context.h"

#include <algorithm>

#include "tripatch/estimate/local_mesh.h"
#include "tripatch/hole/outer_borders.h"
#include "tripatch/hole/rim_checks.h"
#include "tripatch/mesh/border_loops.h"
#include "tripatch/mesh/changed_faces.h"
#include "tripatch/messages.h"
#include "tripatch/polygon/domain.h"
#include "tripatch/report/passages.h"

namespace tripatch {

namespace {

/// Islands may lie far from the rim, or on another piece of the mesh.
Connectivity around_rim(const Mesh& mesh, const std::optional<std::vector<Index>>& rim,
                        const std::vector<std::vector<Index>>& islands, const std::vector<Index>& replaced) {
  if (!rim) return Connectivity(mesh, replaced);
  std::vector<Index> vertices = *rim;
  for (const std::vector<Index>& island : islands) vertices.insert(vertices.end(), island.begin(), island.end());
  return Connectivity::around(mesh, vertices, max_rings, replaced);
}

}  // namespace

FillContext::FillContext(const Mesh& given, const std::optional<std::vector<Index>>& rim, const FillOptions& options,
                         const Connectivity* connected)
    : mesh(given),
      left(!rim && connected && options.replaced.empty()
               ? *connected
               : own_.emplace(around_rim(given, rim, options.islands, options.replaced))),
      is_part_(rim.has_value()) {
  if (!options.replaced.empty() && (options.surroundings == SurroundingsFrom::limit || !rim))
    all_ = around_rim(given, rim, options.islands, {});
}

std::optional<std::array<Index, 3>> three(const Corners& corners) {
  if (!corners) return {};
  if (corners->size() == 3) return std::array<Index, 3>{(*corners)[0], (*corners)[1], (*corners)[2]};
  throw CodedRefusal(Code::three_corners_needed, {{"count", corners->size()}}, *corners);
}

std::vector<std::optional<Vec3>> FillContext::passages_of(std::span<const Fill* const> fills, const FillOptions& options) const {
  std::vector<FillFaces> looked_at;
  for (const Fill* each : fills) looked_at.push_back({each->vertices, each->faces, each->rim});
  std::optional<Subdivision> subdivision;
  if (options.surroundings == SurroundingsFrom::limit) subdivision = options.subdivision;
  if (options.replaced.empty()) return passages(mesh, looked_at, subdivision);
  const Faces faces = changed_faces(mesh.faces, options.replaced);
  return passages({mesh.vertices, faces}, looked_at, subdivision);
}

std::vector<Index> loop_through(const FillContext& context, const std::vector<Index>& corners) {
  for (std::vector<Index>& loop : border_loops(context.left))
    if (!corners.empty() && std::find(loop.begin(), loop.end(), corners[0]) != loop.end()) return std::move(loop);
  throw CodedRefusal(Code::corner_not_on_border, corners);
}

std::vector<Index> only_hole(const FillContext& context) {
  std::vector<std::vector<Index>> loops;
  std::optional<CodedRefusal> none;  // of the shortest
  std::vector<std::vector<Index>> unclosed;
  const std::vector<Border> borders = borders_of(context.mesh, context.left, border_loops(context.left, &unclosed));
  for (const Border& border : borders) {
    if (border.outer) continue;
    try {
      check_topology(context.left, border.loop);
      loops.push_back(border.loop);
    } catch (const CodedRefusal& refusal) {
      if (!none) none = refusal;
    }
  }
  if (loops.size() == 1) return loops[0];
  if (none && loops.empty()) throw *none;
  if (loops.empty()) refuse_no_hole(borders, unclosed);
  refuse_several(loops, Code::several_holes);
}

Hole hole_of(const FillContext& context, const std::optional<std::vector<Index>>& rim, const Corners& corners) {
  if (rim) return make_hole(context.mesh, context.left, *rim, three(corners));
  if (!corners) return find_hole(context.mesh, context.left);
  return make_hole(context.mesh, context.left, loop_through(context, *corners), three(corners));
}

std::vector<Index> at_places(const std::vector<Index>& loop, const std::vector<Index>& places) {
  std::vector<Index> vertices;
  for (Index place : places) vertices.push_back(loop[place]);
  return vertices;
}

std::vector<Index> places_in(const std::vector<Index>& loop, const std::vector<Index>& vertices) {
  std::vector<Index> places;
  for (std::size_t k = 0; k < loop.size(); ++k)
    if (std::find(vertices.begin(), vertices.end(), loop[k]) != vertices.end()) places.push_back(static_cast<Index>(k));
  return places;
}

CorneredRim cornered(const FillContext& context, const std::vector<Index>& rim, const std::vector<Index>& corners) {
  CorneredRim out;
  out.rim = check_topology(context.left, rim);
  check_finite(context.mesh, context.left, out.rim);
  check_positions(context.mesh, context.left, out.rim);
  for (Index v : corners)
    if (std::find(out.rim.begin(), out.rim.end(), v) == out.rim.end()) throw CodedRefusal(Code::corner_not_on_rim, {v});
  std::rotate(out.rim.begin(), std::find(out.rim.begin(), out.rim.end(), corners[0]), out.rim.end());
  out.places = places_in(out.rim, corners);
  check_distinct(corners, "corners");
  return out;
}

bool makes_polygon(const std::vector<Index>& corners) {
  return corners.size() >= 2 && corners.size() != 3 && corners.size() <= static_cast<std::size_t>(max_sides);
}

void check_counts(const FillOptions& options, std::size_t sides) {
  check_count(options.continuity, sides, "continuity");
  check_count(options.bulge, sides, "bulge");
}

}  // namespace tripatch
