#include "tripatch/patch/methods.h"

#include <vector>

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
  };
  return all;
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
