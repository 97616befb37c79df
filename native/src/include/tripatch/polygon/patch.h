// From n sides to a patch over a polygon: base, fairing, curvature, inner points.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tripatch/choices.h"
#include "tripatch/messages.h"
#include "tripatch/patch/through.h"
#include "tripatch/polygon/fair.h"
#include "tripatch/report/report.h"

namespace tripatch {

struct PolygonPatchOptions {
  std::vector<SideContinuity> continuity = {};  ///< one for all sides or one a side; empty: automatic
  std::vector<double> bulge = {};               ///< likewise; empty: 1
  std::optional<Fairing> fairing = Fairing::automatic;
  double tension = 0;
  std::optional<Vec3> center = {};           ///< where the center of the domain is to be
  double center_offset = 0;                  ///< instead: how far it moves along its normal
  std::vector<Through> through = {};         ///< met exactly
  std::optional<PolygonDomain> domain = {};  ///< none: made for the sides
  bool past_hooks = false;  ///< where it folds, the patch past hooks of the sides (boundary.h) if that folds less
};

/// What became of the fairing of a patch.
struct Faired {
  std::string fairing;
  double energy_before = 0, energy_after = 0;
  Index folds = 0;
  std::vector<Vec2> met;  ///< places of the points that are met inside
  bool gave_up = false;   ///< no energy serves here: the patch is the plain one
  Messages warnings;
};

struct PolygonPatch : Faired {
  SurfacePtr patch;
  PolygonDomain domain;
  SideList sides;  ///< closed
  std::vector<double> corner_mismatch_deg;
  std::vector<double> corner_planes_angle, corner_normals_spread;  ///< as in a report, of the planes that are given
  double boundary_gap = 0;
  std::vector<double> seam_angle_max,
      seam_angle_rms;                      ///< by side, degrees: against the sides, outside of 1% at corners of two planes
  std::vector<SeamContinuity> continuity;  ///< by side
  std::shared_ptr<KnownAtNodes> known;     ///< of its fairing
};

PolygonPatch polygon_patch(const SideList& sides, const PolygonPatchOptions& options = {});

}  // namespace tripatch
