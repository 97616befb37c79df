#include "tripatch/polygon/patch.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tripatch/boundary/smoothed.h"
#include "tripatch/math/angle.h"
#include "tripatch/math/lru_cache.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/patch/seam.h"
#include "tripatch/polygon/joined.h"
#include "tripatch/polygon/of_three.h"

namespace tripatch {
namespace {

template <class T>
std::vector<T> each(const std::vector<T>& given, int n, const T& otherwise, const char* name) {
  if (given.empty()) return std::vector<T>(n, otherwise);
  if (given.size() == 1) return std::vector<T>(n, given[0]);
  if (static_cast<int>(given.size()) != n) refuse_count(name, given.size(), n);
  return given;
}

/// Four sides, one of which is longer than another by this factor, are a strip, as a fillet is: what happens along it needs more
/// nodes and coefficients. Of the strips among the faces of seven CAD files, 4 to 90 times as long as wide, the worst came to 7e-4 of
/// the diameter with them, 7e-3 without; where sides differ by less they change next to nothing.
constexpr double strip_ratio = factor::strong;
constexpr int strip_nodes = count::dozen, strip_rough_nodes = count::octet, strip_waves = count::half_dozen;

bool is_strip(const PolygonDomain& domain) {
  if (domain.sides() != 4) return false;
  double shortest = std::numeric_limits<double>::infinity(), longest = 0;
  for (int i = 0; i < 4; ++i) {
    const double length = (domain.corner(i + 1) - domain.corner(i)).norm();
    shortest = std::min(shortest, length);
    longest = std::max(longest, length);
  }
  return longest > strip_ratio * shortest;
}

/// Of a side with kinks so many places are taken as those of vertices are in a mesh, for its third derivatives are noise, too. Of 85 fillets of
/// Open CASCADE's along splines and 82 between cylinders, cones, tori and planes the patches are 1.7e-4 and 5.2e-5 of the diameter off in the
/// geometric mean, with 64 places 1.8e-4 and 5.1e-5, with kinks as they are 1.9e-3 and 1.8e-4.
constexpr int smoothed_places = 20;

/// Of all sides, three at a time.
SideList smoothed_list(const SideList& sides) {
  SideList out;
  for (const Side& side : sides) {
    Side at = side;
    for (int k = 0; k <= smoothed_places && is_kinked(side); ++k) at.rim.push_back(static_cast<double>(k) / smoothed_places);
    out.push_back(smoothed(Sides{at, Side(), Side()})[0]);
    out.back().rim = side.rim;
  }
  return out;
}

/// What is asked of each side.
struct Asked {
  std::vector<bool> tangent, free, exact, automatic;
  std::vector<SeamContinuity> kept;
};

Asked asked(const std::vector<SideContinuity>& continuity, const SideList& sides) {
  Asked out;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const SideContinuity c = continuity[i];
    if (c == SideContinuity::g2 && sides[i].q.empty()) throw CodedRefusal(Code::curvature_unknown, {{"side", i}});
    out.free.push_back(c == SideContinuity::free);
    out.tangent.push_back(c != SideContinuity::free && c != SideContinuity::g0);
    out.exact.push_back(c == SideContinuity::g2);
    out.automatic.push_back(c == SideContinuity::automatic);
    out.kept.push_back(kept_by(c));
  }
  return out;
}

PolygonBase base_of(const SideList& sides, const Asked& asked, const std::vector<double>& bulge, const PolygonDomain* domain,
                    const std::vector<InnerPoint>& through, bool past_hooks) {
  PolygonBase base;
  base.sides = sides;
  base.boundary = polygon_boundary(sides, {bulge, asked.tangent, past_hooks}, domain);
  base.blend = corner_blend(base.boundary);
  base.lift = lift_to(base.blend, base.boundary.domain, through, base.boundary.size);
  const std::vector<bool> agree = curvature_agrees(sides);
  for (std::size_t i = 0; i < sides.size(); ++i) {
    base.slopes_free.push_back(asked.tangent[i] && bulge[i] == 1);
    base.curvature.push_back(asked.exact[i] || (asked.automatic[i] && agree[i]));
  }
  base.position_only = asked.free;
  base.through = through;
  return base;
}

/// given: the sides as what surrounds the hole has them, of which those that are met in position only have been given other planes.
void measure_seam(const SideList& given, PolygonPatch& made) {
  const int n = made.domain.sides();
  const auto places = [&](int i, const std::vector<double>& t) {
    Points uv = Points::Zero(static_cast<Index>(t.size()), 3);
    for (std::size_t k = 0; k < t.size(); ++k) uv.row(static_cast<Index>(k)).head<2>() = made.domain.on_side(i, t[k]);
    return uv;
  };
  for (int i = 0; i < n; ++i) {
    const int before = (i + n - 1) % n;
    made.corner_planes_angle.push_back(degrees_between(given[before].normal(1), given[i].normal(0)));
    made.corner_normals_spread.push_back(
        normals_spread(*made.patch, places(before, {1 - tolerance::same}).row(0), places(i, {tolerance::same}).row(0)));
    const double first = made.corner_mismatch_deg[i] <= tolerance::same ? 0 : beside_corner,
                 last = made.corner_mismatch_deg[(i + 1) % n] <= tolerance::same ? 1 : 1 - beside_corner;
    std::vector<double> t;
    Points points(seam_samples, 3), normals(seam_samples, 3);
    for (int k = 0; k < seam_samples; ++k) {
      t.push_back(first + (last - first) * k / (seam_samples - 1));
      points.row(k) = given[i].c(t.back());
      normals.row(k) = given[i].normal(t.back());
    }
    const SeamOfSide seam = seam_of(*made.patch, places(i, t), points, normals);
    made.seam_angle_max.push_back(seam.angle_max);
    made.seam_angle_rms.push_back(seam.angle_rms);
    made.boundary_gap = std::max(made.boundary_gap, seam.gap);
  }
}

/// Where the patch comes nearest to a point: Gauss-Newton from the nearest place of a grid, kept off the border.
Vec2 nearest_place(const Surface& patch, const PolygonDomain& domain, const Vec3& point) {
  constexpr double min_share = share::trace;  // of the radius, from each side: what is added vanishes there
  const Points grid = polygon_grid(domain, 12);
  const Points at = patch.positions(grid);
  Index best = 0;
  (at.rowwise() - point.transpose()).rowwise().squaredNorm().minCoeff(&best);
  Vec2 place = grid.row(best).head<2>();
  const auto inside = [&](const Vec2& p) {
    for (int i = 0; i < domain.sides(); ++i)
      if (domain.phi(i, p) < min_share * domain.radius()) return false;
    return true;
  };
  for (int step = 0; step < 8; ++step) {
    const Vec2 move = foot_at(patch, place, point).step;
    if (!move.allFinite()) break;
    double share = 1;
    while (share > tolerance::slight && !inside(place + share * move)) share /= 2;
    if (share <= tolerance::slight) break;
    place += share * move;
  }
  while (!inside(place)) place += share::tenth * (domain.center() - place);
  return place;
}

/// Of corners at which two sides continue as pieces of one side do. Sixteen patches of 8 to 11 sides had one that turned by 0.3 to 3 degrees; with
/// the two sides as one they came 1.7 to 130 times nearer.
void tell_straight_corners(const std::vector<double>& turn_deg, Messages& warnings) {
  if (turn_deg.size() < 4) return;
  for (std::size_t k = 0; k < turn_deg.size(); ++k)
    if (std::abs(turn_deg[k]) < still_smooth)
      warnings.push_back({Code::straight_corner, {{"corner", k}, {"angle", std::lround(still_smooth)}}});
}

PolygonPatch made_with(const SideList& sides, const PolygonPatchOptions& options, const Asked& asked,
                       const std::vector<double>& bulge, const std::vector<InnerPoint>& through, bool past_hooks,
                       const std::shared_ptr<KnownAtNodes>& known) {
  PolygonPatch made;
  made.sides = sides;
  const PolygonBase base = base_of(sides, asked, bulge, options.domain ? &*options.domain : nullptr, through, past_hooks);
  made.domain = base.boundary.domain;
  made.corner_mismatch_deg = base.boundary.corner_mismatch_deg;
  made.patch = base.patch();
  if (options.fairing) {
    FairingOptions fairing;
    fairing.energy = *options.fairing;
    fairing.tension = options.tension;
    fairing.many_starts = true;
    if (!through.empty()) fairing.center = through[0].point;  // the shape is a person's, however wild
    const int n = made.domain.sides();                        // as many nodes in all as a triangle has, or a few more
    fairing.nodes = n <= 5 ? 8 : n <= 8 ? 7 : 6;
    fairing.rough_nodes = n <= 5 ? 5 : 4;
    // the larger the polygon, the farther its middle from what the sides say of it; and in a lens all are far from the corners
    fairing.degree = n == 2 ? 8 : n <= 4 ? 4 : n == 5 ? 6 : 8;
    fairing.second_cross = n == 2 ? 6 : n <= 5 ? 4 : 6;
    if (is_strip(made.domain)) {
      fairing.nodes = strip_nodes;
      fairing.rough_nodes = strip_rough_nodes;
      fairing.second_cross = fairing.slopes = strip_waves;
    }
    PolygonBase measured = base_of(smoothed_list(sides), asked, bulge, &made.domain, through, past_hooks);
    if (known) measured.known = known;
    made.known = measured.known;
    PolygonFairResult fair = fair_polygon(base, measured, fairing);
    // nothing fairer than the plain patch was found for sides without their kinks: what they are like may be the kinks
    if (!(fair.after < fair.before) && std::ranges::any_of(sides, is_kinked)) fair = fair_polygon(base, base, fairing);
    made.patch = fair.patch;
    if (!fair.gave_up) made.fairing = name_of(fairing.energy);
    made.energy_before = fair.before;
    made.energy_after = fair.after;
    made.folds = fair.folds;
    made.gave_up = fair.gave_up;
    made.warnings = std::move(fair.warnings);
  } else {
    made.folds = count_polygon_folds(*made.patch, made.domain, sides);
  }
  if (std::find(asked.exact.begin(), asked.exact.end(), true) != asked.exact.end()) {
    made.patch = meet_curvature(made.patch, made.domain, sides, asked.exact);
    made.patch = with_points(made.patch, made.domain, through, base.boundary.size);
    made.folds = count_polygon_folds(*made.patch, made.domain, sides);
  }
  if (!options.domain) tell_straight_corners(base.boundary.turn_deg, made.warnings);
  return made;
}

/// The same; where it folds, past hooks of the sides, if that is asked for and folds less.
PolygonPatch unfolded(const SideList& sides, const PolygonPatchOptions& options, const Asked& asked,
                      const std::vector<double>& bulge, const std::vector<InnerPoint>& through,
                      const std::shared_ptr<KnownAtNodes>& known) {
  PolygonPatch made = made_with(sides, options, asked, bulge, through, false, known);
  if (made.folds == 0 || !options.past_hooks) return made;
  PolygonPatch other = made_with(sides, options, asked, bulge, through, true, {});
  other.known = made.known;  // what is pulled is tried without first, too
  return other.folds < made.folds ? other : made;
}

/// unfolded, which depends on nothing else than this key: a fill that somebody shapes has the same patch with other faces, and the
/// same patch whose middle is moved. known: of the patch without the points.
PolygonPatch made_or_kept(const SideList& sides, const PolygonPatchOptions& options, const Asked& asked,
                          const std::vector<double>& bulge, const std::vector<InnerPoint>& through,
                          const std::shared_ptr<KnownAtNodes>& known = {}) {
  static LruCache<PolygonPatch> last;
  Key key;
  for (const Side& side : sides) {
    for (const PiecewisePolynomial& field : {side.c, side.r, side.q}) key.add(field);
    key.add(side.rim);
    key.add(side.curvature_error);
  }
  for (const std::vector<bool>& flags : {asked.tangent, asked.free, asked.exact, asked.automatic}) key.add(flags);
  key.add(bulge);
  key.add(options.fairing ? static_cast<double>(*options.fairing) : -1.0);
  key.add(options.tension);
  key.add(options.past_hooks ? 1.0 : 0.0);
  key.add(options.domain ? options.domain->height() : -1.0);
  for (int i = 0; options.domain && i < options.domain->sides(); ++i) key.add(options.domain->corner(i));
  for (const InnerPoint& point : through) {
    key.add(point.uv);
    key.add(point.point);
    key.add(point.normal);
  }
  if (const auto kept = last.find(key)) return *kept;
  return *last.keep(std::move(key), std::make_shared<const PolygonPatch>(unfolded(sides, options, asked, bulge, through, known)));
}

}  // namespace

