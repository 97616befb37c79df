#include "tripatch/patch_from_sides.h"

#include <optional>
#include <string>

#include "tripatch/boundary/ribbon.h"
#include "tripatch/boundary/smoothed.h"
#include "tripatch/constructions/methods.h"
#include "tripatch/constructions/szilvasi_nagy.h"
#include "tripatch/fairing/center.h"
#include "tripatch/fairing/curvature.h"
#include "tripatch/fairing/energy.h"
#include "tripatch/fairing/folds.h"
#include "tripatch/fairing/follow.h"
#include "tripatch/fairing/kinks.h"
#include "tripatch/messages.h"
#include "tripatch/options.h"
#include "tripatch/output/shaped.h"

namespace tripatch {
namespace {

SurfacePtr construct(const Method& method, const Boundary& boundary, MethodOptions own, Report& report) {
  own.warnings = &report.warnings;
  SurfacePtr patch = method.from_boundary(boundary, own);
  if (const auto blend = std::dynamic_pointer_cast<const SzilvasiNagy>(patch))
    for (const SzilvasiNagy::Step& step : blend->path()) report.shape_path.emplace_back(step.shape, step.energy);
  return patch;
}

/// The patch, made fair or not, from the start that the options of the method say, with its middle where `center` is.
MadePatch construct_and_fair(const Sides& given, const Method& method, const Continuity& continuity, const FillOptions& options,
                             const std::optional<Vec3>& center, const MethodOptions& own, bool faired,
                             const SurfacePoints* points) {
  const Kinks kinks(given);
  const Sides& sides = kinks.rounded();
  const RibbonOptions ribbons = {options.cross_boundary, of_three(options.bulge, "bulge"), continuity.tangent};
  const Boundary boundary = make_boundary(sides, ribbons);
  MadePatch made;
  made.patch = construct(method, boundary, own, made.report);
  std::optional<Index> folds;  // of `made.patch`, where fairing has counted them
  const FairingBase base = {sides, boundary, made.patch};
  FairingOptions fairing;
  for (int i = 0; i < 3; ++i) fairing.slopes_free[i] = continuity.tangent[i] && options.bulge[i] == 1;
  if (faired && points) {
    fairing.degree = 6;  // there is more to go by than an energy
    made.patch = follow(base, *points, fairing);
  } else if (faired) {
    fairing.energy = *options.fairing;
    fairing.position_only = continuity.free;
    fairing.tension = options.tension;
    fairing.center = center;
    fairing.curvature = continuity.curvature;
    fairing.automatic = continuity.automatic;
    const FoldCounter counter(kinks, continuity.tangent);
    FairResult result = fair(base, build(method, smoothed(sides), ribbons, own), fairing, &counter);
    made.patch = std::move(result.patch);
    if (!result.gave_up) made.report.fairing = name_of(result.energy);
    made.report.energy_before = result.before;
    made.report.energy_after = result.after;
    for (Message& warning : result.warnings) made.report.warnings.push_back(std::move(warning));
    folds = result.folds;
    made.gave_up = result.gave_up;
  } else if (center) {
    made.patch = with_center(made.patch, *center);
  }
  const SurfacePtr counted = made.patch;
  const std::array<bool, 3>& exact = continuity.curvature;
  if (exact[0] || exact[1] || exact[2]) {
    made.patch = meet_curvature(made.patch, sides, exact);
    if (center) made.patch = with_center(made.patch, *center, 3);
    for (int i = 0; i < 3; ++i)
      if (exact[i] && kinks.on(i)) made.report.warnings.push_back({Code::side_kink, {{"side", i}}});
  }
  if (!kinks.empty()) made.patch = kinks.restored(made.patch, continuity.tangent);
  made.report.folds = folds && made.patch == counted ? *folds : FoldCounter(kinks)(*made.patch);
  const std::array<SeamContinuity, 3> kept = continuity.kept();
  made.report.continuity.assign(kept.begin(), kept.end());
  return made;
}

/// The same, from plain rays where that folds less, and just these where no energy serves.
MadePatch patch_with_fewest_folds(const Sides& sides, const Method& method, const Continuity& continuity,
                                  const FillOptions& options, const std::optional<Vec3>& center, bool faired,
                                  const SurfacePoints* points) {
  MethodOptions own = options.own;
  own.to_be_faired = faired;
  MadePatch made = construct_and_fair(sides, method, continuity, options, center, own, faired, points);
  if (!faired || (made.report.folds == 0 && !made.gave_up)) return made;
  own.to_be_faired = false;
  MadePatch plain = construct_and_fair(sides, method, continuity, options, center, own, !made.gave_up, points);
  if (made.gave_up && (plain.report.folds == 0 || made.report.folds > 0)) {
    const double bends = energy(*plain.patch, *options.fairing, size_of(*plain.patch));
    made.patch = plain.patch;
    made.report.folds = plain.report.folds;
    made.report.energy_before = made.report.energy_after = bends;
  }
  return plain.report.folds < made.report.folds && !made.gave_up ? plain : made;
}

/// Throws where a side lacks its curve, or a field of it is not one of vectors.
void check_fields(const Sides& sides) {
  for (std::size_t i = 0; i < 3; ++i) {
    const Side& side = sides[i];
    const auto check_field = [&](const char* name, const PiecewisePolynomial& field, bool needed) {
      const int given = field.empty() ? 0 : field.dimension();
      if (given == 3 || (given == 0 && !needed)) return;
      throw CodedArgument(Code::wrong_shape, {{"name", "sides[" + std::to_string(i) + "]." + name},
                                              {"shape", "(n, 3)"},
                                              {"given", "(n, " + std::to_string(given) + ")"}});
    };
    check_field("c", side.c, true);
    check_field("r", side.r, false);
    check_field("q", side.q, false);
  }
}

}  // namespace

MadePatch patch_from_sides(const Sides& given, const FillOptions& options, const SurfacePoints* points) {
  check(options);
  if (options.fairing == Fairing::isometric) refuse_isometric();
  const Method& method =
      find_method(options.method == automatic_method || options.method == polygon_method ? patch_method : options.method);
  if (!method.from_boundary)
    throw CodedArgument(Code::method_of_function,
                        {{"method", options.method}, {"function", method.sides[1] == 0 ? "tripatch.fill" : "tripatch.blend"}});
  check_fields(given);
  const Continuity continuity = resolve_continuity(options.continuity, method, given);
  const bool keeps_tangent = method.continuity != SeamContinuity::g0;
  for (std::size_t i = 0; i < 3; ++i)
    if (continuity.tangent[i] && given[i].r.empty()) throw CodedRefusal(Code::side_without_planes, {{"side", i}});
  Sides sides = planes_from_rim(given, continuity.tangent);
  for (int i = 0; i < 3 && !keeps_tangent; ++i) sides[i].c = given[i].c;  // all that is met
  const std::array<bool, 3>& free = continuity.free;
  const bool alone = !keeps_tangent && !free[0] && !free[1] && !free[2] && options.tension == 0;
  const bool faired = options.fairing == Fairing::automatic ? !alone : options.fairing.has_value();
  check_shape_options(faired, options.tension, options.center.has_value(), options.center_offset);
  check_reach(check_sides(sides), sides[0].c(0), options);

  MadePatch made = patch_with_fewest_folds(sides, method, continuity, options, options.center, faired, points);
  if (options.center_offset == 0) return made;
  const auto [middle, normal] = center_of(*made.patch);
  return patch_with_fewest_folds(sides, method, continuity, options, Vec3(middle + options.center_offset * normal), faired,
                                 points);
}

}  // namespace tripatch
