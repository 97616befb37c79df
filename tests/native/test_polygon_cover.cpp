// Quads in round rims: how many rows they get, and what becomes of an odd number of edges.
#include <algorithm>
#include <map>

#include "test_plane_rims.h"
#include "test_surfaces.h"
#include "tripatch/fill.h"
#include "tripatch/output/polygon_cover.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

/// A paraboloid over the unit disc, so high in its middle.
SurfacePtr cap(double height) {
  return formula_surface([height](const auto& b) {
    const auto u = b[0], v = b[1];
    JetPoint<std::decay_t<decltype(u)>::order> p;
    p.x = {u, v, height - height * (u * u + v * v)};
    return p;
  });
}

struct Rim {
  PlanePoints uv;
  Points points;
};

Rim circle(Index edges) {
  Rim rim{PlanePoints(edges, 2), Points::Zero(edges, 3)};
  for (Index k = 0; k < edges; ++k) {
    const double angle = whole * static_cast<double>(k) / static_cast<double>(edges);
    rim.uv.row(k) << std::cos(angle), std::sin(angle);
  }
  rim.points.leftCols(2) = rim.uv;
  return rim;
}

PlaneCover cover_of(Index edges, const Surface& surface, const LayoutOptions& options) {
  const Rim rim = circle(edges);
  return cover_polygon_with_quads(rim.uv, rim.points, {}, surface, options);
}

Points places_of(const PlaneCover& cover, const Surface& surface) {
  Points at = Points::Zero(cover.uv.rows(), 3);
  at.leftCols(2) = cover.uv;
  return surface.positions(at);
}

/// How often each edge is passed from one end to the other.
std::map<std::pair<Index, Index>, int> edges_of(const Faces& faces) {
  std::map<std::pair<Index, Index>, int> found;
  for (Index f = 0; f < faces.size(); ++f)
    for (std::size_t k = 0; k < faces[f].size(); ++k) ++found[{faces[f][k], faces[f][(k + 1) % faces[f].size()]}];
  return found;
}

}  // namespace

TEST_CASE("polygon cover: an odd round rim that is not split leaves one triangle, and every edge has a face on either side") {
  for (const Index edges : {9, 15, 21, 33})
    for (const int rows : {0, 2}) {
      LayoutOptions options;
      options.rows = rows;
      options.split_odd = false;
      const SurfacePtr flat = cap(0);
      const PlaneCover cover = cover_of(edges, *flat, options);
      REQUIRE(cover.rim == edges);
      CHECK_FALSE(cover.split);
      int triangles = 0;
      for (Index f = 0; f < cover.faces.size(); ++f) triangles += cover.faces[f].size() == 3;
      CHECK(triangles == 1);
      CHECK(cover.warnings.size() == 1);
      for (const auto& [edge, times] : edges_of(cover.faces)) {
        CHECK(times == 1);
        const auto [a, b] = edge;
        const bool along = a < edges && b == (a + 1) % edges;
        CHECK(edges_of(cover.faces).contains({b, a}) != along);
      }
      CHECK(quad_quality(places_of(cover, *flat), cover.faces).least > 0.5);
      options.split_odd = true;
      const PlaneCover split = cover_of(edges, *flat, options);
      CHECK(split.split);
      CHECK(split.faces.size() == cover.faces.size());
      CHECK(split.poles.size() == cover.poles.size());
    }
}

TEST_CASE("quads between four sides meet points inside and split an edge of the rim, in a mesh and in its mirror image") {
  const tripatch::testing::PlaneRim given({90, 0, 0, 90, 0, 0, 90, 0, 0, 90, 0, 0, 0}, 1,
                                          {1, 1, 1, 1, 1, 1, 1.1, 0.9, 1, 0.75, 0.75, 0.75, 0.75});
  for (const bool is_mirrored : {false, true}) {
    const double side = is_mirrored ? -1 : 1;
    Points vertices = given.vertices;
    vertices.col(2) = 0.02 * vertices.col(0).array() * vertices.col(1).array();
    vertices.col(0) *= side;
    Faces faces;
    for (Index f = 0; f < given.faces.size(); ++f) {
      std::vector<Index> face(given.faces[f].begin(), given.faces[f].end());
      if (is_mirrored) std::reverse(face.begin(), face.end());
      faces.add(face);
    }
    FillOptions options;
    options.rim = given.rim;
    if (is_mirrored) std::reverse(options.rim->begin(), options.rim->end());
    options.corners = {0, 3, 6, 9};
    options.output = Output::quads;
    const Eigen::RowVector3d middle = vertices.topRows(13).colwise().mean();
    const Vec3 met = middle.transpose() + Vec3(0.3 * side, 0.5, 0.1);
    options.through = {{met, {}}};
    const Fill made = fill({vertices, faces}, options);
    CHECK((made.vertices.rowwise() - met.transpose()).rowwise().norm().minCoeff() < 1e-9);
    REQUIRE(made.split_edges.size() == 1);
    const auto [a, b] = made.split_edges[0];
    const auto at = std::find(made.rim.begin(), made.rim.end(), a);
    REQUIRE(at != made.rim.end());
    CHECK((at + 1 == made.rim.end() ? made.rim.front() : at[1]) == b);
    const Connectivity own(made.faces, vertices.rows() + made.vertices.rows());
    CHECK(own.edge(a, vertices.rows()));
    CHECK(own.edge(vertices.rows(), b));
    for (Index corner : {0, 3, 6, 9}) CHECK(own.at(corner).size() == 1);
  }
}
