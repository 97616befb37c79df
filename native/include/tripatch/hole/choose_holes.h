// Which of a mesh's border loops are meant where nobody names them one by one.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "tripatch/types.h"

namespace tripatch {

using CountRange = std::array<int, 2>;  ///< least and most, both included

/// Documented in options.def.
struct HoleChoice {
#define HOLES_OPTION(type, name, value, ...) type name = value;
#include "tripatch/options.def"
};

/// The border loops of a mesh that are chosen, shortest first, each as find_holes has it.
std::vector<std::vector<Index>> choose_holes(const Mesh& mesh, const HoleChoice& choice = {});

}  // namespace tripatch
