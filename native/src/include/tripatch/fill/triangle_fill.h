// The path of three sides: what surrounds them, the patch between them, the faces on it, and how well all that fits.
#pragma once

#include "tripatch/cage/sided_rim.h"
#include "tripatch/fill/fill_context.h"
#include "tripatch/fill/polygon_fill.h"
#include "tripatch/output/fill_result.h"

namespace tripatch {

Fill fill_with_patch(const FillContext& context, Hole hole, const FillOptions& options, const PlanesEstimated& estimated = {});

/// Angles by side of a hole with three corners, as of sharp_sides.
std::vector<double> sharp_sides_of(const FillContext& context, const Hole& hole);

/// What is said of every fill between corners, whatever it is made of.
void complete_report(const SidedRim& hole, const FillOptions& options, Report& report);

}  // namespace tripatch
