#include "tripatch/fill/elsewhere.h"

#include <cmath>
#include <memory>

#include "tripatch/math/tolerances.h"
#include "tripatch/patch/moved_surface.h"
#include "tripatch/polygon/round.h"
#include "tripatch/polygon/surface.h"
#include "tripatch/spline/plane_patch.h"

namespace tripatch {
namespace {

/// Size of what is filled over its distance from the origin. Of less, coordinates have lost more than they can spare: second differences
/// of a rim of a hundred edges lose four digits more.
constexpr double least_size = tolerance::slight;

/// A patch of the same kind elsewhere.
SurfacePtr brought(const SurfacePtr& patch, const Vec3& by) {
  if (const auto polygon = std::dynamic_pointer_cast<const OverPolygon>(patch))
    return std::make_shared<OverPolygon>(polygon->domain(), moved(patch, by));
  if (const auto plane = std::dynamic_pointer_cast<const PlanePatch>(patch))
    return std::make_shared<PlanePatch>(moved(patch, by), plane->rim());
  if (const auto round = std::dynamic_pointer_cast<const RoundSurface>(patch)) {
    std::vector<Harmonic> terms = round->terms();
    terms[0].row(0) += by.transpose();
    return std::make_shared<RoundSurface>(std::move(terms));
  }
  return moved(patch, by);
}

}  // namespace

std::optional<Vec3> local_origin(const Mesh& mesh, std::span<const std::vector<Index>> rims) {
  Vec3 low = Vec3::Constant(INFINITY), high = -low;
  const auto take = [&](Index v) {
    const Vec3 p = mesh.vertices.row(v);
    if (!p.allFinite()) return;  // named later on, where it matters
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  };
  for (const std::vector<Index>& rim : rims)
    for (Index v : rim)
      if (v >= 0 && v < mesh.vertices.rows()) take(v);
  if (rims.empty())
    for (Index v = 0; v < mesh.vertices.rows(); ++v) take(v);
  const Vec3 middle = 0.5 * (low + high);
  if (!middle.allFinite() || (high - low).norm() >= least_size * middle.norm()) return {};
  return middle;
}

void Elsewhere::bring_back(Fill& fill) const {
  fill.vertices.rowwise() += origin.transpose();
  fill.moved_to.rowwise() += origin.transpose();
  if (fill.passes_through) *fill.passes_through += origin;
  if (fill.patch) fill.patch = brought(fill.patch, origin);
  for (Side& side : fill.sides) side.c = side.c + PiecewisePolynomial::constant(std::span<const double>(origin.data(), 3));
}

}  // namespace tripatch
