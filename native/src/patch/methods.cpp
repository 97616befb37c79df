#include "tripatch/patch/methods.h"

#include <vector>

#include "tripatch/patch/coons_bezier.h"
#include "tripatch/patch/side_vertex.h"

namespace tripatch {

std::span<const Method> methods() {
  static const std::vector<Method> all = {
      {"side_vertex",
       "Three rays from the corners to the opposite sides, blended",
       "Nielson 1979; Hagen 1986",
       true,
       "G1",
       [](const Boundary& boundary, const MethodOptions&) { return side_vertex(boundary); },
       {}},
      {"coons_bezier",
       "Discrete Coons net: a Bezier triangle that is the Coons patch of the three sides",
       "Arnal and Lluch, Definition 1",
       true,
       "G0",
       [](const Boundary& boundary, const MethodOptions&) { return coons_fill(boundary, CoonsKind::discrete); },
       {}},
      {"coons_extremal",
       "Bezier triangle with the least integral of |x_uv|^2 between the three sides",
       "Arnal and Lluch, Propositions 2 and 3",
       true,
       "G0",
       [](const Boundary& boundary, const MethodOptions&) { return coons_fill(boundary, CoonsKind::extremal); },
       {}},
      {"coons_mask",
       "Bezier triangle whose net satisfies the mask of the cubic extremals",
       "Arnal and Lluch, eq. 11",
       true,
       "G0",
       [](const Boundary& boundary, const MethodOptions&) { return coons_fill(boundary, CoonsKind::mask); },
       {}},
  };
  return all;
}

std::pair<Boundary, SurfacePtr> build(const Method& method, const Sides& sides, const RibbonOptions& ribbons,
                                      const MethodOptions& options) {
  Boundary boundary = make_boundary(sides, ribbons);
  SurfacePtr patch = method.from_boundary(boundary, options);
  return {std::move(boundary), std::move(patch)};
}

const Method& find_method(const std::string& name) {
  std::string names;
  for (const Method& method : methods()) {
    if (name == method.name) return method;
    names += std::string(names.empty() ? "" : ", ") + method.name;
  }
  throw InvalidArgument("No method is called '" + name + "'; there are: " + names);
}

}  // namespace tripatch
