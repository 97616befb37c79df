#include <catch2/catch.hpp>
#include <map>

#include "tripatch/fill.h"
#include "tripatch/hole/hole.h"
#include "tripatch/mesh/triangles.h"
#include "tripatch/output/doubled_edges.h"
#include "tripatch/types.h"

using namespace tripatch;

namespace {

/// The largest number of faces at an edge, each counted with its direction.
int max_at_edge(const Faces& mesh, const Faces& fill) {
  std::map<std::pair<Index, Index>, int> uses;
  int most = 0;
  for (const Faces* faces : {&mesh, &fill})
    for (Index f = 0; f < faces->size(); ++f) {
      const auto face = (*faces)[f];
      for (std::size_t k = 0; k < face.size(); ++k)
        most = std::max(most, ++uses[std::minmax(face[k], face[(k + 1) % face.size()])]);
    }
  return most;
}

}  // namespace

TEST_CASE("an inner edge that the mesh has already gets a vertex in its middle, and no other") {
  const Faces mesh = faces_of({{10, 11, 12}, {10, 12, 13}});  // joins 10 and 12
  const std::vector<Index> rim = {13, 12, 11, 10};            // of the other side
  Triangles one = {{0, 1, 3}, {1, 2, 3}}, other = {{0, 1, 2}, {0, 2, 3}};
  CHECK(halve_doubled_edges(Connectivity(mesh), rim, 4, other).empty());
  CHECK(other.size() == 2);
  const auto halved = halve_doubled_edges(Connectivity(mesh), rim, 7, one);
  REQUIRE(halved == std::vector<std::array<Index, 2>>{{1, 3}});
  CHECK(one == Triangles{{0, 1, 7}, {1, 2, 7}, {0, 7, 3}, {7, 2, 3}});  // each keeps its direction
}

TEST_CASE("edges of one triangle are halved one after the other") {
  // a hexagon whose mesh joins 0 - 2 - 4 - 0, and a fill that does too
  const Faces mesh = faces_of({{2, 1, 0}, {4, 3, 2}, {0, 5, 4}, {0, 4, 2}});
  const std::vector<Index> rim = {0, 1, 2, 3, 4, 5};
  Triangles fill = {{0, 1, 2}, {2, 3, 4}, {4, 5, 0}, {0, 2, 4}};
  CHECK(halve_doubled_edges(Connectivity(mesh), rim, 6, fill).size() == 3);
  CHECK(fill.size() == 10);
  CHECK(max_at_edge(mesh, faces_of(fill)) == 2);
}

TEST_CASE("a tetrahedron without two of its faces is filled to a manifold, whatever the corners and the method") {
  const Points vertices = (Points(4, 3) << 0, 0, 0, 1, 0, 0, 0.5, 0.9, 0, 0.5, 0.3, 0.8).finished();
  const Faces faces = faces_of({{0, 1, 2}, {0, 2, 3}});
  for (const char* method : {"auto", "side_vertex", "polyharmonic_spline"})
    for (Index apart = 0; apart < 4; ++apart) {
      FillOptions options;
      options.method = method;
      if (options.method == "side_vertex") options.fairing.reset();  // as it is, though it folds
      options.rim = std::vector<Index>{0, 1, 2, 3};
      options.corners = std::vector<Index>{(apart + 1) % 4, (apart + 2) % 4, (apart + 3) % 4};
      INFO(method << ", no corner at " << apart);
      CHECK(max_at_edge(faces, fill({vertices, faces}, options).faces) == 2);
    }
}

TEST_CASE("the back of a face is no hole, though another face touches it in a vertex") {
  const Points vertices = (Points(5, 3) << 0, 0, 0, 1, 0, 0, 0, 1, 0, -1, 0, 0, 0, -1, 1).finished();
  const Faces faces = faces_of({{0, 1, 2}, {0, 3, 4}});
  CHECK_THROWS_AS(make_hole({vertices, faces}, {0, 1, 2}, {}), Refusal);
  CHECK_THROWS_AS(make_hole({vertices, faces}, {0, 3, 4}, {}), Refusal);
}
