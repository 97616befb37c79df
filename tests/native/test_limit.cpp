#include <atomic>
#include <catch2/catch.hpp>
#include <future>
#include <numbers>
#include <numeric>
#include <vector>

#include "tripatch/boundary/limit_surface.h"
#include "tripatch/cage/limit_points.h"

using namespace tripatch;

namespace {

struct Cage {
  Points vertices;
  Faces faces;
  Mesh mesh() const { return {vertices, faces}; }
};

/// The cube from -1 to 1, vertex v at the signs of its three bits; with or without its last face (z = 1).
Cage cube(bool closed) {
  Cage cage;
  cage.vertices.resize(8, 3);
  for (int v = 0; v < 8; ++v) cage.vertices.row(v) << (v & 1 ? 1 : -1), (v & 2 ? 1 : -1), (v & 4 ? 1 : -1);
  const std::vector<std::vector<Index>> faces = {{0, 2, 3, 1}, {0, 1, 5, 4}, {1, 3, 7, 5},
                                                 {3, 2, 6, 7}, {2, 0, 4, 6}, {4, 5, 7, 6}};
  for (std::size_t f = 0; f < (closed ? 6 : 5); ++f) cage.faces.add(faces[f]);
  return cage;
}

double largest_difference(const Points& a, const Points& b) { return (a - b).cwiseAbs().maxCoeff(); }

}  // namespace

TEST_CASE("limit points of a cube: the mask (n^2 v + 4 sum e + sum f) / (n (n + 5)) at valence 3 halves it") {
  const Cage cage = cube(true);
  CHECK(largest_difference(limit_points(cage.mesh()), 0.5 * cage.vertices) < 1e-15);
}

TEST_CASE("limit points on a border: the cubic B-spline mask (a + 4 v + b) / 6") {
  const Cage cage = cube(false);
  const Points limit = limit_points(cage.mesh());
  const auto border = {std::array{4, 5, 6}, std::array{5, 7, 4}, std::array{7, 6, 5}, std::array{6, 4, 7}};
  for (const auto& [v, a, b] : border) {
    const Vec3 expected = (cage.vertices.row(a) + 4 * cage.vertices.row(v) + cage.vertices.row(b)) / 6;
    CHECK((limit.row(v).transpose() - expected).norm() < 1e-15);
  }
}

TEST_CASE("limit points are invariant under affine maps, with triangles and a loose vertex in the cage") {
  Cage cage = cube(true);
  cage.vertices.conservativeResize(10, 3);
  cage.vertices.row(8) << 0.2, -0.1, 2.5;  // an apex over the top face
  cage.vertices.row(9) << 7, 8, 9;         // in no face
  Faces faces;
  for (Index f = 0; f < 5; ++f) faces.add(cage.faces[f]);
  for (const std::vector<Index>& roof : {std::vector<Index>{4, 5, 8}, {5, 7, 8}, {7, 6, 8}, {6, 4, 8}}) faces.add(roof);
  cage.faces = faces;
  const Points limit = limit_points(cage.mesh());
  CHECK((limit.row(9) - cage.vertices.row(9)).norm() == 0);

  Eigen::Matrix3d a;
  a << 1, 2, -0.5, 0.3, 1, 4, -1, 0, 2;
  const Eigen::RowVector3d shift(10, -20, 30);
  const Points mapped = (cage.vertices * a.transpose()).rowwise() + shift;
  CHECK(largest_difference(limit_points({mapped, cage.faces}), (limit * a.transpose()).rowwise() + shift) < 1e-13);
}

TEST_CASE("limit points refuse faces that are none") {
  Cage cage = cube(true);
  const std::vector<Index> outside = {0, 1, 8};
  cage.faces.add(outside);
  CHECK_THROWS_AS(limit_points(cage.mesh()), InvalidArgument);
  cage = cube(true);
  const std::vector<Index> edge = {0, 1};
  cage.faces.add(edge);
  CHECK_THROWS_AS(limit_points(cage.mesh()), InvalidArgument);
}

