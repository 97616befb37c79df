// The registry: every construction by name. Whoever adds one adds its files and one line in methods.cpp.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <string>
#include <utility>

#include "tripatch/boundary/ribbon.h"
#include "tripatch/patch/surface.h"

namespace tripatch {

struct MethodOptions {
  std::array<double, 3> shape = {0.5, 0.5, 0.5};  ///< lambda, by side, in (0, 1)
  bool optimal_shape = false;
  bool as_printed = false;
};

struct Method {
  const char* name;
  const char* description;
  const char* citation;
  bool fills_holes;        ///< can be made from the three sides of a hole
  const char* continuity;  ///< "G0" or "G1": what it keeps along the sides
  /// From the boundary of a hole; empty where fills_holes is false.
  std::function<SurfacePtr(const Boundary&, const MethodOptions&)> from_boundary;
  /// From three surfaces over one triangle, surface i carries side i; empty where it does not apply.
  std::function<SurfacePtr(const std::array<SurfacePtr, 3>&, const MethodOptions&)> from_surfaces;
};

std::span<const Method> methods();
/// The patch of a method from three sides, with the boundary that it was made of.
std::pair<Boundary, SurfacePtr> build(const Method& method, const Sides& sides, const RibbonOptions& ribbons,
                                      const MethodOptions& options);
/// Throws InvalidArgument that lists the names.
const Method& find_method(const std::string& name);

}  // namespace tripatch
