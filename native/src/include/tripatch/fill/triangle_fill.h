// The path of three sides: what surrounds them, the patch between them, the faces on it, and how well all that fits.
#pragma once

#include "tripatch/boundary/surroundings.h"
#include "tripatch/cage/sided_rim.h"
#include "tripatch/fill/fill_context.h"
#include "tripatch/output/fill_result.h"

namespace tripatch {

/// The three sides of a hole, read for a patch.
struct TriangleInput {
  Hole hole;
  std::vector<double> angles;  ///< by side, as of sharp_sides
  std::vector<SideContinuity> continuity;
  Surroundings surroundings;
  double planes_error = 0;  ///< degrees; 0: a side meets the mesh in position only
};
/// Takes account of the options' continuity, method and surroundings.
TriangleInput triangle_input(const FillContext& context, Hole hole, const FillOptions& options);
Fill fill_with_patch(const FillContext& context, const TriangleInput& input, const FillOptions& options);

/// Angles by side of a hole with three corners, as of sharp_sides.
std::vector<double> sharp_sides_of(const FillContext& context, const Hole& hole);

/// The name of what makes a fill between corners.
const char* method_between(const SidedRim& hole, const FillOptions& options);
/// What is said of every fill between corners, whatever it is made of.
void complete_report(const SidedRim& hole, const FillOptions& options, Report& report);

}  // namespace tripatch
