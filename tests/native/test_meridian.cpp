// Curvature and planes of surroundings of revolution, read where they begin at a round rim.
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <numbers>

#include "tripatch/estimate/meridian.h"
#include "tripatch/fill/polygon_fill.h"

using namespace tripatch;

namespace {

using Curve = std::function<Vec2(double)>;  // radius and height by length from the rim on, the radius 1 there

/// Quads between circles about the z axis at these lengths, the first the rim; every second vertex but those of the rim is moved on along
/// the meridian by so many of the steps.
struct Turned {
  Turned(const Curve& curve, Index edges, const std::vector<double>& lengths, double uneven = 0)
      : vertices(edges * static_cast<Index>(lengths.size()), 3) {
    for (std::size_t j = 0; j < lengths.size(); ++j)
      for (Index k = 0; k < edges; ++k) {
        const double on = j > 0 && k % 2 == 1 ? uneven * (lengths[1] - lengths[0]) : 0;
        const Vec2 p = curve(lengths[j] + on);
        const double turn = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(edges);
        vertices.row(static_cast<Index>(j) * edges + k) << p[0] * std::cos(turn), p[0] * std::sin(turn), p[1];
      }
    for (Index j = 0; j + 1 < static_cast<Index>(lengths.size()); ++j)
      for (Index k = 0; k < edges; ++k)
        faces.add(std::vector<Index>{j * edges + (k + 1) % edges, j * edges + k, (j + 1) * edges + k,
                                     (j + 1) * edges + (k + 1) % edges});
    for (Index k = 0; k < edges; ++k) rim.push_back(k);
  }
  std::optional<Meridian> read() const {
    Hole hole;
    hole.rim = rim;
    const Mesh mesh{vertices, faces};
    return meridian_at(local_mesh(mesh, Connectivity(mesh.faces, vertices.rows()), hole));
  }

  Points vertices;
  Faces faces;
  std::vector<Index> rim;
};

std::vector<double> steps(int rings, double step) {
  std::vector<double> lengths;
  for (int j = 0; j <= rings; ++j) lengths.push_back(j * step);
  return lengths;
}

Curve graph(const std::function<double(double)>& z) {
  return [z](double s) { return Vec2(1 + s, z(1 + s)); };
}

/// Slope and curvature of the graph of a function at 1, seen from above.
double bend_of_graph(double first, double second) { return second / std::pow(1 + first * first, 1.5); }

const Curve hill = graph([](double r) { return std::exp(-0.6 * r * r); });
const double hill_first = -1.2 * std::exp(-0.6), hill_bend = bend_of_graph(hill_first, (1.44 - 1.2) * std::exp(-0.6));

}  // namespace

TEST_CASE("meridians of spheres, cones, tori and quadrics are exact from three uneven rings on") {
  struct Case {
    Curve curve;
    double first, bend;  // height over radius, and the curvature seen from above
  };
  const std::vector<Case> cases = {
      {graph([](double r) { return std::sqrt(4 - r * r); }), -1 / std::sqrt(3.0), -0.5},
      {graph([](double r) { return -0.6 * r; }), -0.6, 0},
      {graph([](double r) { return -0.7 * r * r; }), -1.4, bend_of_graph(-1.4, -1.4)},
      {graph([](double r) { return -std::sqrt(1 + 2 * r * r); }), -2 / std::sqrt(3.0),
       bend_of_graph(-2 / std::sqrt(3.0), -2 / std::pow(3, 1.5))},
      {[](double s) { return Vec2(1 + 0.8 * std::sin(s / 0.8), 0.8 * std::cos(s / 0.8)); }, 0, -1.25},
  };
  for (const Case& c : cases)
    for (Index edges : {12, 36}) {
      const double h = 3.0 / static_cast<double>(edges);
      const std::optional<Meridian> read = Turned(c.curve, edges, {0, h, 1.7 * h, 3 * h}).read();
      REQUIRE(read);
      CHECK(std::abs(read->curvature - c.bend) < 1e-9);
      const Vec3 n = Vec3(-c.first, 0, 1).normalized();
      CHECK((read->normal[0] - n).norm() < 1e-10);
      CHECK(read->slope_deviation < 1e-9);
      CHECK(read->curvature_deviation < 1e-8);
    }
}

TEST_CASE("the end of a cylinder is read where its normal is level") {
  const std::optional<Meridian> read = Turned([](double s) { return Vec2(1, -s); }, 24, steps(4, 0.3)).read();
  REQUIRE(read);
  CHECK((read->normal[0] - Vec3(1, 0, 0)).norm() < 1e-12);
  CHECK(std::abs(read->curvature) < 1e-10);
}

TEST_CASE("other meridians are read as well as is said, and better the finer the mesh") {
  double before = 1;
  for (Index edges : {12, 24, 48, 96}) {
    const std::optional<Meridian> read = Turned(hill, edges, steps(5, 3.0 / static_cast<double>(edges))).read();
    REQUIRE(read);
    const double off = std::abs(read->curvature - hill_bend);
    CHECK(off < 2 * read->curvature_deviation);
    CHECK(off < before / 3);
    before = off;
  }
  CHECK(before < 3e-4);
}

TEST_CASE("beyond where the curvature of a meridian jumps no vertex is taken") {
  const auto tube = [](double straight) {
    return Turned(
        [=](double s) {
          const double on = std::max(s - straight, 0.0);
          return Vec2(1 + 0.5 * (1 - std::cos(on / 0.5)), -std::min(s, straight) - 0.5 * std::sin(on / 0.5));
        },
        36, steps(6, 0.1));
  };
  const std::optional<Meridian> read = tube(0.3).read();
  REQUIRE(read);
  CHECK(std::abs(read->curvature) < 1e-10);
}
