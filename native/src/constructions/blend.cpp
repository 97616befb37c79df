#include "tripatch/constructions/blend.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tripatch/boundary/rectangle_surface.h"
#include "tripatch/boundary/side.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/patch/bezier_triangle.h"

namespace tripatch {
namespace {

class RationalTriangle final : public Surface {
public:
  RationalTriangle(Points weighted, Points weights) : weighted_(std::move(weighted)), weights_(std::move(weights)) {}

  void evaluate(const double* b, Index n, int order, double* out) const override {
    with_order<0, max_order>(order, [&](auto N) {
      constexpr Index stride = 3 * jet_size(N.value);
      std::vector<double> below(n * stride);
      weighted_.evaluate(b, n, order, out);
      weights_.evaluate(b, n, order, below.data());
      for (Index k = 0; k < n; ++k)
        store(reciprocal(load<N.value>(&below[k * stride]).x[0]) * load<N.value>(out + k * stride), out + k * stride);
    });
  }

private:
  BezierTriangle weighted_, weights_;
};

class TriangleOn final : public Surface {
public:
  TriangleOn(std::shared_ptr<const RectangleSurface> surface, const std::array<Vec2, 3>& corners,
             const std::array<Vec3, 3>& moved)
      : surface_(std::move(surface)), corners_(corners), moved_(moved) {}

  void evaluate(const double* b, Index n, int order, double* out) const override {
    std::vector<double> uv;
    const auto [from_u, to_u, from_v, to_v] = surface_->domain();
    for (Index k = 0; k < n; ++k) {
      const Vec2 at = b[3 * k] * corners_[0] + b[3 * k + 1] * corners_[1] + b[3 * k + 2] * corners_[2];
      uv.insert(uv.end(), {std::clamp(at[0], from_u, to_u), std::clamp(at[1], from_v, to_v)});  // rounding leaves the domain
    }
    surface_->evaluate(uv.data(), n, order, out);
    const Vec2 along0 = corners_[0] - corners_[2], along1 = corners_[1] - corners_[2];
    with_order<0, max_order>(order, [&](auto N) {
      const Substitution<N.value> substitution(along0[0], along1[0], along0[1], along1[1]);
      for (Index k = 0; k < n; ++k) {
        JetPoint<N.value> p = load<N.value>(out + k * 3 * jet_size(N.value));
        const Barycentric<N.value> at(&b[3 * k]);
        for (int x = 0; x < 3; ++x) {
          p.x[x] = substitution(p.x[x]);
          for (int i = 0; i < 3; ++i) p.x[x] += moved_[i][x] * at[i];
        }
        store(p, out + k * 3 * jet_size(N.value));
      }
    });
  }

private:
  std::shared_ptr<const RectangleSurface> surface_;
  std::array<Vec2, 3> corners_;
  std::array<Vec3, 3> moved_;
};

}  // namespace

SurfacePtr rational_triangle(const Points& net, const std::vector<double>& weights) {
  if (static_cast<Index>(weights.size()) != net.rows())
    throw CodedArgument(Code::wrong_shape, {{"name", "weights"},
                                            {"shape", "(" + std::to_string(net.rows()) + ",)"},
                                            {"given", "(" + std::to_string(weights.size()) + ",)"}});
  Points weighted = net, below = Points::Zero(net.rows(), 3);
  for (Index k = 0; k < net.rows(); ++k) {
    const std::string name = "weights[" + std::to_string(k) + "]";
    if (!std::isfinite(weights[k])) throw CodedArgument(Code::not_finite, {{"name", name}});
    if (!(weights[k] > 0)) throw CodedArgument(Code::out_of_range, {{"name", name}, {"above", 0}, {"value", weights[k]}});
    weighted.row(k) *= weights[k];
    below(k, 0) = weights[k];
  }
  return std::make_shared<RationalTriangle>(std::move(weighted), std::move(below));
}

SurfacePtr triangle_on(std::shared_ptr<const RectangleSurface> surface, const std::array<Vec2, 3>& corners,
                       const std::array<Vec3, 3>& moved) {
  const auto [from_u, to_u, from_v, to_v] = surface->domain();
  for (const Vec2& corner : corners)
    if (!(corner[0] >= from_u && corner[0] <= to_u && corner[1] >= from_v && corner[1] <= to_v))
      throw CodedArgument(Code::outside_domain, {{"name", "corners"}});
  return std::make_shared<TriangleOn>(std::move(surface), corners, moved);
}
std::vector<double> feet(const double* b, Index n, int i, const Vec3& direction) {
  std::vector<double> f(3 * n);
  for (Index k = 0; k < n; ++k)
    for (int x = 0; x < 3; ++x) f[3 * k + x] = x == i ? 0.0 : b[3 * k + x] - b[3 * k + i] * direction[x];
  return f;
}

std::array<Vec3, 3> common_corners(const std::array<SurfacePtr, 3>& surfaces) {
  const Points vertices = Points::Identity(3, 3);
  std::array<Points, 3> at;
  double size = 0;
  for (int i = 0; i < 3; ++i) {
    if (!surfaces[i]) throw InvalidArgument("surface " + std::to_string(i) + " is missing");
    at[i] = surfaces[i]->positions(vertices);
    if (!at[i].allFinite()) throw CodedArgument(Code::not_finite, {{"name", "r" + std::to_string(i)}});
    for (int k = 0; k < 3; ++k) size = std::max(size, (at[i].row(k) - at[i].row((k + 1) % 3)).norm());
  }
  std::array<Vec3, 3> corners;
  for (int k = 0; k < 3; ++k) {
    const int a = (k + 1) % 3, b = (k + 2) % 3;  // the two surfaces that carry the sides at corner k
    const double gap = (at[a].row(k) - at[b].row(k)).norm();
    if (!(gap <= tolerance::same * size))
      throw CodedArgument(Code::surfaces_apart,
                          {{"first", "r" + std::to_string(a)}, {"second", "r" + std::to_string(b)}, {"corner", k}, {"gap", gap}});
    corners[k] = at[a].row(k);
  }
  return corners;
}

}  // namespace tripatch
