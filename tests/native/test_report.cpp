#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "test_surfaces.h"
#include "tripatch/constructions/side_vertex.h"
#include "tripatch/fairing/folds.h"
#include "tripatch/mesh/triangles.h"
#include "tripatch/report/folded_triangles.h"
#include "tripatch/report/report.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

const std::array<Vec3, 3> flat_corner = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0.3, 0.8, 0)};

/// The flat triangle, moved in its plane by 27 b0 b1 b2 times `push` (b0 - b1): folds when pushed hard.
class Flat : public JetSurface<Flat> {
public:
  explicit Flat(double push = 0, double size = 1) : push_(push), size_(size) {}
  template <int N>
  JetPoint<N> at(const Barycentric<N>& b) const {
    JetPoint<N> p;
    for (int i = 0; i < 3; ++i) p += b[i] * JetPoint<N>(size_ * flat_corner[i]);
    return p + (27 * push_ * b[0] * b[1] * b[2] * (b[0] - b[1])) * JetPoint<N>(Vec3(1, 0, 0));
  }
  Vec3 corner(int i) const { return size_ * flat_corner[i]; }

private:
  double push_, size_;
};

/// The sides of the flat triangle, their surroundings raised by these slopes at the start and the end of each side.
Sides flat_sides(const std::array<std::array<double, 2>, 3>& slope) {
  Sides sides;
  for (int i = 0; i < 3; ++i) {
    const Vec3 a = flat_corner[(i + 1) % 3], b = flat_corner[(i + 2) % 3];
    const Vec3 away = (b - a).cross(Vec3::UnitZ()).normalized();
    sides[i].c = line(a, b);
    sides[i].r = line(away + slope[i][0] * Vec3::UnitZ(), away + slope[i][1] * Vec3::UnitZ());
  }
  return sides;
}

/// An arc of a circle around `axis`, and the derivative across it that is constant: a face of a cube or a cylinder next to it.
Sides arcs(const std::array<Vec3, 3>& across) {
  Sides sides;
  for (int i = 0; i < 3; ++i) {
    const Vec3 a = Vec3::Unit((i + 1) % 3), b = Vec3::Unit((i + 2) % 3);
    auto fit = [](auto f) {
      return PiecewisePolynomial::fit(
          [f](std::span<const double> t, std::span<double> out) {
            for (std::size_t k = 0; k < t.size(); ++k) Eigen::Map<Vec3>(out.data() + 3 * k) = f(t[k]);
          },
          3);
    };
    sides[i].c =
        fit([=](double t) -> Vec3 { return std::cos(t * std::numbers::pi / 2) * a + std::sin(t * std::numbers::pi / 2) * b; });
    sides[i].r = fit([=](double) -> Vec3 { return across[i]; });
  }
  return sides;
}

constexpr double degree = std::numbers::pi / 180;

}  // namespace

TEST_CASE("the seam angle is the tilt of the surroundings, by side") {
  const double a = std::tan(10 * degree), b = std::tan(30 * degree);
  Report report;
  measure_seam(Flat(), flat_sides({{{a, a}, {0, 0}, {-b, -b}}}), report);
  CHECK(report.seam_angle_max == Approx(30).epsilon(1e-12));
  CHECK(report.seam_angle_max_by_side[0] == Approx(10).epsilon(1e-12));
  CHECK(report.seam_angle_max_by_side[1] == 0);
  CHECK(report.seam_angle_rms_by_side[2] == Approx(30).epsilon(1e-12));
  CHECK(report.seam_angle_rms == Approx(std::sqrt((100.0 + 900.0) / 3)).epsilon(1e-12));
}

TEST_CASE("angles far below what acos can tell are measured") {
  Report report;
  measure_seam(Flat(), flat_sides({{{1e-9, 1e-9}, {0, 0}, {0, 0}}}), report);
  CHECK(report.seam_angle_max == Approx(1e-9 / degree).epsilon(1e-6));
}

TEST_CASE("ends of a side count only where the planes of the corner agree") {
  Report report;
  measure_seam(Flat(), flat_sides({{{1, 0}, {0, 0}, {0, 0}}}), report);  // 45 degrees at one end of side 0
  CHECK(report.seam_angle_max == Approx(std::atan(0.99) / degree).epsilon(1e-9));
  // a surface z = 0 but for a bump across the whole of side 0 that starts and ends flat: nothing is left out
  Sides sides = flat_sides({{{0, 0}, {0, 0}, {0, 0}}});
  const std::array<double, 9> bump = {0, 0, 0, 0, 0, 2, 0, 0, 0};
  sides[0].r = sides[0].r + PiecewisePolynomial::bezier(bump, 3);
  measure_seam(Flat(), sides, report, 201);
  CHECK(report.seam_angle_max == Approx(45).epsilon(1e-9));
  CHECK(report.seam_angle_max_by_side[1] == 0);
}

TEST_CASE("a patch that turns back is at 180 degrees") {
  Sides sides = flat_sides({{{0, 0}, {0, 0}, {0, 0}}});
  sides[1].r = -1.0 * sides[1].r;
  Report report;
  measure_seam(Flat(), sides, report);
  CHECK(report.seam_angle_max_by_side[1] == Approx(180));
  CHECK(report.seam_angle_max_by_side[0] == 0);
}