TEST_CASE("on several threads at once each cage is refused for its own reason") {
  // OpenSubdiv takes faces of up to 65535 corners, and says how many it was given.
  std::array<Cage, 2> cages;
  for (int k = 0; k < 2; ++k) {
    std::vector<Index> ring(66'000 + 1000 * k);
    std::iota(ring.begin(), ring.end(), Index{0});
    cages[k].vertices = Points::Random(static_cast<Index>(ring.size()), 3);
    cages[k].faces.add(ring);
  }
  const auto reason = [](const Cage& cage) -> std::string {
    try {
      LimitSurface(cage.mesh(), {});
    } catch (const Refusal& refusal) {
      return refusal.what();
    }
    return "taken";
  };
  const std::array<std::string, 2> alone = {reason(cages[0]), reason(cages[1])};
  CHECK(alone[0].find("66000") != std::string::npos);
  CHECK(alone[1].find("67000") != std::string::npos);
  std::atomic<int> mixed = 0;
  std::vector<std::future<void>> threads;
  for (int k = 0; k < 4; ++k)
    threads.push_back(std::async(std::launch::async, [&, k] {
      for (int trial = 0; trial < 20; ++trial) mixed += reason(cages[k % 2]) != alone[k % 2];
    }));
  for (std::future<void>& thread : threads) thread.get();
  CHECK(mixed == 0);
}

TEST_CASE("the limit surface of a cage of triangles goes with the cage however far it is moved") {
  Cage cage = cube(false);
  cage.vertices.conservativeResize(9, 3);
  cage.vertices.row(8) << 0.2, -1.9, 0.3;
  Faces faces;
  for (Index f = 0; f < 5; ++f)
    if (f == 1)
      for (int k = 0; k < 4; ++k) faces.add(std::vector<Index>{cage.faces[f][k], cage.faces[f][(k + 1) % 4], 8});
    else
      for (int k : {1, 2}) faces.add(std::vector<Index>{cage.faces[f][0], cage.faces[f][k], cage.faces[f][k + 1]});
  cage.faces = faces;
  const Eigen::RowVector3d by(1e6, -2e6, 5e5);
  const Points away = cage.vertices.rowwise() + by;
  const std::vector<double> t = {0, 0.3, 0.5, 1};
  for (const std::optional<int> quality : {std::optional<int>(3), std::optional<int>()}) {
    Subdivision settings;
    settings.quality = quality;
    const LimitSurface here(cage.mesh(), settings), there({away, cage.faces}, settings);
    double largest = 0, slopes = 0;
    for (Index f = 0; f < cage.faces.size(); ++f)
      for (int edge = 0; edge < 3; ++edge) {
        std::vector<LimitJet> a(t.size()), b(t.size());
        here.evaluate_edge(f, edge, t, a);
        there.evaluate_edge(f, edge, t, b);
        for (std::size_t k = 0; k < t.size(); ++k) {
          largest = std::max(largest, (b[k].p - a[k].p - by.transpose()).norm());
          slopes = std::max({slopes, (b[k].pu - a[k].pu).norm(), (b[k].pv - a[k].pv).norm()});
        }
      }
    INFO("true limit: " << !quality);
    CHECK(largest < 1e-8);  // the coordinates' own rounding is a fiftieth of it
    CHECK(slopes < 1e-5);   // of the true limit, over pieces of a thousandth of an edge
  }
  LimitSurface surface(cage.mesh(), Subdivision{});
  for (Index f = 0; f < cage.faces.size(); ++f) {
    const std::vector<FacePlace> places = {{0, 0, 0}, {1, 0.2, 0.7}, {2, 1, 1}};
    const LimitStencils stencils = surface.stencils(f, places);
    CHECK((stencils.p.rowwise().sum().array() - 1).abs().maxCoeff() < 1e-13);
    CHECK(stencils.pu.rowwise().sum().cwiseAbs().maxCoeff() < 1e-12);
    CHECK(stencils.pv.rowwise().sum().cwiseAbs().maxCoeff() < 1e-12);
  }
}

TEST_CASE("an edge between faces of three, four and five corners is one curve from both, with one tangent plane") {
  // a prism of five sides with a roof of triangles
  Cage cage;
  cage.vertices.resize(11, 3);
  for (int k = 0; k < 5; ++k) {
    const double angle = 2 * std::numbers::pi * k / 5;
    cage.vertices.row(k) << 1.3 * std::cos(angle), std::sin(angle), -1;
    cage.vertices.row(k + 5) << 1.1 * std::cos(angle), std::sin(angle) + 0.2, 1;
  }
  cage.vertices.row(10) << 0.1, 0.3, 1.7;
  cage.faces.add(std::vector<Index>{4, 3, 2, 1, 0});
  for (Index k = 0; k < 5; ++k) {
    cage.faces.add(std::vector<Index>{k, (k + 1) % 5, 5 + (k + 1) % 5, 5 + k});
    cage.faces.add(std::vector<Index>{5 + k, 5 + (k + 1) % 5, 10});
  }
  const std::vector<double> t = {0.05, 0.25, 0.4, 0.6, 0.75, 0.95}, back(t.rbegin(), t.rend());
  for (const std::optional<int> quality : {std::optional<int>(5), std::optional<int>()}) {
    INFO("true limit: " << !quality);
    Subdivision settings;
    settings.quality = quality;
    const LimitSurface surface(cage.mesh(), settings);
    const Connectivity around(cage.mesh());
    for (Index f = 0; f < cage.faces.size(); ++f)
      for (std::size_t k = 0; k < cage.faces[f].size(); ++k) {
        const Index a = cage.faces[f][k], b = cage.faces[f][(k + 1) % cage.faces[f].size()];
        const auto other = around.edge(b, a);
        REQUIRE(other);
        std::vector<LimitJet> here(t.size()), there(t.size());
        surface.evaluate_edge(f, static_cast<int>(k), t, here);
        surface.evaluate_edge(around.face(*other), static_cast<int>(around.place(*other)), back, there);
        for (std::size_t i = 0; i < t.size(); ++i) {
          CHECK((here[i].p - there[i].p).norm() < 1e-3);
          CHECK(here[i].pu.normalized().dot(there[i].pu.normalized()) < -0.999);
          CHECK(here[i].pu.cross(here[i].pv).normalized().dot(there[i].pu.cross(there[i].pv).normalized()) > 0.99);
        }
      }
  }
}

TEST_CASE("stencils exist for every quality there is, and no other is taken") {
  Cage cage = cube(false);
  for (const int quality : {1, 2, 9, 10}) {
    Subdivision settings;
    settings.quality = quality;
    const LimitStencils stencils = LimitSurface(cage.mesh(), settings).stencils(0, std::vector<FacePlace>{{0, 0.01, 0.02}});
    CHECK((stencils.p.rowwise().sum().array() - 1).abs().maxCoeff() < 1e-13);
  }
  for (const int quality : {-1, 0, 11, 15}) {
    Subdivision settings;
    settings.quality = quality;
    CHECK_THROWS_AS(LimitSurface(cage.mesh(), settings), InvalidArgument);
  }
}
