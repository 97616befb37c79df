// What counts as a fold, on both sides of its thresholds; those of kinks are in test_kinks.
#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>

#include "test_surfaces.h"
#include "tripatch/fairing/folds.h"
#include "tripatch/patch/bezier_triangle.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

/// The equilateral triangle in its plane, but bent by an angle (degrees) along the line b0 = at.
class Bent final : public Surface {
public:
  Bent(double at, double degrees) : at_(at), turn_(Eigen::AngleAxisd(degrees * std::numbers::pi / 180, Vec3::UnitX())) {}
  void evaluate(const double* b, Index n, int order, double* out) const override {
    const Eigen::Vector2d first(0, std::sqrt(0.75)), second(-0.5, 0), third(0.5, 0);  // corners; b0 runs along y
    for (Index k = 0; k < n; ++k, b += 3, out += 3 * jet_size(order)) {
      const Eigen::Vector2d p = b[0] * first + b[1] * second + b[2] * third;
      const bool beyond = b[0] > at_;
      const double y = at_ * first[1];
      const auto placed = [&](const Eigen::Vector2d& v, bool vector) -> Vec3 {
        if (!beyond) return Vec3(v[0], v[1], 0);
        return turn_ * Vec3(v[0], v[1] - (vector ? 0 : y), 0) + (vector ? Vec3(Vec3::Zero()) : Vec3(0, y, 0));
      };
      std::fill_n(out, 3 * jet_size(order), 0.0);
      Vec3::Map(out) = placed(p, false);
      if (order < 1) continue;
      Vec3::Map(out + 3) = placed(first - third, true);
      Vec3::Map(out + 6) = placed(second - third, true);
    }
  }

private:
  double at_;
  Eigen::Matrix3d turn_;
};

/// A surface whose corner 0 is another's corner k.
class Begun final : public Surface {
public:
  Begun(const Surface& surface, int k) : surface_(surface), k_(k) {}
  void evaluate(const double* b, Index n, int order, double* out) const override {
    for (Index m = 0; m < n; ++m, b += 3, out += 3 * jet_size(order)) {
      const std::array<double, 3> at = {b[k_], b[(k_ + 1) % 3], b[(k_ + 2) % 3]};
      surface_.evaluate(at.data(), 1, order, out);
      if (order < 1) continue;
      std::array<Vec3, 3> by = {Vec3::Map(out + 3), Vec3::Map(out + 6), Vec3::Zero()};
      std::rotate(by.begin(), by.begin() + (3 - k_) % 3, by.end());  // by b[0], b[1], b[2]
      Vec3::Map(out + 3) = by[0] - by[2];
      Vec3::Map(out + 6) = by[1] - by[2];
    }
  }

private:
  const Surface& surface_;
  int k_;
};

Sides flat_sides(double tilt_at_corner = 0) {
  const SurfacePtr flat =
      std::make_shared<BezierTriangle>((Points(3, 3) << 0, std::sqrt(0.75), 0, -0.5, 0, 0, 0.5, 0, 0).finished());
  Sides sides = sides_of(flat);
  // side 2 runs from corner 0 on: its planes turn about it, so that they differ from side 1's there
  const Vec3 axis = sides[2].c.derivative_at(0).normalized(), r = sides[2].r(0);
  const Vec3 turned = Eigen::AngleAxisd(tilt_at_corner * std::numbers::pi / 180, axis) * r;
  const std::array<double, 6> net = {turned[0], turned[1], turned[2], r[0], r[1], r[2]};
  sides[2].r = PiecewisePolynomial::bezier(net, 3);
  return sides;
}

}  // namespace

TEST_CASE("neighbors fold whose normals are 60 degrees apart", "[thresholds]") {
  const FoldCounter folds(flat_sides());
  CHECK(folds(Bent(0.5, 0)) == 0);
  CHECK(folds(Bent(0.5, 59.9)) == 0);
  CHECK(folds(Bent(0.5, 60.1)) > 50);
}

TEST_CASE("points fold whose normal is a right angle from the rim's", "[thresholds]") {
  const FoldCounter folds(flat_sides());
  const Index of_neighbors = folds(Bent(0.5, 89.9));
  CHECK(folds(Bent(0.5, 90.1)) > of_neighbors + 500);
}

TEST_CASE("beside a corner whose planes are a degree apart neighbors are not compared, a seventh of the way in they are",
          "[thresholds]") {
  for (const double tilt : {0.9, 1.1}) {
    const FoldCounter folds(flat_sides(tilt));
    CHECK((folds(Bent(0.87, 70)) > 0) == (tilt < 1));  // between rows of the grid
    CHECK(folds(Bent(0.835, 70)) > 0);
  }
}

TEST_CASE("neighbors of which one is beside such a corner are not compared, whichever corner it is", "[thresholds]") {
  const Sides sides = flat_sides(1.1);
  const Bent across(0.85, 70);  // between the last row that is compared and the first that is not
  for (int k = 0; k < 3; ++k) {
    Sides begun = sides;
    std::rotate(begun.begin(), begun.begin() + (3 - k) % 3, begun.end());
    CHECK(FoldCounter(begun)(Begun(across, k)) == 0);
    CHECK(FoldCounter(begun)(Begun(Bent(0.835, 70), k)) > 0);
  }
}
