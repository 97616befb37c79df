#include "tripatch/quads/polygon_layout.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "tripatch/math/lru_cache.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/math/tolerant_compare.h"
#include "tripatch/quads/quad_builder.h"
#include "tripatch/quads/row_widths.h"
#include "tripatch/quads/spread.h"

namespace tripatch {
namespace {

constexpr std::size_t subsets_tried = count::dozen;  ///< choices of corners for which the integers are sought
/// With each number of corners, embedded, smoothed and measured: of a rim of few edges more, as there it costs little.
constexpr std::size_t layouts_tried = count::pair;
/// Of a rim: of more one layout is tried. Of 60 outlines of three to eight sides in 100 edges nine take the second, whose least scaled
/// Jacobian is 0.05 higher in their mean; it costs as much as the first, half a thousand quads and more.
constexpr Index many_edges = count::hundred;
constexpr Index max_round_starts = count::dozens;  ///< places of a round rim from which a grid's corners are counted
/// Of a round rim: rings that are as wide as these would leave the grid's corners regular.
constexpr Index edges_a_ring = count::dozens;
/// Cuts are sought at about so many places of a side, then moved edge by edge.
constexpr Index places_on_side = count::octet;
constexpr double flat_angle_cost = 20;  ///< of a coarse corner that is straight or turned over: 1 / sin of 3 degrees
/// What a quad too many or too few at a corner costs, next to the angles' 1 / sin - 1: as much as an angle of 56 degrees. And what each
/// corner costs that makes more or less than four.
constexpr double wrong_valence = share::fifth, pole_expected = share::tenth;

double cost_of_sine(double sine) { return sine > 1 / flat_angle_cost ? 1 / sine - 1 : flat_angle_cost - 1; }
double cost_of_angle(double angle) { return angle < std::numbers::pi ? cost_of_sine(std::sin(angle)) : flat_angle_cost - 1; }

/// A side of a piece: a run of the rim, or a cut.
struct PieceSide {
  Index start = 0, count = 0;  ///< of a run, in the rim
  bool cut = false, reversed = false;
  Vec2 from = Vec2::Zero(), to = Vec2::Zero();
};

PieceSide of_rim(Index start, Index count) {
  PieceSide side;
  side.start = start;
  side.count = count;
  return side;
}

class Region {
public:
  explicit Region(const PlanePoints& rim) : rim_(rim) {}

