// NURBS and Bezier surfaces from any numbers, and patches between their edges: refused in words, or finite.
#include <cmath>
#include <optional>

#include "bytes.h"
#include "tripatch/boundary/bezier_rectangle.h"
#include "tripatch/boundary/nurbs_surface.h"
#include "tripatch/boundary/ribbon.h"
#include "tripatch/fill.h"
#include "tripatch/math/jet.h"
#include "tripatch/patch/bezier_triangle.h"
#include "tripatch/patch_from_sides.h"

using namespace tripatch;
using fuzz::Bytes;
using fuzz::require;

namespace {

Points net(Bytes& bytes, Index rows) {
  Points points(rows, 3);
  for (Index k = 0; k < rows; ++k) points.row(k) = bytes.point();
  return points;
}

std::vector<double> knots(Bytes& bytes, Index count, int degree) {
  std::vector<double> k(count + degree + 1);
  if (bytes.flag()) {  // clamped, evenly spaced
    for (std::size_t j = 0; j < k.size(); ++j)
      k[j] = std::min<double>(std::max<double>(double(j) - degree, 0), double(count - degree));
    if (bytes.seldom(4)) k[bytes.byte() % k.size()] = bytes.number();
    return k;
  }
  double last = 0;
  for (double& value : k) value = last += bytes.seldom(8) ? bytes.number() : double(bytes.byte() % 3);
  return k;
}

/// Values and derivatives over the domain, ends and middles. reasonable: no number in it is so large that derivatives overflow.
void check_rectangle(const RectangleSurface& surface, bool reasonable) {
  const auto [u0, u1, v0, v1] = surface.domain();
  std::vector<double> uv;
  for (double s : {0.0, 0.3, 1.0})
    for (double t : {0.0, 0.7, 1.0}) uv.insert(uv.end(), {s == 1 ? u1 : u0 + s * (u1 - u0), t == 1 ? v1 : v0 + t * (v1 - v0)});
  for (int order : {0, 2, 4}) {
    std::vector<double> out(9 * jet_size(order) * 3);
    surface.evaluate(uv.data(), 9, order, out.data());
    for (double value : out) require(!reasonable || std::isfinite(value), "a surface is not finite");
  }
}

bool is_reasonable(const Points& points) { return points.allFinite() && points.cwiseAbs().maxCoeff() < 1e30; }

std::unique_ptr<RectangleSurface> take_nurbs(Bytes& bytes, bool& reasonable) {
  const int pu = 1 + bytes.byte() % 4, pv = 1 + bytes.byte() % 4;
  const Index nu = pu + 1 + bytes.byte() % 3, nv = pv + 1 + bytes.byte() % 3;
  Points points = net(bytes, nu * nv);
  std::vector<double> weights(bytes.flag() ? nu * nv : 0, 1.0);
  for (double& w : weights)
    if (bytes.seldom(3)) w = bytes.number();
  std::vector<double> ku = knots(bytes, nu, pu), kv = knots(bytes, nv, pv);
  reasonable = is_reasonable(points);
  for (double w : weights) reasonable = reasonable && w > 1e-6 && w < 1e6;
  for (const auto* k : {&ku, &kv})
    for (std::size_t j = 1; j < k->size(); ++j) {
      const double step = (*k)[j] - (*k)[j - 1];
      reasonable = reasonable && (step == 0 || step > 1e-6) && std::abs((*k)[j]) < 1e6;
    }
  if (bytes.seldom(16)) ku.resize(bytes.byte() % 40);
  if (bytes.seldom(16)) points.conservativeResize(bytes.byte() % 40, 3);
  if (!points.allFinite()) reasonable = false;
  return std::make_unique<NurbsSurface>(points, nu, nv, weights, ku, kv);
}

std::unique_ptr<RectangleSurface> take_rectangle(Bytes& bytes, bool& reasonable) {
  if (bytes.flag()) return take_nurbs(bytes, reasonable);
  const int m = 1 + bytes.byte() % 4, n = 1 + bytes.byte() % 4;
  const Points points = net(bytes, Index(m + 1) * (n + 1));
  reasonable = is_reasonable(points);
  return std::make_unique<BezierRectangle>(points, m, n);
}

/// How far from the origin a side goes: what is rounding of it, is so at its ends too.
double reach(const Side& side) {
  double most = 0;
  for (int k = 0; k <= 20; ++k) most = std::max(most, side.c(k / 20.0).norm());
  return most;
}

/// How large the derivatives are that patches take across the sides: what is added up of them keeps fifteen digits of these.
double steepness(const Sides& sides) {
  double most = 0;
  const Boundary boundary = make_boundary(sides);
  for (const Ribbon& ribbon : boundary.ribbons)
    for (int k = 0; k <= 20; ++k) most = std::max(most, Vec3(ribbon.d(k / 20.0)).norm());
  return most;
}

/// Edges of surfaces as the sides of a hole, their ends brought together.
void check_patch(Bytes& bytes, std::vector<Side> found) {
  Sides sides = {found[0], found[1], found[2]};
  if (!bytes.seldom(6)) {
    const std::array<Vec3, 3> corners = {bytes.point(), bytes.point(), bytes.point()};
    for (int i = 0; i < 3; ++i)
      sides[i] = moved_ends(sides[i], corners[(i + 1) % 3] - sides[i].c(0), corners[(i + 2) % 3] - sides[i].c(1));
  }
  FillOptions options;
  options.method = methods()[bytes.byte() % methods().size()].name;
  if (bytes.flag()) options.fairing.reset();
  const MadePatch made = patch_from_sides(sides, options);
  const double size = std::max({reach(sides[0]), reach(sides[1]), reach(sides[2])});
  const double rounding = 1e-5 * (1 + size) + 1e-14 * steepness(sides);
  for (int i = 0; i < 3; ++i)
    for (double t : {0.0, 0.4, 1.0}) {
      std::array<double, 3> b = {0, 0, 0};
      b[(i + 1) % 3] = 1 - t;
      b[(i + 2) % 3] = t;
      const Vec3 p = made.patch->positions(Eigen::Map<const Points>(b.data(), 1, 3)).row(0);
      require(p.allFinite(), "a patch is not finite");
      const Vec3 q = sides[i].c(t);
      const bool met = (p - q).norm() <= rounding || !std::isfinite(size);
      require(met, ("a patch by " + options.method + " does not meet its side").c_str());
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Bytes bytes(data, size);
  std::vector<Side> sides;
  for (int k = 0; k < 3; ++k) {
    try {
      if (bytes.seldom(3)) {
        const int degree = bytes.byte() % 6;
        const Points points = net(bytes, bytes.seldom(16) ? bytes.byte() % 30 : BezierTriangle::net_size(degree));
        const BezierTriangle triangle(points);
        Points b(3, 3);
        b << 1, 0, 0, 0.2, 0.3, 0.5, 0, 1, 0;
        std::vector<double> out(3 * jet_size(3) * 3);
        triangle.evaluate(b.data(), 3, 3, out.data());
        for (double value : out) require(!is_reasonable(points) || std::isfinite(value), "a Bezier triangle is not finite");
        sides.push_back(side_of(triangle, bytes.byte() % 3, bytes.flag()));
        continue;
      }
      bool reasonable = true;
      const auto surface = take_rectangle(bytes, reasonable);
      check_rectangle(*surface, reasonable);
      const bool reversed = bytes.flag();
      sides.push_back(surface->side(bytes.byte() % 4, reversed));
    } catch (const Refusal&) {
    } catch (const InvalidArgument&) {
    }
  }
  if (sides.size() < 3) return 0;
  try {
    check_patch(bytes, std::move(sides));
  } catch (const Refusal&) {
  } catch (const InvalidArgument&) {
  }
  return 0;
}