TEST_CASE("the side-vertex patch of a sphere octant meets it, ends included") {
  // across the equator of the sphere the derivative is the pole, everywhere
  const Sides sides = arcs({-Vec3::UnitX(), -Vec3::UnitY(), -Vec3::UnitZ()});
  Report report;
  const SurfacePtr patch = side_vertex(make_boundary(sides));
  measure_seam(*patch, sides, report);
  CHECK(report.seam_angle_max < 1e-5);
  CHECK(count_folds(*patch, sides) == 0);
}

TEST_CASE("a gap between sides that is small enough to be let through does not turn the patch at the corner") {
  Sides sides = arcs({-Vec3::UnitX(), -Vec3::UnitY(), -Vec3::UnitZ()});
  sides[0].c = sides[0].c + line(Vec3(3e-7, -2e-7, 1e-7), Vec3(0, 0, 2e-7));
  Report report;
  measure_seam(*side_vertex(make_boundary(sides)), sides, report);
  CHECK(report.seam_angle_max < 1e-4);
}

TEST_CASE("corners of a cube: planes at right angles are no folds") {
  std::array<Vec3, 3> across;  // every side lies on its face of the cube, which continues away from the hole
  for (int i = 0; i < 3; ++i) across[i] = Vec3::Unit((i + 1) % 3) + Vec3::Unit((i + 2) % 3);
  const Sides sides = arcs(across);
  const SurfacePtr patch = side_vertex(make_boundary(sides));
  Report report;
  measure_seam(*patch, sides, report);
  CHECK(report.seam_angle_max < 1e-4);
  CHECK(count_folds(*patch, sides) == 0);
}

TEST_CASE("folds are counted, and only folds") {
  const Sides sides = flat_sides({{{0, 0}, {0, 0}, {0, 0}}});
  CHECK(count_folds(Flat(), sides) == 0);
  CHECK(count_folds(Flat(0.1), sides) == 0);
  CHECK(count_folds(Flat(1), sides) > 10);
  Sides turned = sides;
  for (Side& side : turned) side.r = -1.0 * side.r;
  CHECK(count_folds(Flat(), turned) == 65 * 66 / 2 - 3);
}

TEST_CASE("a fill is flawed that folds more than its rim, crosses itself or misses its boundary") {
  Report report;
  report.triangles_folded = report.rim_folded = 2;
  report.continuity = {SeamContinuity::g1};
  CHECK(!is_flawed(report));
  Report folds = report, crosses = report, misses = report;
  folds.triangles_folded = 3;
  crosses.crosses_itself = true;
  misses.continuity.push_back(SeamContinuity::none);
  CHECK(is_flawed(folds));
  CHECK(is_flawed(crosses));
  CHECK(is_flawed(misses));
}

TEST_CASE("a patch without area gives finite numbers") {
  const Sides sides = flat_sides({{{0, 0}, {0, 0}, {0, 0}}});
  Report report;
  measure_seam(Flat(0, 0), sides, report);
  CHECK(report.seam_angle_max == 90);
  CHECK(count_folds(Flat(0, 0), sides) == 65 * 66 / 2 - 3);
}

TEST_CASE("triangles of a disc are measured alike whether their border is known or looked for") {
  // a fan round vertex 4, whose middle lies where it may fold or cross the rest
  for (const Vec3& middle : {Vec3(0.5, 0.5, 0.2), Vec3(3, 0.5, 0), Vec3(0.5, 0.5, -40), Vec3(0.2, 5, 0.1)}) {
    Points points(5, 3);
    points << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, middle.transpose();
    const Faces faces = faces_of({{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}});
    std::vector<AdjacentFace> beyond;
    for (Index k = 0; k < 4; ++k) beyond.push_back({k, (k + 1) % 4, Vec3(0, 0, 1)});
    Report looked_for, known;
    known.triangles_folded = 7;
    known.crosses_itself = true;
    measure_faces({points.topRows(4), Faces()}, points.bottomRows(1), faces, beyond, looked_for);
    measure_faces({points.topRows(4), Faces()}, points.bottomRows(1), faces, beyond, known, {2, 3, 0, 1});
    CHECK(known.triangles_folded == looked_for.triangles_folded);
    CHECK(known.crosses_itself == looked_for.crosses_itself);
  }
}

TEST_CASE("where faces cross is found with quads cut as they are measured: along the shorter diagonal") {
  // a quad that begins at its longer diagonal, at z = 0; the shorter lies at z = 1, where a needle goes through
  Points points(7, 3);
  points << -2, 0, 0, 0, -1, 1, 2, 0, 0, 0, 1, 1, 0.1, 0, 0.5, 0.1, 0.1, 1.5, -0.1, 0.1, 1.5;
  Faces faces;
  faces.add(std::array<Index, 4>{0, 1, 2, 3});
  faces.add(std::array<Index, 3>{4, 5, 6});
  const Mesh mesh = {points, Faces()};
  Report report;
  measure_faces(mesh, Points(0, 3), faces, {}, report);
  CHECK(report.crosses_itself);
  const auto where = place_of_crossing(mesh, Points(0, 3), faces);
  REQUIRE(where);
  CHECK((*where - Vec3(0, 0, 1)).norm() < 0.2);
  points.bottomRows(3).col(2).array() += 2;
  CHECK(!place_of_crossing({points, Faces()}, Points(0, 3), faces));
}