  Vec2 at(const PieceSide& side, Index j) const {
    if (side.cut) return side.from + (side.to - side.from) * (static_cast<double>(j) / static_cast<double>(side.count));
    return rim_.row((side.start + j) % rim_.rows());
  }
  Index edges() const { return rim_.rows(); }
  double mean_edge() const {
    double sum = 0;
    for (Index k = 0; k < edges(); ++k) sum += (rim_.row(k) - rim_.row((k + 1) % edges())).norm();
    return sum / static_cast<double>(edges());
  }
  /// Between the edges at a vertex of the rim.
  double angle(Index k) const {
    const Vec2 p = rim_.row(k), a = rim_.row((k + 1) % edges()).transpose() - p,
               b = rim_.row((k + edges() - 1) % edges()).transpose() - p;
    const double angle = std::atan2(a[0] * b[1] - a[1] * b[0], a.dot(b));
    return angle < 0 ? angle + 2 * std::numbers::pi : angle;
  }

private:
  const PlanePoints& rim_;
};

/// Of one grid of the coarse layout: its corners in order.
double coarse_cost(const std::array<Vec2, 4>& p) {
  double cost = 0;
  std::array<double, 4> length;
  for (int k = 0; k < 4; ++k) length[k] = (p[(k + 1) % 4] - p[k]).norm();
  for (int k = 0; k < 4; ++k) {
    const Vec2 a = p[(k + 1) % 4] - p[k], b = p[(k + 3) % 4] - p[k];
    const double sizes = a.norm() * b.norm();
    cost += 0.5 * (sizes > 0 ? cost_of_sine((a[0] * b[1] - a[1] * b[0]) / sizes) : flat_angle_cost);
  }
  for (int k = 0; k < 2; ++k) {
    const double ratio = std::log((length[k] + tolerance::tiny) / (length[k + 2] + tolerance::tiny));
    cost += 0.5 * std::min(ratio * ratio, flat_angle_cost);
  }
  return cost;
}

/// What a piece's coarse layout costs; nothing where its counts allow none.
std::optional<double> piece_cost(const Region& region, const std::vector<PieceSide>& sides) {
  const std::size_t k = sides.size();
  std::vector<Index> counts;
  Index sum = 0;
  for (const PieceSide& side : sides) {
    counts.push_back(side.count);
    sum += side.count;
  }
  if (k == 4) {
    if (counts[0] != counts[2] || counts[1] != counts[3]) return {};
    return coarse_cost({region.at(sides[0], 0), region.at(sides[1], 0), region.at(sides[2], 0), region.at(sides[3], 0)});
  }
  const bool triangle = k == 3 && sum % 2 == 1;        // in the middle: as a pole of the counts one less
  if (triangle && region.edges() % 2 == 0) return {};  // it would be one of two
  if (triangle)
    for (Index& c : counts) --c;
  const std::vector<Index> spokes = spokes_of(counts);
  if (spokes.empty()) return {};
  const std::size_t on = std::find(spokes.begin(), spokes.end(), 0) - spokes.begin();
  if (on < k && (triangle || !sides[on].cut)) return {};  // no pole on the rim
  std::vector<Vec2> split;
  Vec2 pole = Vec2::Zero();
  for (std::size_t i = 0; i < k; ++i) {
    split.push_back(region.at(sides[i], spokes[(i + k - 1) % k]));
    pole += split.back() / static_cast<double>(k);
  }
  if (on < k) pole = split[on];
  double cost = 0;
  for (std::size_t i = 0; i < k; ++i)
    if (i != on && i != (on + 1) % k) cost += coarse_cost({region.at(sides[i], 0), split[i], pole, split[(i + k - 1) % k]});
  return cost;
}

/// How a region with some corners is laid out: in one piece, or cut from side `first` to side `second`.
struct Plan {
  std::vector<PieceSide> sides;
  bool is_cut = false;
  int rings = 0;  ///< no corners on the rim: `sides` are those of a grid within so many rings of quads
  std::size_t first = 0, second = 0;
  Index from = 0, to = 0, edges = 0;  ///< edges from the starts of these sides, and of the cut
  double cost = 0;
  int irregular = 0;  ///< of its choice of corners
};

std::vector<PieceSide> sides_between(const std::vector<Index>& corners, Index edges) {
  std::vector<PieceSide> sides;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Index next = i + 1 < corners.size() ? corners[i + 1] : corners[0] + edges;
    sides.push_back(of_rim(corners[i], next - corners[i]));
  }
  return sides;
}

PieceSide run(const PieceSide& side, Index from, Index to) { return of_rim(side.start + from, to - from); }

std::array<std::vector<PieceSide>, 2> pieces_of(const Region& region, const Plan& plan) {
  const std::size_t k = plan.sides.size();
  const PieceSide &p = plan.sides[plan.first], &q = plan.sides[plan.second];
  PieceSide there = {0, plan.edges, true, false, region.at(p, plan.from), region.at(q, plan.to)}, back = there;
  std::swap(back.from, back.to);
  back.reversed = true;
  std::array<std::vector<PieceSide>, 2> pieces;
  pieces[0] = {run(p, plan.from, p.count)};
  for (std::size_t i = plan.first + 1; i < plan.second; ++i) pieces[0].push_back(plan.sides[i]);
  pieces[0].push_back(run(q, 0, plan.to));
  pieces[0].push_back(back);
  pieces[1] = {run(q, plan.to, q.count)};
  for (std::size_t i = plan.second + 1; i < plan.first + k; ++i) pieces[1].push_back(plan.sides[i % k]);
  pieces[1].push_back(run(p, 0, plan.from));
  pieces[1].push_back(there);
  return pieces;
}

std::optional<double> cut_cost(const Region& region, const Plan& plan) {
  const Index a = plan.sides[plan.first].count, b = plan.sides[plan.second].count;
  if (plan.from < 1 || plan.from >= a || plan.to < 1 || plan.to >= b || plan.edges < 1) return {};
  double sum = 0;
  for (const std::vector<PieceSide>& piece : pieces_of(region, plan)) {
    const std::optional<double> cost = piece_cost(region, piece);
    if (!cost) return {};
    sum += *cost;
  }
  return sum;
}

/// The best integers of a cut between two sides: on a coarse grid of them, then edge by edge.
std::optional<Plan> best_cut(const Region& region, Plan plan) {
  const Index a = plan.sides[plan.first].count, b = plan.sides[plan.second].count;
  const Index step_a = std::max<Index>(1, a / places_on_side), step_b = std::max<Index>(1, b / places_on_side);
  const double mean = region.mean_edge();
  std::optional<Plan> best;
  const auto look_at = [&](Index from, Index to, Index edges) {
    Plan trial = plan;
    trial.from = from;
    trial.to = to;
    trial.edges = edges;
    const std::optional<double> cost = cut_cost(region, trial);
    if (!cost || (best && !clearly_less(*cost, best->cost))) return false;
    trial.cost = *cost;
    best = std::move(trial);
    return true;
  };
  for (Index from = 1; from < a; from += step_a)
    for (Index to = 1; to < b; to += step_b) {
      const Vec2 p = region.at(plan.sides[plan.first], from), q = region.at(plan.sides[plan.second], to);
      const double ideal = std::max(1.0, (p - q).norm() / mean);
      for (double factor : {0.25, 0.5, 0.75, 1.0, 1.4, 2.0, 3.0})
        for (Index parity : {0, 1}) look_at(from, to, static_cast<Index>(std::lround(coarse(factor * ideal))) + parity);
    }
  for (bool better = best.has_value(); better;) {
    better = false;
    const Plan now = *best;
    for (Index i : {-1, 0, 1})
      for (Index j : {-1, 0, 1})
        for (Index m : {-2, -1, 0, 1, 2}) better = look_at(now.from + i, now.to + j, now.edges + m) || better;
  }
  return best;
}

/// No corners: a ring of quads, and within it a grid whose four corners are poles of valence 3.
std::vector<Plan> round_plans(const Region& region) {
  const Index edges = region.edges(), half = edges / 2, step = std::max<Index>(1, half / max_round_starts);
  std::optional<Plan> best;
  for (Index from = 0; edges % 2 == 0 && from < half; from += step)
    for (Index a = std::max<Index>(1, half / 2 - half / 8); a <= half / 2 + half / 8 && a < half; ++a) {
      Plan plan;
      plan.rings = 1;
      plan.sides = sides_between({from, from + a, from + half, from + half + a}, edges);
      plan.cost = *piece_cost(region, plan.sides);
      if (!best || clearly_less(plan.cost, best->cost)) best = std::move(plan);
    }
  std::vector<Plan> plans;
  if (best) plans.push_back(*best);
  const int wider = static_cast<int>(edges / edges_a_ring);
  if (best && wider > 1) {
    best->rings = wider;
    plans.insert(edges > many_edges ? plans.begin() : plans.end(), *best);
  }
  return plans;
}

/// The layouts that a region with these corners may have.
std::vector<Plan> plans_of(const Region& region, const std::vector<PieceSide>& sides) {
  std::vector<Plan> plans;
  const std::size_t k = sides.size();
  if (k == 0) return round_plans(region);
  Plan plan;
  plan.sides = sides;
  if (k > 2) {
    if (const std::optional<double> cost = piece_cost(region, sides)) {
      plan.cost = *cost;
      plans.push_back(plan);
    } else if (k == 3) {
      plan.cost = flat_angle_cost;  // strips will be needed
      plans.push_back(plan);
    }
  }
  // cut into pieces of 3 + 3, 3 + 5, 5 + 5 sides
  using Cuts = std::vector<std::array<std::size_t, 2>>;
  const Cuts cuts = k == 2   ? Cuts{{0, 1}}
                    : k == 4 ? Cuts{{0, 1}, {1, 2}, {2, 3}, {0, 3}}
                    : k == 6 ? Cuts{{0, 3}, {1, 4}, {2, 5}}
                             : Cuts{};
  plan.is_cut = true;
  for (const auto& [first, second] : cuts) {
    plan.first = first;
    plan.second = second;
    if (std::optional<Plan> found = best_cut(region, plan)) plans.push_back(std::move(*found));
  }
  return plans;
}

/// Paths of the pieces' sides, and the pieces filled.
class PlanBuilder {
public:
  PlanBuilder(const Plan& plan, const Region& region, int rows) : builder(region.edges()), rim_(region.edges()) {
    std::vector<Path> sides;
    for (const PieceSide& side : plan.sides) sides.push_back(path_of(side));
    for (int r = 0; r < rows + plan.rings; ++r) sides = builder.ring(sides);
    if (plan.is_cut) {
      fill_cut(plan, sides);
    } else {
      fill(sides);
    }
  }

