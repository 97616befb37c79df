// The registry: every construction by name. Whoever adds one adds its files and one line in methods.cpp.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tripatch/boundary/ribbon.h"
#include "tripatch/messages.h"
#include "tripatch/patch/surface.h"
#include "tripatch/report/report.h"

namespace tripatch {

struct FairingBase;

/// Options of single constructions, documented in options.def; the others do not read them.
struct MethodOptions {
#define METHOD_OPTION(type, name, value, ...) type name = value;
#include "tripatch/options.def"
  bool to_be_faired = false;     ///< side_vertex: with rays of degree 5, see curved_side_vertex
  Messages* warnings = nullptr;  ///< where a construction says what its user should know
};

struct Method {
  const char* name;
  const char* description;
  const char* citation;
  bool fills_holes;                  ///< can be made from the three sides of a hole, or from its surroundings whatever its rim
  SeamContinuity continuity;         ///< g0 or g1: what it keeps along the sides
  std::vector<std::string> options;  ///< names of the options of `fill` that it reads and not every method does
  /// From the boundary of a hole; none where fills_holes is false.
  SurfacePtr (*from_boundary)(const Boundary&, const MethodOptions&);
  /// From three surfaces over one triangle, surface i carries side i; none where it does not apply.
  SurfacePtr (*from_surfaces)(const std::array<SurfacePtr, 3>&, const MethodOptions&);
  /// The fewest and the most sides of what it fills; {0, 0}: rims with any number of corners, from the surroundings alone.
  std::array<int, 2> sides = {3, 3};
  /// Names of options of `fill` that it does not read and most methods do; those that single methods read need not be named.
  std::vector<std::string> lacks = {"islands", "through"};
};

/// What `method` is called where the rim decides.
constexpr const char* automatic_method = "auto";
/// The method for any rim, see spline/plane_fill.h.
constexpr const char* spline_method = "polyharmonic_spline";
/// Rows of quads that continue across a hole, see grid/continued_rows.h.
constexpr const char* rows_method = "quad_rows";
/// The patch between any number of sides, see polygon/patch.h; between three it is that of patch_method.
constexpr const char* polygon_method = "multi_sided";
/// What "auto" takes for three smooth sides.
constexpr const char* patch_method = "side_vertex";

/// What a patch keeps along each side.
struct Continuity {
  std::array<bool, 3> free;       ///< position only, the slope is left to the energy
  std::array<bool, 3> tangent;    ///< the surroundings' tangent planes
  std::array<bool, 3> curvature;  ///< and their curvature, exactly
  std::array<bool, 3> automatic;  ///< a fairing chooses whether to follow their curvature
  /// Free, G0, G1 or G2, by side.
  std::array<SeamContinuity, 3> kept() const;
};
/// asked: by side; "auto" takes the method's own. Refuses more than the method keeps, and G2 where the
/// surroundings' curvature is not known.
Continuity resolve_continuity(const BySide<SideContinuity>& asked, const Method& method, const Sides& sides);

std::span<const Method> methods();
/// The patch of a method from three sides, with what it was made of.
FairingBase build(const Method& method, const Sides& sides, const RibbonOptions& ribbons, const MethodOptions& options);
/// Throws InvalidArgument that lists the names.
const Method& find_method(const std::string& name);

}  // namespace tripatch
