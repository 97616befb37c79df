// The path of cages: holes whose surroundings overlap are fitted together.
#pragma once

#include <optional>
#include <variant>
#include <vector>

#include "tripatch/cage/sided_rim.h"
#include "tripatch/fill.h"
#include "tripatch/fill/fill_context.h"

namespace tripatch {

/// Layouts, the fairest cages on them, patches between their sides, the cages fitted to these.
std::vector<Fill> fill_with_cages(const FillContext& context, const std::vector<SidedRim>& holes, const FillOptions& options);

/// For several holes on all cores: those whose surroundings overlap are fitted together. given: those of the rims that are no refusals.
void fill_all_with_cages(const FillContext& context, const std::vector<std::optional<SidedRim>>& given,
                         const FillOptions& options, std::vector<std::variant<Fill, Refused>>& results, const Progress& progress);

/// The rim of a cage's hole: of the corners that are given, else of three where they are found, else of those that its quads make or
/// that are clear.
SidedRim cage_rim_of(const FillContext& context, const std::optional<std::vector<Index>>& rim, const Corners& corners);

}  // namespace tripatch