  QuadBuilder builder;

private:
  void fill_cut(const Plan& plan, const std::vector<Path>& sides) {
    const std::size_t k = sides.size();
    const Path &p = sides[plan.first], &q = sides[plan.second];
    const Path cut = builder.path(p[plan.from], q[plan.to], plan.edges);
    std::vector<Path> one = {part(p, plan.from, last(p))}, other = {part(q, plan.to, last(q))};
    for (std::size_t i = plan.first + 1; i < plan.second; ++i) one.push_back(sides[i]);
    for (std::size_t i = plan.second + 1; i < plan.first + k; ++i) other.push_back(sides[i % k]);
    one.push_back(part(q, 0, plan.to));
    one.push_back(backwards(cut));
    other.push_back(part(p, 0, plan.from));
    other.push_back(cut);
    fill(one);
    fill(other);
  }

  static Index last(const Path& path) { return static_cast<Index>(path.size()) - 1; }

  Path path_of(const PieceSide& side) const {
    Path path;
    for (Index j = 0; j <= side.count; ++j) path.push_back((side.start + j) % rim_);
    return path;
  }

  void fill(const std::vector<Path>& sides) {
    if (sides.size() == 3) {
      QuadBuilder::Loop loop;
      loop.side = {sides[1], sides[2], sides[0]};
      for (int i = 0; i < 3; ++i) loop.on_rim[i] = loop.side[i][0] < rim_ && loop.side[i].back() < rim_;
      return builder.fill(loop);
    }
    if (sides.size() == 4) return builder.grid(sides);
    std::vector<Index> counts;
    for (const Path& side : sides) counts.push_back(last(side));
    builder.about_pole(sides, spokes_of(counts));
  }

