#include "tripatch/hole/outer_borders.h"

#include <algorithm>
#include <numbers>
#include <numeric>

#include "tripatch/hole/rim_checks.h"
#include "tripatch/hole/rim_shape.h"
#include "tripatch/math/tolerant_compare.h"
#include "tripatch/mesh/border_loops.h"
#include "tripatch/messages.h"

namespace tripatch {
namespace {

/// Radians. The whole turn of a loop is 2 pi for a hole in a plane, -2 pi for a plane's outer border, and changes by the curvature
/// that is enclosed (Gauss and Bonnet): 0 on a cylinder, whose ends are holes. What has bent a quarter of the way further is outer.
constexpr double outer_turn = -std::numbers::pi / 2;
/// The border of a sheet, or of a bowl that reaches less than 41 degrees of a sphere from its middle: what fills it lies on it.
constexpr double sheet_turn = -1.5 * std::numbers::pi;

bool turns_less(double most, const Mesh& mesh, const Connectivity& around, const std::vector<Index>& loop) {
  const std::vector<double> turn = measure(mesh, around, loop).turn;
  return std::accumulate(turn.begin(), turn.end(), 0.0) < most;
}

double length_of(const Mesh& mesh, const std::vector<Index>& loop) {
  double length = 0;
  for (std::size_t k = 0; k < loop.size(); ++k)
    length += (mesh.vertices.row(loop[(k + 1) % loop.size()]) - mesh.vertices.row(loop[k])).stableNorm();
  return length;
}

/// The faces at the edges of a loop.
std::vector<Index> faces_along(const Connectivity& around, const std::vector<Index>& loop) {
  std::vector<Index> faces;
  for (std::size_t k = 0; k < loop.size(); ++k)
    for (Index f : around.faces_at_edge(loop[k], loop[(k + 1) % loop.size()])) faces.push_back(f);
  return faces;
}

/// Whether each border is the longest of every connected component at it. Of equally long ones all are.
std::vector<char> longest_of_components(const Mesh& mesh, const Connectivity& around, const std::vector<Border>& borders) {
  const std::vector<Index> component = components_of(around);
  std::vector<double> longest(component.size(), 0), length;
  for (const Border& border : borders) {
    length.push_back(length_of(mesh, border.loop));
    for (Index f : faces_along(around, border.loop)) longest[component[f]] = std::max(longest[component[f]], length.back());
  }
  std::vector<char> is_longest;
  for (std::size_t k = 0; k < borders.size(); ++k) {
    const std::vector<Index> faces = faces_along(around, borders[k].loop);
    is_longest.push_back(std::ranges::none_of(faces, [&](Index f) { return clearly_more(longest[component[f]], length[k]); }));
  }
  return is_longest;
}

/// Whether a border would be covered by what fills it: that of a sheet of several faces.
bool is_of_sheet(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& loop) {
  const std::vector<Index> faces = faces_along(around, loop);
  return turns_less(sheet_turn, mesh, around, loop) && std::ranges::any_of(faces, [&](Index f) { return f != faces[0]; });
}

}  // namespace

std::vector<Border> borders_of(const Mesh& mesh, const Connectivity& around, const std::vector<std::vector<Index>>& loops) {
  std::vector<Border> borders;
  for (const std::vector<Index>& loop : loops)
    borders.push_back({loop, turns_less(outer_turn, mesh, around, loop), diameter(mesh, loop)});
  if (std::ranges::any_of(borders, &Border::outer)) {
    const std::vector<char> longest = longest_of_components(mesh, around, borders);
    for (std::size_t k = 0; k < borders.size(); ++k) borders[k].outer &= longest[k] != 0;
  }
  if (std::ranges::all_of(borders, &Border::outer))  // the mesh has no other
    for (Border& border : borders) border.outer = is_of_sheet(mesh, around, border.loop);
  return borders;
}

Message told_of_unclosed(const std::vector<Index>& chain) {
  return {
      Code::border_not_closed, {{"edges", chain.size() - 1}, {"ends", std::vector<Index>{chain.front(), chain.back()}}}, chain};
}

void refuse_no_hole(const std::vector<Border>& borders, const std::vector<std::vector<Index>>& unclosed) {
  if (!unclosed.empty()) throw CodedRefusal(told_of_unclosed(unclosed[0]));
  if (borders.empty()) throw CodedRefusal(Code::no_border);
  throw CodedRefusal(Code::only_outer_borders, borders.back().loop);
}

std::vector<Border> borders_of(const Mesh& mesh, const Connectivity& around) {
  return borders_of(mesh, around, border_loops(around));
}

std::vector<Border> borders_of(const Mesh& mesh) { return borders_of(mesh, Connectivity(mesh)); }

bool is_outer_border(const Mesh& mesh, const std::vector<Index>& rim, bool of_sheet) {
  check_vertices(rim, mesh.vertices.rows(), "rim");
  if (rim.size() < 3) throw CodedArgument(Code::out_of_range, {{"name", "len(rim)"}, {"least", 3}, {"value", rim.size()}});
  return turns_less(of_sheet ? sheet_turn : outer_turn, mesh, Connectivity::around(mesh, rim, 0), rim);
}

}  // namespace tripatch
