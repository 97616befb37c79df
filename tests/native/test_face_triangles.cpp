// Faces with many corners cut into triangles: none is turned over, whatever corner the face begins at.
#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>

#include "tripatch/triangulation/plane_triangles.h"

using namespace tripatch;

namespace {

Points rows(const std::vector<std::array<double, 2>>& corners, std::size_t first) {
  Points made(static_cast<Index>(corners.size()), 3);
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const auto [x, y] = corners[(first + k) % corners.size()];
    made.row(static_cast<Index>(k)) << x, 0.6 * y, 0.8 * y;  // in a plane askew
  }
  return made;
}

/// The least and the sum of the areas, with the sign that they have along the face's normal.
std::array<double, 2> areas(const Points& p, const Triangles& triangles) {
  double least = INFINITY, sum = 0;
  for (const auto& [a, b, c] : triangles) {
    const Vec3 u = p.row(b) - p.row(a), v = p.row(c) - p.row(a);
    const double area = 0.5 * u.cross(v).dot(Vec3(0, -0.8, 0.6));
    least = std::min(least, area);
    sum += area;
  }
  return {least, sum};
}

}  // namespace

TEST_CASE("concave faces, and such with corners in a line, are cut into triangles that cover them", "[face_triangles]") {
  struct Case {
    std::vector<std::array<double, 2>> corners;
    double area;
  };
  const std::vector<Case> cases = {
      {{{0, 0}, {1, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}, {0, 1}}, 3},  // an L of three squares
      {{{0, 0}, {1, 0.2}, {2, 0}, {1, 2}}, 1.8},                              // a dart
      {{{0, 0}, {1, 0}, {2, 0}, {3, 0}, {3, 1}, {0, 1}}, 3},                  // a box, two corners in a line
      {{{0, 0}, {4, 0}, {4, 1}, {3, 0.5}, {2, 0.3}, {1, 0.5}, {0, 1}}, 2.3},  // what a circle leaves of a box
  };
  for (const Case& each : cases)
    for (std::size_t first = 0; first < each.corners.size(); ++first) {
      const Points p = rows(each.corners, first);
      const Triangles made = triangulate_face(p);
      CHECK(made.size() == each.corners.size() - 2);
      const auto [least, sum] = areas(p, made);
      CHECK(least > 1e-3);
      CHECK(sum == Approx(each.area));
    }
}

TEST_CASE("convex faces are cut as a fan, quads along the shorter diagonal", "[face_triangles]") {
  CHECK(triangulate_face(rows({{0, 0}, {1, 0}, {1.2, 1}, {0, 1}}, 0)) == Triangles{{1, 2, 3}, {1, 3, 0}});
  CHECK(triangulate_face(rows({{0, 0}, {1, 0}, {0.8, 0.8}, {0, 1}}, 0)) == Triangles{{0, 1, 2}, {0, 2, 3}});
  CHECK(triangulate_face(rows({{0, 0}, {1, 0}, {1.5, 1}, {0.5, 2}, {-0.5, 1}}, 0)) == Triangles{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}});
}

TEST_CASE("a face that crosses itself, or has no area, is cut as a fan", "[face_triangles]") {
  CHECK(triangulate_face(rows({{0, 0}, {2, 1}, {2, 0}, {0, 1}, {-3, 0.5}}, 0)).size() == 3);
  CHECK(triangulate_face(Points::Zero(5, 3)) == Triangles{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}});
  CHECK(triangulate_face(Points::Constant(5, 3, NAN)).size() == 3);
}
