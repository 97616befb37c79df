#include "tripatch/fill/found_sides.h"

#include <algorithm>
#include <utility>

#include "tripatch/creases/features.h"
#include "tripatch/fill/any_rim_fill.h"
#include "tripatch/hole/clear_corners.h"
#include "tripatch/hole/rim_checks.h"
#include "tripatch/hole/rim_shape.h"
#include "tripatch/hole/sharp_sides.h"
#include "tripatch/messages.h"
#include "tripatch/polygon/domain.h"

namespace tripatch {
namespace {

/// Whether the hole has lost a flat wall, and no sides are found which by themselves continue none of those that are left.
bool missing_planar_face(const FillContext& context, const std::vector<Index>& rim, std::vector<Index> corners,
                         const FillOptions& options) {
  if (is_shaped_by_hand(options) || !is_continuity_open(options)) return false;
  if (!walls_end_at_flat_rim(context.mesh, context.left, rim, diameter(context.mesh, rim))) return false;
  if (corners.empty()) corners = at_places(rim, corners_between_sharp(context.mesh, context.left, rim));
  if (corners.size() < 2 || corners.size() > static_cast<std::size_t>(max_sides)) return true;
  const std::vector<double> angles = sharp_sides(context.mesh, context.left, rim, places_in(rim, corners));
  return !std::ranges::all_of(angles, [](double angle) { return angle > 0; });
}

/// Whether all that is asked for by hand is that the sides meet the mesh in position only.
bool asks_for_positions_only(FillOptions options) {
  const bool all = std::ranges::all_of(options.continuity,
                                       [](SideContinuity c) { return c == SideContinuity::free || c == SideContinuity::g0; });
  options.continuity = FillOptions().continuity;
  return all && !is_shaped_by_hand(options);
}

Message smooth_sides_of(std::size_t count) { return {Code::has_smooth_sides, {{"count", count}}}; }

/// Finds the sides of a hole.
class SideFinder {
public:
  SideFinder(const FillContext& context, const std::vector<Index>& rim, const Corners& given, const FillOptions& options)
      : ground_(context), loop_(rim), given_(given) {
    out_.of_spline = given;
    out_.options = options;
  }

  SidesFound found() {
    FillOptions& options = out_.options;
    if (options.cap != Cap::automatic && options.islands.empty()) return cap();
    if (!options.islands.empty()) return none(Code::has_islands);
    if (!given_) return detected();
    if (given_->empty()) return round_or(Code::round_not_smooth);
    out_.is_flat = missing_planar_face(ground_, loop_, *given_, options);
    if (out_.is_flat) options.continuity = SideContinuity::free;
    if (makes_polygon(*given_) || (given_->size() == 3 && !options.through.empty())) return polygon(*given_);
    if (given_->size() != 3) return none(Code::corners_given, {{"count", given_->size()}});
    check_finite(ground_.mesh, ground_.left, loop_);
    if (const std::optional<Code> crease = crease_across()) return none(*crease);
    return triangle(make_hole(ground_.mesh, ground_.left, loop_, three(given_)));
  }

private:
  SidesFound detected() {
    // wherever the rim is begun, the same corners are found, in the same order
    std::rotate(loop_.begin(), std::min_element(loop_.begin(), loop_.end()), loop_.end());
    check_finite(ground_.mesh, ground_.left, loop_);
    const std::vector<Index> corners = at_places(loop_, corners_between_sides(ground_.mesh, ground_.left, loop_));
    if (const std::optional<Code> crease = crease_across()) return none(*crease);
    if (missing_planar_face(ground_, loop_, corners, out_.options)) {
      out_.has_lost_wall = true;
      return none(Code::wall_missing);
    }
    if (makes_polygon(corners) || (corners.size() == 3 && !out_.options.through.empty())) return polygon(corners);
    try {
      return triangle(make_hole(ground_.mesh, ground_.left, loop_, std::nullopt));
    } catch (const CodedRefusal&) {
      return between_sharp(Code::no_smooth_sides);
    }
  }

  SidesFound between_sharp(Code otherwise) {
    const std::vector<Index> sharp = at_places(loop_, corners_between_sharp(ground_.mesh, ground_.left, loop_));
    if (sharp.empty()) return round_or(otherwise);
    const bool sided = makes_polygon(sharp) && (!asks_for_sides(out_.options) || asks_for_positions_only(out_.options));
    return sided ? polygon(sharp) : none(otherwise);
  }

  /// Which crease of the surroundings continues across the hole; none: none does.
  std::optional<Code> crease_across() {
    if (!out_.options.features) return {};
    const Features near = find_features(ground_.mesh, ground_.left, loop_);
    const auto goes_on = [&](const Connectivity& around) { return find_features(ground_.mesh, around, loop_).found(); };
    if (near.found() && (!ground_.is_part() || goes_on(Connectivity(ground_.mesh, out_.options.replaced))))
      return !near.walls || !near.walls->are_flat ? Code::crease_continues
             : near.walls->parts.size() == 1      ? Code::wall_continues
             : near.walls->nodes.empty()          ? Code::crease_continues
                                                  : Code::walls_meet;
    const auto is_known = [&](Index v) { return ground_.left.knows(v); };
    // what is not there need not be sought again
    out_.options.features = near.found() || !std::all_of(near.vertices.begin(), near.vertices.end(), is_known);
    return {};
  }

  SidesFound cap() {
    out_.has_lost_wall = out_.options.cap == Cap::flat;
    out_.of_spline.emplace();
    out_.reason = Message{Code::cap_requested, {{"cap", name_of(out_.options.cap)}}};
    if (out_.options.cap == Cap::flat) {
      check_finite(ground_.mesh, ground_.left, loop_);
      return std::move(out_);
    }
    if (is_continuity_open(out_.options)) out_.options.continuity = SideContinuity::g1;
    out_.domain = PatchDomain::disc;
    return std::move(out_);
  }
  SidesFound round_or(Code otherwise) {
    out_.of_spline.emplace();
    if (!is_round(ground_.mesh, ground_.left, loop_)) return none(otherwise);
    out_.domain = PatchDomain::disc;
    out_.reason = Message{Code::is_round};
    return std::move(out_);
  }
  SidesFound polygon(const std::vector<Index>& corners) {
    out_.domain = PatchDomain::polygon;
    out_.reason = smooth_sides_of(corners.size());
    out_.of_spline = out_.corners = corners;
    return std::move(out_);
  }
  SidesFound triangle(Hole hole) {
    out_.domain = PatchDomain::triangle;
    out_.reason = smooth_sides_of(3);
    out_.hole = std::move(hole);
    return std::move(out_);
  }
  SidesFound none(Code reason, std::vector<Parameter> parameters = {}) {
    out_.reason = Message{reason, std::move(parameters)};
    return std::move(out_);
  }

  const FillContext& ground_;
  std::vector<Index> loop_;
  const Corners& given_;
  SidesFound out_;
};

}  // namespace

SidesFound found_sides(const FillContext& context, const std::vector<Index>& rim, const Corners& given,
                       const FillOptions& options) {
  return SideFinder(context, rim, given, options).found();
}

}  // namespace tripatch
