#include "tripatch/constructions/methods.h"

#include "tripatch/annulus/annulus_patch.h"
#include "tripatch/constructions/barnhill_birkhoff_gordon.h"
#include "tripatch/constructions/coons_bezier.h"
#include "tripatch/constructions/gordon_coons.h"
#include "tripatch/constructions/gregory.h"
#include "tripatch/constructions/nielson_blend.h"
#include "tripatch/constructions/quintic.h"
#include "tripatch/constructions/side_vertex.h"
#include "tripatch/constructions/szilvasi_nagy.h"
#include "tripatch/constructions/triangular_coons.h"
#include "tripatch/fairing/fairing.h"
#include "tripatch/polygon/domain.h"

namespace tripatch {
namespace {

using Surfaces = std::array<SurfacePtr, 3>;

std::array<PiecewisePolynomial, 3> curves(const Boundary& boundary) {
  return {boundary.ribbons[0].c, boundary.ribbons[1].c, boundary.ribbons[2].c};
}

SurfacePtr szilvasi_nagy(const Surfaces& surfaces, int continuity, const MethodOptions& options) {
  SzilvasiNagyOptions own;
  own.continuity = continuity;
  own.optimal = !options.shape;
  if (options.shape) own.shape = of_three(*options.shape, "shape");
  own.as_printed = options.reading == Reading::as_printed;
  return std::make_shared<SzilvasiNagy>(surfaces, own);
}

/// A construction from the boundary alone, without options.
template <SurfacePtr (*Make)(const Boundary&)>
SurfacePtr plain(const Boundary& boundary, const MethodOptions&) {
  return Make(boundary);
}
template <SurfacePtr (*Make)(std::array<PiecewisePolynomial, 3>)>
SurfacePtr from_curves(const Boundary& boundary, const MethodOptions&) {
  return Make(curves(boundary));
}

const std::vector<std::string> slopes = {"cross_boundary", "bulge"}, lambda = {"shape", "reading"};
/// What only a patch between sides has.
const std::vector<std::string> of_sides = {"fairing", "tolerance", "pole_offset"};
std::vector<std::string> with(std::vector<std::string> names, const std::vector<std::string>& others) {
  names.insert(names.end(), others.begin(), others.end());
  return names;
}

const std::vector<Method> all = {
    {"gordon_coons",
     "Boolean sum of linear lofts between the curves",
     "Barnhill, Birkhoff and Gordon 1973; Szilvasi-Nagy and Szabo 2006",
     true,
     SeamContinuity::g0,
     {},
     from_curves<gordon_coons>,
     {}},
    {"triangular_coons",
     "Sum of the two curves at each corner, blended linearly",
     "Nielson, Thomas and Wixom 1978",
     true,
     SeamContinuity::g0,
     {},
     from_curves<triangular_coons>,
     {}},
    {"barnhill_birkhoff_gordon",
     "Boolean sum of cubic lofts with slopes",
     "Barnhill, Birkhoff and Gordon 1973",
     true,
     SeamContinuity::g1,
     slopes,
     plain<barnhill_birkhoff_gordon>,
     {}},
    {"nielson_blend", "Three surfaces, one for each side, blended by the side weights", "Nielson 1979; Szilvasi-Nagy 2003", true,
     SeamContinuity::g1, slopes, [](const Boundary& boundary, const MethodOptions&) { return nielson_blend(boundary); },
     [](const Surfaces& surfaces, const MethodOptions&) { return nielson_blend(surfaces); }},
    {"szilvasi_nagy_c0", "Coons-type blend of three surfaces with weights; meets positions",
     "Szilvasi-Nagy and Szabo 2006, Definition 1", true, SeamContinuity::g0, lambda,
     [](const Boundary& boundary, const MethodOptions& options) { return szilvasi_nagy(hole_surfaces(boundary, 0), 0, options); },
     [](const Surfaces& surfaces, const MethodOptions& options) { return szilvasi_nagy(surfaces, 0, options); }},
    {"szilvasi_nagy_c1",
     "Coons-type blend of three surfaces with weights; meets positions and tangent planes",
     "Szilvasi-Nagy and Szabo 2006, Definition 2",
     true,
     SeamContinuity::g1,
     {"cross_boundary", "bulge", "shape", "reading"},
     [](const Boundary& boundary, const MethodOptions& options) { return szilvasi_nagy(hole_surfaces(boundary, 1), 1, options); },
     [](const Surfaces& surfaces, const MethodOptions& options) { return szilvasi_nagy(surfaces, 1, options); }},
    {"side_vertex",
     "Three rays from the corners to the opposite sides, blended",
     "Nielson 1979; Hagen 1986",
     true,
     SeamContinuity::g1,
     slopes,
     [](const Boundary& boundary, const MethodOptions& options) {
       return options.to_be_faired ? curved_side_vertex(boundary) : side_vertex(boundary);
     },
     {},
     {3, 3},
     {"islands"}},  // inner points are met over a polygon of three sides
    {"quintic",
     "A quintic fitted to the boundary, plus a side-vertex patch of the remaining error",
     "Zhang, Ji and Yang 2005",
     true,
     SeamContinuity::g1,
     slopes,
     plain<quintic>,
     {}},
    {"gregory",
     "Three interpolants to two sides each, blended, without twist constraints",
     "Gregory 1974",
     true,
     SeamContinuity::g1,
     slopes,
     plain<gregory>,
     {}},
    {"coons_bezier",
     "Discrete Coons net: a Bezier triangle that is the Coons patch of the three sides",
     "Arnal and Lluch, Definition 1",
     true,
     SeamContinuity::g0,
     {"alpha"},
     [](const Boundary& boundary, const MethodOptions& options) {
       return coons_fill(boundary, options.alpha ? CoonsKind::permanence : CoonsKind::discrete, options.alpha, options.warnings);
     },
     {}},
    {"coons_extremal",
     "Bezier triangle with the least integral of |x_uv|^2 between the three sides",
     "Arnal and Lluch, Propositions 2 and 3",
     true,
     SeamContinuity::g0,
     {"symmetric"},
     [](const Boundary& boundary, const MethodOptions& options) {
       return coons_fill(boundary, options.symmetric ? CoonsKind::extremal_symmetric : CoonsKind::extremal);
     },
     {}},
    {"coons_mask",
     "Bezier triangle whose net satisfies the mask of the cubic extremals",
     "Arnal and Lluch, eq. 11",
     true,
     SeamContinuity::g0,
     {},
     [](const Boundary& boundary, const MethodOptions&) { return coons_fill(boundary, CoonsKind::mask); },
     {}},
    {polygon_method,
     "Exact patch between two to twelve sides, blended over a polygon",
     "Charrot and Gregory 1984",
     true,
     SeamContinuity::g1,
     slopes,
     {},
     {},
     {2, max_sides},
     {"islands"}},
    {spline_method,
     "Spline of the surrounding surface for any boundary, with an error estimate",
     "Duchon 1977; Wahba 1990",
     true,
     SeamContinuity::g1,
     {"bulge"},
     {},
     {},
     {0, 0},
     of_sides},
    {annulus_method,
     "A ring between two boundaries, tangent to both: ribs as circular arcs",
     "Hermite ribs; motions after Pottmann and Randrup 1998",
     true,
     SeamContinuity::g1,
     {"bulge"},
     {},
     {},
     {0, 0},
     with(of_sides, {"through", "cage_rim"})},
    {rows_method,
     "Rows of quads that continue across the hole, with least mixed differences",
     "Birkhoff and Gordon 1968",
     true,
     SeamContinuity::g1,
     {"bulge"},
     {},
     {},
     {4, 4},
     with(of_sides, {"continuity", "islands", "through", "resolution"})},
};

}  // namespace

std::span<const Method> methods() { return all; }

Continuity resolve_continuity(const BySide<SideContinuity>& asked, const Method& method, const Sides& sides) {
  const bool keeps_tangent = method.continuity != SeamContinuity::g0;
  check_count(asked, 3, "continuity");
  Continuity result;
  for (int i = 0; i < 3; ++i) {
    const bool exact = asked[i] == SideContinuity::g2;
    if (!keeps_tangent && (exact || asked[i] == SideContinuity::g1))
      throw CodedRefusal(Code::continuity_above_method,
                         {{"method", method.name}, {"kept", name_of(method.continuity)}, {"asked", name_of(asked[i])}});
    if (exact && sides[i].q.empty()) throw CodedRefusal(Code::curvature_unknown, {{"side", i}});
    result.free[i] = asked[i] == SideContinuity::free;
    result.tangent[i] = keeps_tangent && !result.free[i] && asked[i] != SideContinuity::g0;
    result.curvature[i] = exact;
    result.automatic[i] = keeps_tangent && asked[i] == SideContinuity::automatic;
  }
  return result;
}

std::array<SeamContinuity, 3> Continuity::kept() const {
  std::array<SeamContinuity, 3> out;
  for (int i = 0; i < 3; ++i)
    out[i] = free[i]        ? SeamContinuity::free
             : curvature[i] ? SeamContinuity::g2
             : tangent[i]   ? SeamContinuity::g1
                            : SeamContinuity::g0;
  return out;
}

FairingBase build(const Method& method, const Sides& sides, const RibbonOptions& ribbons, const MethodOptions& options) {
  Boundary boundary = make_boundary(sides, ribbons);
  SurfacePtr patch = method.from_boundary(boundary, options);
  return {sides, std::move(boundary), std::move(patch)};
}

const Method& find_method(const std::string& name) {
  for (const Method& method : methods())
    if (name == method.name) return method;
  std::vector<std::string> names;
  for (const Method& method : methods()) names.emplace_back(method.name);
  refuse_name("method", name, std::move(names));
}

}  // namespace tripatch
