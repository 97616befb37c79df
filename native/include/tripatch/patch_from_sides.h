// From three sides to a patch: the construction, made fair, meeting the curvature where that is asked for.
#pragma once

#include <array>

#include "tripatch/boundary/side.h"
#include "tripatch/patch/surface.h"
#include "tripatch/report/report.h"

namespace tripatch {

struct FillOptions;
struct SurfacePoints;

struct MadePatch {
  SurfacePtr patch;
  Report report;         ///< of fairing, lambda and folds, and warnings
  bool gave_up = false;  ///< no energy serves here, so that the patch is a plain one
};

/// By the options that concern a patch: method, continuity, cross_boundary, bulge, fairing ("auto" leaves the patches of G0 methods
/// alone, unless a side is Free or there is tension), tension, center, center_offset and the method's own. Where a fair patch folds
/// and one from plain rays folds less, that one is taken. points: those that it shall follow instead of being made fair.
MadePatch patch_from_sides(const Sides& sides, const FillOptions& options, const SurfacePoints* points = nullptr);

}  // namespace tripatch
