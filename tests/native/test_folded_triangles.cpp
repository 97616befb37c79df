#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "tripatch/report/folded_triangles.h"

using namespace tripatch;

namespace {

/// Two triangles at the edge from 0 to 1; the second turned about it, so that the normals are `angle` degrees apart.
struct Hinge {
  Points vertices = Points::Zero(4, 3);
  Faces faces;
  explicit Hinge(double angle) {
    const double a = angle * std::numbers::pi / 180;
    vertices << 0, 0, 0, 1, 0, 0, 0.4, 1, 0, 0.3, -std::cos(a), -std::sin(a);
    faces.add(std::array<Index, 3>{0, 1, 2});
    faces.add(std::array<Index, 3>{1, 0, 3});
  }
  Index folded() const { return count_folded_edges(vertices, Points(0, 3), faces); }
};

}  // namespace

TEST_CASE("folds are counted at any size and for vertices of the mesh and new ones") {
  Hinge hinge(150);
  hinge.vertices *= 1e-100;
  CHECK(hinge.folded() == 1);
  CHECK(count_folded_edges(hinge.vertices.topRows(3), hinge.vertices.bottomRows(1), hinge.faces) == 1);
}

TEST_CASE("of more than two triangles at an edge each is compared with the first") {
  Hinge hinge(150);
  hinge.faces.add(std::array<Index, 3>{1, 0, 3});
  CHECK(hinge.folded() == 2);
  hinge.faces = {};
  for (int k = 0; k < 2; ++k) hinge.faces.add(std::array<Index, 3>{1, 0, 3});
  hinge.faces.add(std::array<Index, 3>{0, 1, 2});
  CHECK(hinge.folded() == 1);
}

TEST_CASE("a quad counts as a fan of two triangles, and a triangle without area folds over nothing") {
  Points square(4, 3);
  square << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0;
  Faces quad;
  quad.add(std::array<Index, 4>{0, 1, 2, 3});
  CHECK(count_folded_edges(square, Points(0, 3), quad) == 0);
  square.row(1) << 0.2, 0.7, 0;  // beyond the diagonal that the fan is cut along
  CHECK(count_folded_edges(square, Points(0, 3), quad) == 1);
  square.row(1) << 0.5, 0.5, 0;  // on it
  CHECK(count_folded_edges(square, Points(0, 3), quad) == 0);
}

TEST_CASE("quads begin where their shorter diagonal does, of two that are as long but for rounding where they began") {
  Points quad(4, 3);
  quad << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0;
  const auto first = [&](Index from) {
    Faces faces;
    faces.add(std::array<Index, 4>{from, (from + 1) % 4, (from + 2) % 4, (from + 3) % 4});
    faces.add(std::array<Index, 3>{1, 2, 3});
    begin_at_shorter_diagonals(quad.topRows(3), quad.bottomRows(1), faces);
    CHECK(faces[1][0] == 1);
    for (std::size_t k = 0; k < 4; ++k) CHECK(faces[0][k] == (faces[0][0] + static_cast<Index>(k)) % 4);
    return faces[0][0];
  };
  for (const double longer : {0.0, 1e-9}) {
    quad.row(2) << 1 + longer, 1 + longer, 0;
    for (Index from = 0; from < 4; ++from) CHECK(first(from) == from);
  }
  quad.row(2) << 1.1, 1.1, 0;
  for (Index from = 0; from < 4; ++from) CHECK(first(from) % 2 == 1);
}

TEST_CASE("a triangle that is folded back over the face beyond its rim edge counts, whichever way the edge is named") {
  for (double angle : {60.0, 119.9, 120.1, 180.0}) {
    Hinge hinge(angle);
    Faces old, made;
    old.add(hinge.faces[1]);
    made.add(hinge.faces[0]);
    const Mesh mesh{hinge.vertices, old};
    const Connectivity around(mesh);
    const std::vector<std::vector<Index>> loops = {{0, 1, 2}};
    const std::vector<AdjacentFace> beyond = faces_beyond(mesh, around, loops);
    REQUIRE(beyond.size() == 3);
    CHECK(beyond[0].normal.norm() == Approx(1));
    CHECK(beyond[1].normal.norm() == 0);
    CHECK(count_folded_edges(hinge.vertices, Points(0, 3), made) == 0);
    CHECK(count_folded_edges(hinge.vertices, Points(0, 3), made, beyond) == (angle > 120 ? 1 : 0));
    const std::vector<AdjacentFace> named = {{1, 0, 3 * beyond[0].normal}};
    CHECK(count_folded_edges(hinge.vertices, Points(0, 3), made, named) == (angle > 120 ? 1 : 0));
  }
}

TEST_CASE("faces beyond edges that the fill has not count for nothing, not even where one is named twice") {
  const Hinge hinge(150);
  Faces made;
  made.add(hinge.faces[0]);
  const Vec3 up(0, 0, 1);
  const std::vector<AdjacentFace> elsewhere = {{0, 3, -up}, {3, 0, up}, {1, 3, -up}};
  CHECK(count_folded_edges(hinge.vertices, Points(0, 3), made, elsewhere) == 0);
}

namespace {

/// Vertices of the mesh and faces: that beyond the edge from 0 to 1, one folded over it as a hinge of so many degrees, without area to
/// speak of, and others in the plane z = 0, whose normals are -z.
struct BesideRim {
  Points vertices = Points::Zero(8, 3);
  Faces faces;
  BesideRim(double degrees, double hinge) {
    const double a = degrees * std::numbers::pi / 180, b = hinge * std::numbers::pi / 180;
    vertices.topRows(7) << 0, 0, 0, 1, 0, 0, 0.5, std::cos(a), std::sin(a), -1, 0, 0, -1, 1, 0, 2, 0, 0, 2, 1, 0;
    const Vec3 start = vertices.row(0), end = vertices.row(2), other = vertices.row(1);
    const Vec3 along = (end - start).normalized(), up = along.cross(other - start).normalized(), in = up.cross(along);
    vertices.row(7) = 0.5 * (start + end) + 1e-4 * (-std::cos(b) * in + std::sin(b) * up);
    for (const std::array<Index, 3>& face : {std::array<Index, 3>{1, 0, 2}, {2, 0, 7}, {0, 3, 4}, {1, 6, 5}}) faces.add(face);
  }
  bool is_turned() const {
    const Mesh mesh{vertices, faces};
    const std::vector<char> turned = flipped(mesh, Connectivity(mesh), {{0, 1}});
    REQUIRE(turned.size() == 2);
    CHECK_FALSE(turned[1]);  // no face is there
    return turned[0] != 0;
  }
};

}  // namespace

TEST_CASE("a face beside the rim is turned over where it is folded over one beside it") {
  CHECK(BesideRim(150, 121).is_turned());
  CHECK_FALSE(BesideRim(150, 119).is_turned());
}

TEST_CASE("faces that face all ways do not tell whether one beside them is turned over") {
  const auto is_turned = [](double along) {  // faces of area 1 and of this one, against it and along it
    BesideRim rim(180, 150);
    rim.vertices.row(3) << -2, 0, 0;
    rim.vertices.row(5) << 1, 2 * along, 0;
    rim.vertices.row(6) << 2, 0, 0;
    return rim.is_turned();
  };
  CHECK(is_turned(0.32));
  CHECK_FALSE(is_turned(0.35));
}
