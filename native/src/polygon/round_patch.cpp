#include <algorithm>
#include <cmath>
#include <numbers>

#include "tripatch/boundary/side.h"
#include "tripatch/fairing/candidates.h"
#include "tripatch/fairing/folds.h"
#include "tripatch/math/angle.h"
#include "tripatch/math/places.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/messages.h"
#include "tripatch/patch/seam.h"
#include "tripatch/polygon/joined.h"
#include "tripatch/polygon/round_problem.h"
#include "tripatch/polygon/surface_of_revolution.h"

namespace tripatch {
namespace {

/// Energies are measured on a rim without shorter waves: third derivatives of what a mesh says of them are noise.
constexpr int measured_waves = count::dozen;
/// Places on the disc at which a patch is looked at: choices.
constexpr int round_fold_rings = count::places, round_fold_angles = count::many_places;
/// Along the radius; with half as many the energy over an uneven rim is 1% off, twice as many change 1e-6.
constexpr int energy_nodes_round = count::octet;

/// Of waves round the circle at t.
Vec3 at_turn(const Harmonic& waves, double t) {
  Vec3 sum = waves.row(0);
  const Vec2 turn = on_circle(t);
  Vec2 wave = turn;
  for (Index k = 1; 2 * k < waves.rows(); ++k) {
    sum += wave[0] * waves.row(2 * k - 1).transpose() + wave[1] * waves.row(2 * k).transpose();
    wave = Vec2(wave[0] * turn[0] - wave[1] * turn[1], wave[0] * turn[1] + wave[1] * turn[0]);
  }
  return sum;
}

double rim_diameter(const PiecewisePolynomial& c) {
  std::vector<Vec3> points;
  for (const double t : evenly(48)) points.push_back(c(t));
  double size = 0;
  for (const Vec3& p : points)
    for (const Vec3& q : points) size = std::max(size, (p - q).norm());
  return size;
}

void check_round(const Side& side, double size) {
  if (!(size > 0)) throw CodedRefusal(Code::sides_without_length);
  if ((side.c(1) - side.c(0)).norm() > tolerance::same * size) throw CodedRefusal(Code::single_side_open);
  if (degrees_between(side.c.derivative_at(1), side.c.derivative_at(0)) > still_smooth ||
      degrees_between(side.normal(1), side.normal(0)) > still_smooth)
    throw CodedRefusal(Code::single_side_has_corner);
}

}  // namespace

PiecewisePolynomial around_circle(const Harmonic& waves) {
  return PiecewisePolynomial::fit(
      [&](std::span<const double> t, std::span<double> out) {
        for (std::size_t s = 0; s < t.size(); ++s) Vec3::Map(&out[3 * s]) = at_turn(waves, t[s]);
      },
      3);
}

namespace {

/// The rim of a side, r as a unit vector across it, and q as the normal curvature along that, by waves up to an order.
struct RimWaves {
  Harmonic c, r, q;

