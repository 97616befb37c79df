// What is asked of a mesh before anything is filled, and what is made of all of it: borders, choices, limits, smoothed triangles.
#include <algorithm>

#include "bytes.h"
#include "tripatch/cage/limit_points.h"
#include "tripatch/hole/choose_holes.h"
#include "tripatch/hole/clear_corners.h"
#include "tripatch/hole/hole.h"
#include "tripatch/hole/outer_borders.h"
#include "tripatch/mesh/vertex_normals.h"
#include "tripatch/smooth_triangles.h"

using namespace tripatch;
using fuzz::Bytes;
using fuzz::require;

namespace {

/// What it says is refused or wrong of an argument is said.
template <class F>
void tried(F&& f) {
  try {
    f();
  } catch (const Refusal&) {
  } catch (const InvalidArgument&) {
  }
}

void check_loops(const Mesh& mesh) {
  for (const std::vector<Index>& loop : find_holes(mesh.faces)) {
    require(loop.size() >= 2, "a border of one vertex");
    require(loop[0] == *std::min_element(loop.begin(), loop.end()), "a border does not begin at its lowest vertex");
    for (Index v : loop) require(v >= 0, "a border names a negative vertex");  // of faces alone: how many there are is not known
    tried([&] { is_outer_border(mesh, loop); });
    tried([&] { corners_between_sides(mesh, Connectivity(mesh), loop); });
  }
}

void check_smooth(const Mesh& mesh, int resolution) {
  const SmoothMesh smooth = smooth_triangles(mesh, {}, resolution);
  require(smooth.normals.allFinite(), "a normal is not finite");
  require(static_cast<Index>(smooth.faces.size()) == mesh.faces.size() * resolution * resolution,
          "smoothed triangles are missing");
  for (const auto& t : smooth.faces)
    for (Index v : t) {
      require(v >= 0 && v < smooth.vertices.rows(), "a smoothed triangle names a vertex that is not there");
      require(smooth.vertices.row(v).allFinite(), "a smoothed triangle is not finite");  // as what no face names may be
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Bytes bytes(data, size);
  const fuzz::OwnMesh own = fuzz::take_mesh(bytes);
  const Mesh mesh = own;
  HoleChoice choice;
  if (bytes.seldom(4)) choice.max_edges = bytes.whole(0, 30);
  if (bytes.seldom(4)) choice.max_diameter = bytes.number();
  if (bytes.seldom(4)) choice.corner_count = {bytes.whole(0, 13), bytes.whole(0, 13)};
  choice.outer = bytes.flag();
  const int resolution = bytes.whole(1, 4);
  const std::vector<Index> rim = bytes.indices(14, mesh.vertices.rows());
  tried([&] { check_loops(mesh); });
  tried([&] { choose_holes(mesh, choice); });
  tried([&] { make_hole(mesh, Connectivity(mesh), rim, {}); });
  tried([&] { check_smooth(mesh, resolution); });
  tried([&] { vertex_normals(mesh); });
  tried([&] {
    const Points limit = limit_points(mesh);
    require(limit.rows() == mesh.vertices.rows(), "limit points are missing");
  });
  return 0;
}
