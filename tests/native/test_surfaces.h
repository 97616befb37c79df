// Surfaces, sides and checks that the tests of all constructions share.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "tripatch/boundary/ribbon.h"
#include "tripatch/constructions/blend.h"
#include "tripatch/patch/surface.h"

namespace tripatch::testing {

/// A surface over the triangle from one formula on jets: F(b) -> JetPoint, for any order.
template <class F>
class FormulaSurface final : public Surface {
public:
  explicit FormulaSurface(F f) : f_(std::move(f)) {}
  void evaluate(const double* b, Index n, int order, double* out) const override {
    with_order<0, max_order>(order, [&](auto N) {
      for (Index k = 0; k < n; ++k) out = store(JetPoint<N.value>(f_(Barycentric<N.value>(b + 3 * k))), out);
    });
  }

private:
  F f_;
};
template <class F>
SurfacePtr formula_surface(F f) {
  return std::make_shared<FormulaSurface<F>>(std::move(f));
}

/// A Bezier triangle by its definition, the sum of control points times Bernstein polynomials, in the order (n,0,0), (n-1,1,0), ...
SurfacePtr bezier(const Points& net);

const std::array<Vec3, 3> plain_corners = {Vec3(0.1, 0, 0.05), Vec3(1.2, 0.3, -0.1), Vec3(0.4, 0.9, 0.2)};

/// A net of degree n over a triangle with these corners, its other points displaced at random by up to `size`.
Points random_net(int n, unsigned seed, double size = 0.15, const std::array<Vec3, 3>& corners = plain_corners);

std::array<double, 3> on_side(int i, double t);

/// A whole turn, in radians.
constexpr double whole = 2 * std::numbers::pi;

/// From one value to another at even speed.
PiecewisePolynomial line(const Vec3& a, const Vec3& b);

/// A straight side whose surroundings lie in the plane z = 0, as it does.
Side straight(const Vec3& a, const Vec3& b);

/// Position and derivative in a direction of the domain.
void sample(const Surface& surface, const double* b, const Vec3& v, Vec3& position, Vec3& derivative);

/// Side i of a surface. r is the outward derivative stretch(t) * (-delta_i) + skew(t) * (along the side): the surroundings in some
/// parameterisation of their own.
Side side_of(const Surface& surface, int i, std::function<double(double)> stretch = {}, std::function<double(double)> skew = {});

Sides sides_of(const std::array<SurfacePtr, 3>& surfaces);
Sides sides_of(const SurfacePtr& surface);

/// Three unrelated quartic patches with common corners; their tangent planes there differ ("incompatible" data).
std::array<SurfacePtr, 3> unrelated_surfaces(unsigned seed, double size = 0.12);

/// Three unrelated parameterisations of the surroundings.
Sides skewed_sides(const std::array<SurfacePtr, 3>& s);

/// A graph over the plain triangle in the plane.
SurfacePtr wave();

double size_of(const Sides& sides);

double degrees_between(const Vec3& a, const Vec3& b);

/// Largest distance to the sides, relative to the size.
double side_error(const Surface& patch, const Sides& sides);

/// Largest angle between the patch's tangent planes and the sides', degrees; not at the corners.
double seam_error(const Surface& patch, const Sides& sides, double margin = 0.01);

/// Points all over the triangle, corners and sides included.
Points grid(int n);

/// Largest distance between two surfaces at equal b.
double difference(const Surface& a, const Surface& b, int n = 15);

using Make = std::function<SurfacePtr(const Sides&)>;

Sides transformed(const Sides& sides, const Eigen::Matrix3d& linear, const Vec3& shift);

/// The same hole with corner order[k] as its k-th corner: an odd order traverses the rim the other way.
Sides relabelled(const Sides& sides, const std::array<int, 3>& order);

/// All six orders of the corners give the same surface.
double relabelling_error(const Make& make, const Sides& sides);

/// Rigid motions and scales from 1e-6 to 1e6 move the surface with its sides.
double motion_error(const Make& make, const Sides& sides);

/// Next to each corner on several rays: the position's distance from the corner relative to the distance in b, and the largest
/// first derivative, both relative to the size; throws the test if anything is not finite.
double corner_slope(const Surface& patch, const Sides& sides, int order = 3);

/// Angle between the patch's normals close to each corner and the corner's own plane, degrees; for data whose planes agree.
double corner_angle(const Surface& patch, const Sides& sides, double rho = 1e-5);

/// Exact derivatives against central differences of the order below, relative.
double derivative_error(const Surface& patch, int highest = 3);

/// What every construction that fills a hole promises. continuity: 0 position only, 1 also the tangent plane.
void check_promises(const Make& make, int continuity, bool symmetric = true);

/// Largest distance between what a method makes of the boundary of a random polynomial surface of this degree and that surface.
double reproduction_error(const Make& make, int degree);

}  // namespace tripatch::testing