  RimWaves(const Side& side, int order)
      : c(fourier([&](double t) { return side.c(t); }, order)),
        r(fourier([&](double t) { return upright_across(side, t); }, order)) {
    if (!side.q.empty()) q = fourier([&](double t) { return upright_bend(side, t); }, order);
  }
  Side side(double curvature_error) const {
    Side out;
    out.c = around_circle(c);
    out.r = around_circle(r);
    if (q.rows() > 0) out.q = around_circle(q);
    out.curvature_error = curvature_error;
    return out;
  }
};

/// The frame about which rim and slopes are of revolution, if they are.
std::optional<Eigen::Matrix3d> axis_of(const RoundBase& base) {
  const Harmonic& curve = base.terms[0];
  if (!base.through.empty() || curve.rows() < 3) return {};
  Eigen::Matrix3d frame;
  frame.col(0) = curve.row(1).normalized();
  frame.col(2) = frame.col(0).cross(Vec3(curve.row(2))).normalized();
  frame.col(1) = frame.col(2).cross(frame.col(0));
  if (!frame.allFinite()) return {};
  std::vector<Harmonic> other = base.terms;
  of_revolution(other, frame);
  other[0].row(0) = curve.row(0);
  for (std::size_t j = 0; j < other.size(); ++j)
    if (!((other[j] - base.terms[j]).norm() <= (j == 0 ? tolerance::same : tolerance::close) * base.size)) return {};
  return frame;
}

struct RoundAsked {
  SideContinuity continuity;
  double bulge;
  std::vector<InnerPoint> through;
  int order;
  bool tangent() const { return continuity != SideContinuity::free && continuity != SideContinuity::g0; }
};

/// Of a rim, by chords.
double length_of(const Harmonic& rim) {
  double length = 0;
  Vec3 before = at_turn(rim, 0);
  for (const double t : evenly(32)) {
    const Vec3 at = at_turn(rim, t);
    length += (at - before).norm();
    before = at;
  }
  return length;
}

/// What `asked` says, and the terms of the patch; without the side.
RoundBase terms_of_base(const RimWaves& waves, const RoundAsked& asked, double size, int order) {
  RoundBase base;
  base.size = size;
  base.alpha = asked.bulge * length_of(waves.c) / (2 * std::numbers::pi);
  base.position_only = asked.continuity == SideContinuity::free;
  base.slopes_free = asked.tangent() && asked.bulge == 1;
  base.curvature = asked.continuity == SideContinuity::g2 || asked.continuity == SideContinuity::automatic;
  base.through = asked.through;
  Harmonic slope = Harmonic::Zero(2 * order + 5, 3);  // two waves more: alpha and beta times r and c'
  if (asked.tangent()) {
    slope.topRows(waves.c.rows()) = -0.5 * base.alpha * waves.r;
    for (Index k = 1; k <= order; ++k)
      slope.middleRows(2 * k - 1, 2) += 0.5 * static_cast<double>(k) * waves.c.middleRows(2 * k - 1, 2);
  }
  base.terms = terms_through({waves.c, slope}, base.through, size);
  return base;
}

RoundBase round_base(const Side& side, const RoundAsked& asked, double size, int order) {
  const RimWaves waves(side, order);
  RoundBase base = terms_of_base(waves, asked, size, order);
  base.side = waves.side(side.curvature_error);
  return base;
}

Index count_round_folds(const Surface& patch) {
  Points uv = Points::Zero(round_fold_rings * round_fold_angles, 3);
  for (Index ring = 0; ring < round_fold_rings; ++ring)
    for (Index k = 0; k < round_fold_angles; ++k)
      uv.row(ring * round_fold_angles + k).head<2>() =
          on_circle(static_cast<double>(k) / round_fold_angles) * static_cast<double>(ring + 1) / round_fold_rings;
  const Points normals = patch.normals(uv);
  Index folds = 0;
  for (Index ring = 0; ring < round_fold_rings; ++ring)
    for (Index k = 0; k < round_fold_angles; ++k) {
      const Vec3 own = normals.row(ring * round_fold_angles + k);
      const Vec3 next = normals.row(ring * round_fold_angles + (k + 1) % round_fold_angles);
      folds += own.dot(next) <= folded_apart;
      if (ring > 0) folds += own.dot(normals.row((ring - 1) * round_fold_angles + k)) <= folded_apart;
    }
  return folds;
}

void measure_round_seam(RoundPatch& made) {
  Points at = Points::Zero(seam_samples, 3);
  for (int k = 0; k < seam_samples; ++k) at.row(k).head<2>() = on_circle(static_cast<double>(k) / seam_samples);
  const Points normals = made.patch->normals(at);
  double squares = 0;
  for (int k = 0; k < seam_samples; ++k) {
    const double angle = degrees_between(normals.row(k), made.side.normal(static_cast<double>(k) / seam_samples));
    made.seam_angle_max = std::max(made.seam_angle_max, angle);
    squares += angle * angle / seam_samples;
  }
  made.seam_angle_rms = std::sqrt(squares);
}

/// Plus what the second derivative along the radius lacks, along the normal.
std::vector<Harmonic> with_curvature(const std::vector<Harmonic>& terms, const Side& side, int order) {
  const RoundSurface patch(terms);
  const auto lacking = [&](double t) -> Vec3 { return lacking_curvature(side, t, along_radius(patch, t)) / 8; };
  return sum_of(terms, {Harmonic::Zero(1, 3), Harmonic::Zero(1, 3), fourier(lacking, 2 * order + 4)});
}

/// The fairest among surfaces of revolution, where the base is one and neither slopes nor tension are a person's; false where that is
/// not so, or what comes out would fold more than the base.
bool made_of_revolution(RoundPatch& made, std::vector<Harmonic>& terms, const RoundBase& base, const FairingOptions& fairing) {
  const bool geometric = fairing.energy == Fairing::automatic || fairing.energy == Fairing::minimum_variation;
  if (!geometric || !base.slopes_free || base.position_only || fairing.tension > 0) return false;
  const std::optional<Eigen::Matrix3d> axis = axis_of(base);
  if (!axis) return false;
  const std::optional<std::vector<Harmonic>> found = fairest_of_revolution(base, *axis, fairing.energy, fairing.curvature_jump);
  if (!found) return false;
  const RoundSurface before(base.terms), after(*found);
  const double energy = round_energy(after, fairing.energy);
  const Index folds = count_round_folds(after);
  if (folds > made.folds || beyond_energies(energy, false)) return false;
  terms = *found;
  made.fairing = name_of(fairing.energy);
  made.energy_before = round_energy(before, fairing.energy);
  made.energy_after = energy;
  made.folds = folds;
  made.of_revolution = true;
  return true;
}

/// The fairest among all, as long as it does not fold more than the base.
void made_fair(RoundPatch& made, std::vector<Harmonic>& terms, const RoundBase& base, const RoundBase& measured,
               const FairingOptions& fairing) {
  const Candidates<RoundProblem> found = is_quadratic(fairing.energy)
                                             ? quadratic_candidates<RoundProblem>(measured, fairing, base.size)
                                             : geometric_candidates<RoundProblem>(measured, fairing);
  const std::optional<Eigen::Matrix3d> axis = axis_of(base);
  made.energy_before = made.energy_after = std::isnan(found.before) ? 0 : found.before;
  made.gave_up = found.beyond && made.folds == 0;
  made.of_revolution = axis.has_value();
  if (made.gave_up) {
    made.warnings = {{Code::surroundings_vary}};
    return;
  }
  made.fairing = name_of(fairing.energy);
  for (const Candidate& candidate : found.best_first) {
    if (!(candidate.energy <= made.energy_before)) continue;
    std::vector<Harmonic> now = sum_of(base.terms, found.problem->correction(candidate.x, base, axis));
    now = terms_through(std::move(now), base.through, base.size);
    const Index folds = count_round_folds(RoundSurface(now));
    if (folds > made.folds) {
      made.warnings = {{Code::fairest_folds}};
      continue;
    }
    terms = std::move(now);
    made.folds = folds;
    made.energy_after = candidate.energy;
    break;
  }
}

RoundPatch round_made(const Side& side, const PolygonPatchOptions& options, const RoundAsked& asked, double size) {
  RoundPatch made;
  const RoundBase base = round_base(side, asked, size, asked.order);
  made.side = base.side;
  std::vector<Harmonic> terms = base.terms;
  made.folds = count_round_folds(RoundSurface(terms));
  if (options.fairing) {
    FairingOptions fairing;
    fairing.energy = *options.fairing;
    fairing.tension = options.tension;
    fairing.degree = 6;
    fairing.slopes = 5;  // constant, and two waves
    if (!asked.through.empty()) fairing.center = asked.through[0].point;
    if (!made_of_revolution(made, terms, base, fairing))
      made_fair(made, terms, base, round_base(side, asked, size, std::min(asked.order, measured_waves)), fairing);
  }
  if (asked.continuity == SideContinuity::g2) {
    terms = terms_through(with_curvature(terms, base.side, asked.order), asked.through, size);
    made.folds = count_round_folds(RoundSurface(terms));
  }
  made.patch = std::make_shared<const RoundSurface>(std::move(terms));
  return made;
}

/// Where the patch comes nearest to a point: Gauss-Newton from the nearest place of a grid, kept off the rim.
Vec2 nearest_in_disc(const Surface& patch, const Vec3& point) {
  constexpr double off_rim = share::trace;  // what is added vanishes at the rim
  constexpr int rings = count::dozen, angles = rings * 3;
  Points grid = Points::Zero(1 + rings * angles, 3);
  for (int k = 0; k < rings * angles; ++k) {
    const int ring = k / angles + 1;
    const double r = (1 - off_rim) * ring / rings;
    grid.row(1 + k).head<2>() = r * on_circle(static_cast<double>(k % angles) / angles);
  }
  Index best = 0;
  (patch.positions(grid).rowwise() - point.transpose()).rowwise().squaredNorm().minCoeff(&best);
  Vec2 place = grid.row(best).head<2>();
  for (int step = 0; step < 8; ++step) {
    const Vec2 move = foot_at(patch, place, point).step;
    if (!move.allFinite()) break;
    place += move;
    if (place.norm() > 1 - off_rim) place *= (1 - off_rim) / place.norm();
  }
  return place;
}

template <class T>
T single(const std::vector<T>& values, const T& otherwise, const char* name) {
  if (values.size() > 1) refuse_count(name, values.size(), 1);
  return values.empty() ? otherwise : values[0];
}

RoundAsked round_asked(const PolygonPatchOptions& options, int order) {
  RoundAsked asked = {
      single(options.continuity, SideContinuity::automatic, "continuity"), single(options.bulge, 1.0, "bulge"), {}, order};
  if (options.center) asked.through.push_back({Vec2::Zero(), *options.center, {}});
  return asked;
}

}  // namespace

bool is_of_revolution(const Side& side, const PolygonPatchOptions& options, int order) {
  return axis_of(terms_of_base({side, order}, round_asked(options, order), rim_diameter(side.c), order)).has_value();
}

RoundPatch round_patch(const Side& side, const PolygonPatchOptions& options, int order) {
  const double size = rim_diameter(side.c);
  check_round(side, size);
  check_shape_options(options.fairing.has_value(), options.tension, options.center.has_value(), options.center_offset);
  RoundAsked asked = round_asked(options, order);
  if (asked.continuity == SideContinuity::g2 && side.q.empty()) throw CodedRefusal(Code::curvature_unknown, {{"side", 0}});
  RoundPatch made = round_made(side, options, asked, size);
  if (options.center_offset != 0 || !options.through.empty()) {
    if (options.center_offset != 0) {
      const auto [position, normal] = made.patch->positions_and_normals(Points::Zero(1, 3));
      asked.through.push_back({Vec2::Zero(), Vec3(position.row(0) + options.center_offset * normal.row(0)), {}});
    }
    for (const Through& t : options.through) asked.through.push_back({nearest_in_disc(*made.patch, t.point), t.point, t.normal});
    made = round_made(side, options, asked, size);
    for (std::size_t k = asked.through.size() - options.through.size(); k < asked.through.size(); ++k)
      made.met.push_back(asked.through[k].uv);
  }
  made.continuity = kept_by(asked.continuity);
  measure_round_seam(made);
  return made;
}

RoundPatch begun_at(RoundPatch made, double t) {
  std::vector<Harmonic> terms = made.patch->terms();
  for (Harmonic& term : terms)
    for (Index k = 1; 2 * k < term.rows(); ++k) {
      const Vec2 turn = on_circle(static_cast<double>(k) * t);
      const Vec3 a = term.row(2 * k - 1), b = term.row(2 * k);
      term.row(2 * k - 1) = turn[0] * a + turn[1] * b;
      term.row(2 * k) = turn[0] * b - turn[1] * a;
    }
  made.patch = std::make_shared<const RoundSurface>(std::move(terms));
  const double curvature_error = made.side.curvature_error;
  made.side = piece_of(made.side, t, 1 + t);
  made.side.curvature_error = curvature_error;
  const Vec2 turn = on_circle(t);
  for (Vec2& place : made.met) place = Vec2(turn[0] * place[0] + turn[1] * place[1], turn[0] * place[1] - turn[1] * place[0]);
  return made;
}

double round_energy(const Surface& surface, Fairing of) {
  Points rim = Points::Zero(48, 3);
  for (Index k = 0; k < rim.rows(); ++k) rim.row(k).head<2>() = on_circle(static_cast<double>(k) / 48);
  const Points p = surface.positions(rim);
  double size = 0;
  for (Index k = 0; k < p.rows(); ++k) size = std::max(size, (p.rowwise() - p.row(k)).rowwise().norm().maxCoeff());
  const RoundSpace& space = round_space(0, 1, energy_nodes_round);
  return weighed_energy(plane_derivatives(surface, space.uv), space.weights, of, size);
}

}  // namespace tripatch