PolygonPatch polygon_patch(const SideList& given, const PolygonPatchOptions& options) {
  SideList sides = closed(given);
  const int n = static_cast<int>(sides.size());
  check_shape_options(options.fairing.has_value(), options.tension, options.center.has_value(), options.center_offset);
  const Asked wanted = asked(each(options.continuity, n, SideContinuity::automatic, "continuity"), sides);
  const SideList surroundings = sides;
  sides = planes_from_rim(std::move(sides), wanted.tangent);
  const std::vector<double> bulge = each(options.bulge, n, 1.0, "bulge");
  const Vec2 center = (options.domain ? *options.domain : polygon_boundary(sides).domain).center();
  std::vector<InnerPoint> through;
  if (options.center) through.push_back({center, *options.center, {}});
  PolygonPatch made = made_or_kept(sides, options, wanted, bulge, through);
  if (options.center_offset != 0 || !options.through.empty()) {
    if (options.center_offset != 0) {
      Points middle = Points::Zero(1, 3);
      middle.row(0).head<2>() = center;
      const auto [position, normal] = made.patch->positions_and_normals(middle);
      through.push_back({center, Vec3(position.row(0) + options.center_offset * normal.row(0)), {}});
    }
    for (const Through& t : options.through)
      through.push_back({nearest_place(*made.patch, made.domain, t.point), t.point, t.normal});
    made = made_or_kept(sides, options, wanted, bulge, through, made.known);
    for (std::size_t k = through.size() - options.through.size(); k < through.size(); ++k) made.met.push_back(through[k].uv);
  }
  made.patch = std::make_shared<OverPolygon>(made.domain, made.patch);
  made.continuity = wanted.kept;
  measure_seam(surroundings, made);
  return made;
}

void complete_patch(const SideList& sides, const std::vector<Through>& through, PolygonPatch& made) {
  const PolygonBoundary boundary = polygon_boundary(sides);
  made.sides = sides;
  made.domain = boundary.domain;
  made.corner_mismatch_deg = boundary.corner_mismatch_deg;
  SurfacePtr patch = over_domain(made.domain, made.patch);
  std::vector<InnerPoint> points;
  for (const Through& t : through) {
    points.push_back({nearest_place(*patch, made.domain, t.point), t.point, t.normal});
    made.met.push_back(points.back().uv);
  }
  if (!points.empty()) {
    patch = with_points(patch, made.domain, points, boundary.size);
    made.folds = count_polygon_folds(*patch, made.domain, sides);
  }
  made.patch = std::make_shared<OverPolygon>(made.domain, patch);
  measure_seam(sides, made);
}

}  // namespace tripatch
