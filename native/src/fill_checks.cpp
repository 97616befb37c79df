#include "tripatch/fill_checks.h"

#include <set>
#include <string>

#include "tripatch/constructions/methods.h"
#include "tripatch/hole/rim_checks.h"
#include "tripatch/isometry/isometric_fill.h"
#include "tripatch/mesh/edge_key.h"
#include "tripatch/messages.h"

namespace tripatch {
namespace {

void check_corners(const Corners& corners) {
  if (corners && corners->size() == 1) throw CodedArgument(Code::single_corner, {});
}

/// met: whether the method is one of those.
void check_met(const char* option, const std::vector<std::string>& methods, bool met, const FillOptions& options) {
  if (!met)
    throw CodedArgument(Code::option_not_of_method, {{"option", option}, {"methods", methods}, {"method", options.method}});
  if (options.surroundings != SurroundingsFrom::mesh) throw CodedArgument(Code::option_needs_mesh, {{"option", option}});
}

}  // namespace

void check_for_holes(const FillOptions& options) {
  check(options);
  check_corners(options.corners);
  if (options.method != automatic_method && !find_method(options.method).fills_holes)
    throw CodedArgument(Code::method_of_function, {{"method", options.method}, {"function", "tripatch.blend"}});
  const bool meets = options.method == automatic_method || std::ranges::count(find_method(options.method).lacks, "through") == 0;
  if (!options.through.empty()) check_met("through", {automatic_method, polygon_method, spline_method}, meets, options);
  check_taken(options);
  if (options.fairing == Fairing::isometric && options.surroundings == SurroundingsFrom::limit) refuse_isometric();
  if (options.fairing == Fairing::isometric && !options.through.empty())
    throw CodedArgument(Code::options_exclusive, {{"first", "fairing"}, {"second", "through"}});
  if (options.cap != Cap::automatic) check_met("cap", {automatic_method}, options.method == automatic_method, options);
  if ((options.method == spline_method || options.method == rows_method) && options.output == Output::cage)
    throw CodedArgument(Code::method_makes_no_cages, {{"method", options.method}});
}

void check_several(const std::vector<std::vector<Index>>& rims, const FillOptions& options, const std::vector<Corners>& corners) {
  const auto refuse = [](const char* option, const char* other) {
    throw CodedArgument(Code::option_of_one_hole, {{"option", option}, {"other", other}});
  };
  if (options.rim) refuse("rim", "the argument rims");
  if (options.corners) refuse("corners", "the argument corners");
  if (options.center && rims.size() > 1) refuse("center", "center_offset");
  const auto length = [](std::size_t count) { return "(" + std::to_string(count) + ",)"; };
  if (corners.size() > rims.size())
    throw CodedArgument(Code::wrong_shape,
                        {{"name", "corners"}, {"shape", length(rims.size())}, {"given", length(corners.size())}});
  for (const Corners& each : corners) check_corners(each);
}

void check_named(const Mesh& mesh, std::span<const std::vector<Index>> rims, const Corners& corners, const FillOptions& options) {
  const Index n = mesh.vertices.rows();
  for (const std::vector<Index>& rim : rims) check_vertices(rim, n, "rim");
  for (const std::vector<Index>& island : options.islands) check_vertices(island, n, "islands");
  if (corners) check_vertices(*corners, n, "corners");
}

void check_creases(const Mesh& mesh, const std::vector<std::array<Index, 2>>& creases) {
  if (creases.empty()) return;
  std::set<EdgeKey> missing;
  for (const auto& [a, b] : creases) missing.insert(edge_key(a, b));
  for (Index f = 0; f < mesh.faces.size(); ++f) {
    const IndicesRef face = mesh.faces[f];
    for (std::size_t k = 0; k < face.size(); ++k) missing.erase(edge_key(face[k], face[(k + 1) % face.size()]));
  }
  if (missing.empty()) return;
  const auto [a, b] = *missing.begin();
  if (a < 0 || b >= mesh.vertices.rows()) return;  // told by what reads them
  throw CodedArgument(Code::no_such_edge, {{"option", "edge_creases"}, {"first", a}, {"second", b}});
}

}  // namespace tripatch
