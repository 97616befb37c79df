#include "tripatch/hole/outer_borders.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>

#include "tripatch/hole/rim_shape.h"
#include "tripatch/mesh/border_loops.h"

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

}  // namespace

std::vector<char> outer_borders(const Mesh& mesh, const Connectivity& around, const std::vector<std::vector<Index>>& loops) {
  std::vector<char> outer;
  for (const std::vector<Index>& loop : loops) outer.push_back(turns_less(outer_turn, mesh, around, loop));
  return outer;
}

std::vector<Border> borders_of(const Mesh& mesh, const Connectivity& around) {
  const std::vector<std::vector<Index>> loops = border_loops(around);
  std::vector<char> outer = outer_borders(mesh, around, loops);
  if (std::find(outer.begin(), outer.end(), 0) == outer.end()) outer.assign(loops.size(), 0);  // the mesh has no other
  std::vector<Border> borders;
  for (std::size_t k = 0; k < loops.size(); ++k) borders.push_back({loops[k], outer[k] != 0, diameter(mesh, loops[k])});
  return borders;
}

std::vector<Border> borders_of(const Mesh& mesh) { return borders_of(mesh, Connectivity(mesh)); }

bool is_outer_border(const Mesh& mesh, const std::vector<Index>& rim, bool of_sheet) {
  for (Index v : rim)
    if (v < 0 || v >= mesh.vertices.rows()) throw InvalidArgument("The mesh has no vertex " + std::to_string(v));
  if (rim.size() < 3) throw InvalidArgument("A border loop has three vertices or more");
  return turns_less(of_sheet ? sheet_turn : outer_turn, mesh, Connectivity::around(mesh, rim, 0), rim);
}

}  // namespace tripatch
