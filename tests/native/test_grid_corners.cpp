// Corners of a hole in a grid of quads.
#include <numbers>

#include "test_plane_rims.h"
#include "test_refusals.h"

using namespace tripatch;
using namespace tripatch::testing;

TEST_CASE("corners of a grid are where three of its quads meet at the rim: triangles are no lines of a grid") {
  for (const bool quads : {true, false}) {
    // a round rim of twelve edges in a ring of quads, and at every fourth of its vertices one face more
    constexpr Index n = 12;
    std::vector<Vec3> points;
    const auto on_circle = [](double k, double radius) {
      return Vec3(radius * std::cos(2 * std::numbers::pi * k / n), radius * std::sin(2 * std::numbers::pi * k / n), 0);
    };
    for (Index k = 0; k < n; ++k) points.push_back(on_circle(static_cast<double>(k), 1));
    std::vector<std::array<Index, 2>> outer(n);  // the last vertex of the face before, the first of that behind
    Faces faces;
    for (Index k = 0; k < n; ++k) {
      const Index at = static_cast<Index>(points.size());
      const double place = static_cast<double>(k);
      if (k % 4 != 0) {
        points.push_back(on_circle(place, 1.5));
        outer[k] = {at, at};
        continue;
      }
      points.push_back(on_circle(place - 0.2, 1.5));
      points.push_back(on_circle(place + 0.2, 1.5));
      outer[k] = {at, at + 1};
      if (quads) points.push_back(on_circle(place, 1.7));
      faces.add(quads ? std::vector<Index>{k, at, at + 2, at + 1} : std::vector<Index>{k, at, at + 1});
    }
    for (Index k = 0; k < n; ++k) faces.add(std::vector<Index>{(k + 1) % n, k, outer[k][1], outer[(k + 1) % n][0]});
    Points vertices(static_cast<Index>(points.size()), 3);
    for (std::size_t k = 0; k < points.size(); ++k) vertices.row(static_cast<Index>(k)) = points[k];
    const Mesh mesh{vertices, faces};
    std::vector<Index> rim(n);
    std::iota(rim.begin(), rim.end(), Index{0});
    CHECK(detect_corners(mesh, Connectivity(mesh), rim) == (quads ? std::vector<Index>{0, 4, 8} : std::vector<Index>{}));
  }
}