  Index rim_;
};

/// Connectivity of a plan, embedded.
PlaneLayout laid_out(const PlanePoints& rim, const Plan& plan, const Region& region, int rows) {
  PlanBuilder made(plan, region, rows);
  PlaneLayout layout;
  layout.rim = rim.rows();
  layout.faces = std::move(made.builder.faces);
  layout.uv = PlanePoints::Zero(made.builder.vertex_count(), 2);
  layout.uv.topRows(layout.rim) = rim;
  std::vector<int> valence(layout.uv.rows(), 0);
  const RowWidths widths(layout.faces, layout.rim);
  for (const auto& edge : widths.edges())
    for (const Index v : edge) ++valence[v];
  for (Index v = layout.rim; v < layout.uv.rows(); ++v)
    if (valence[v] != 4) layout.poles.push_back(v);
  embed(layout);
  return layout;
}

/// A choice of corners that get one quad each.
struct Choice {
  std::vector<Index> corners;  ///< places in the rim
  double cost = 0;
  int irregular = 0;  ///< quads too many or too few at corners, as far as that is known
};

std::vector<Choice> choices_of(const Region& region, const std::vector<RimCorner>& corners) {
  const std::size_t n = corners.size();
  std::vector<std::array<double, 2>> cost;  // with one quad, with two
  for (const RimCorner& corner : corners) {
    const double angle = region.angle(corner.place);
    cost.push_back({cost_of_angle(angle), cost_of_angle(angle / 2)});
  }
  std::vector<Choice> choices;
  for (std::size_t subset = 0; subset < std::size_t{1} << n; ++subset) {
    Choice choice;
    for (std::size_t k = 0; k < n; ++k) {
      const bool chosen = (subset >> k & 1) != 0;
      if (chosen) choice.corners.push_back(corners[k].place);
      choice.cost += cost[k][chosen ? 0 : 1];
      if (corners[k].quads > 0) choice.irregular += std::abs(corners[k].quads - (chosen ? 1 : 2));
    }
    if (choice.corners.size() == 1) continue;  // it would leave a pole of valence 1 inside
    choice.cost += wrong_valence * choice.irregular + pole_expected * std::abs(static_cast<double>(choice.corners.size()) - 4);
    choices.push_back(std::move(choice));
  }
  std::stable_sort(choices.begin(), choices.end(),
                   [](const Choice& a, const Choice& b) { return coarse(a.cost) < coarse(b.cost); });
  return choices;
}

/// Extra rows with which layouts are tried; with more, what was the fairest with these is taken. Of 292 outlines of three to
/// seven sides of 2 to 8 edges, half are laid out otherwise than if they were chosen with four rows. The least sine is less by
/// .003 in the mean and by .05 at most (.004 and .05 with one; .019 where two rows are chosen with one).
constexpr int max_rows_of_trials = count::pair;

/// The plan of the fairest layout, and that one, of these rows.
struct Chosen {
  Plan plan;
  PlaneLayout layout;
};

Chosen best_plan(const PlanePoints& rim, const std::vector<RimCorner>& corners, int rows) {
  const Region region(rim);
  std::vector<Choice> choices = choices_of(region, corners);
  std::vector<Plan> plans;
  // the best of each number of corners is tried in any case; three take any counts
  std::vector<bool> seen(corners.size() + 1);
  for (std::size_t c = 0; c < choices.size(); ++c) {
    const bool first = !seen[choices[c].corners.size()];
    seen[choices[c].corners.size()] = true;
    if (c >= subsets_tried && !first) continue;
    for (Plan& plan : plans_of(region, sides_between(choices[c].corners, region.edges()))) {
      plan.cost += choices[c].cost;
      plan.irregular = choices[c].irregular;
      plans.push_back(std::move(plan));
    }
  }
  if (plans.empty()) {  // two corners and sides too short to be cut: a third corner in the middle of the longer one
    std::vector<RimCorner> more = corners;
    const Index first = corners[1].place - corners[0].place, edges = region.edges();
    const bool longer = 2 * first >= edges;
    more.insert(more.begin() + (longer ? 1 : 2),
                {longer ? corners[0].place + first / 2 : (corners[1].place + edges + corners[0].place) / 2, 1});
    return best_plan(rim, more, rows);
  }
  std::stable_sort(plans.begin(), plans.end(), [](const Plan& a, const Plan& b) { return coarse(a.cost) < coarse(b.cost); });
  std::vector<std::size_t> tried(corners.size() + 1);
  std::optional<Chosen> best;
  double best_score = 0;
  for (const Plan& plan : plans) {
    if (tried[plan.rings > 0 ? 0 : plan.sides.size()]++ >= (rim.rows() > many_edges ? 1 : layouts_tried)) continue;
    PlaneLayout layout = laid_out(rim, plan, region, rows);
    const double score = score_of_trial(layout, static_cast<double>(layout.poles.size()) + plan.irregular);
    if (best && !clearly_more(score, best_score)) continue;
    best = Chosen{plan, std::move(layout)};
    best_score = score;
  }
  return std::move(*best);
}

}  // namespace

PlaneLayout polygon_layout(const PlanePoints& rim, const std::vector<RimCorner>& corners, int rows) {
  static LruCache<Chosen> last;
  const int tried = std::min(rows, max_rows_of_trials);
  Key key;
  key.add(tried);
  for (const RimCorner& corner : corners) {
    key.add(static_cast<double>(corner.place));
    key.add(corner.quads);
  }
  for (Index k = 0; k < rim.rows(); ++k) key.add(rim.row(k));
  std::shared_ptr<const Chosen> chosen = last.find(key);
  if (!chosen) chosen = last.keep(std::move(key), std::make_shared<const Chosen>(best_plan(rim, corners, tried)));
  if (rows == tried) return chosen->layout;
  PlaneLayout layout = laid_out(rim, chosen->plan, Region(rim), rows);
  smooth_trial(layout);
  return layout;
}

}  // namespace tripatch
