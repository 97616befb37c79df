#include "tripatch/quads/grown_quads.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "tripatch/math/interruption.h"
#include "tripatch/math/lru_cache.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/math/tolerant_compare.h"
#include "tripatch/quads/quad_growth.h"
#include "tripatch/quads/spread.h"

namespace tripatch {
namespace {

/// What is walked at most in trying: some milliseconds.
constexpr Index max_work = count::million;
/// Of a rim. The work for each quad grows with the edges of its front, and there are as many as the square of these: a fifth of a second.
constexpr Index max_edges = count::quadratic;
// Reported of 400 outlines is of ellipses and lobes of 6 to 29 edges that want corners at random: how many of them get a layout whose
// least scaled Jacobian is 0.05 lower, and how many one that is 0.05 higher, or none and one.
/// Quads in a rim of n edges, at most: n^2 over this, and four. Between four corners n^2 / 16 grow, between two n^2 / 8, on a ring of quads
/// n^2 / 16 + n, which is as many at 8 edges; a front that turns by less never closes. Of 2,000 ellipses and lobes of 6 to 29 edges 220 change
/// with 12, one with 4.
constexpr Index squared_edges_a_quad = count::octet, few_quads = count::several;
/// Poles that are planned, inside or on the rim; one more may follow from where a front closes. With two 113 of 400 lower, 1 higher; with four
/// 5 and 71.
constexpr int max_planned = count::few;
/// Of a plane layout: with a larger least scaled Jacobian no more poles are tried. With 0.2 17 of 400 lower, with 0.45 17 higher.
constexpr double good = share::three_tenths;
/// Of the logarithm of how many faces there are against squares of the rim's edges. A choice: a third more cost as much as a pole and a half.
constexpr double crowding_price = share::tenth;
/// Of the layouts with as many poles, the best as they are embedded: those that are smoothed and compared. With two 5 of 400 lower, with eight
/// 4 higher.
constexpr std::size_t max_smoothed = count::several;
/// Of those that are embedded, with as many poles. With 12 38 of 400 lower, 7 higher; with 48 6 and 39.
constexpr std::size_t max_embedded = count::dozens;

/// A pole that is planned: on the rim, where a quad more or less than wanted is taken, or inside.
struct PlannedPole {
  bool on_rim = false;
  Index place = 0;
  int change = 0;  ///< of the quads there, against those wanted, or against four
};

/// Ways to turn the four corners of a round front that are tried: of a rim of up to 62 edges all. A choice.
constexpr std::size_t max_turns = count::places;

struct GrownCandidate {
  PlaneLayout layout;
  double score = 0;
  double irregular = 0;
};

/// Numbers that are strewn evenly, and in no order, below others.
class LowDiscrepancy {
public:
  std::size_t next(std::size_t below) {
    constexpr std::uint64_t golden = 0x9e3779b97f4a7c15;  // of the whole range: multiples of the golden ratio
    at_ += golden;
    const std::uint64_t mixed = (at_ ^ (at_ >> 31)) * golden;
    return static_cast<std::size_t>((mixed >> 32) * below >> 32);
  }

private:
  std::uint64_t at_ = 0;
};

class GrowthSearch {
public:
  GrowthSearch(const PlanePoints& rim, const std::vector<int>& wanted)
      : rim_(rim), wanted_(wanted), growth_(max_quads(rim.rows() + (is_odd() ? 1 : 0))) {
    int turns = 0;
    for (const int quads : wanted) turns += 2 - quads;
    charge_ = 4 - turns - (is_odd() ? 1 : 0);
    double area = 0, length = 0;
    for (Index k = 0; k < rim.rows(); ++k) {
      const Vec2 a = rim.row(k), b = rim.row((k + 1) % rim.rows());
      area += (a[0] * b[1] - a[1] * b[0]) / 2;
      length += (b - a).norm();
    }
    const double edge = length / static_cast<double>(rim.rows());
    squares_ = std::max(1.0, area / (edge * edge));
  }

  std::optional<PlaneLayout> run() {
    for (int planned = 0; planned <= max_planned; ++planned) {
      try_all(planned);
      compare();
      if (best_ && best_least_ > good) break;
    }
    if (!best_) return {};
    return std::move(best_->layout);
  }

private:
  static Index max_quads(Index edges) { return edges * edges / squared_edges_a_quad + few_quads; }

  std::vector<PlannedPole> choices() const {
    std::vector<PlannedPole> all;
    for (Index k = 0; k < rim_.rows(); ++k)
      for (const int change : {-1, 1})
        if (wanted_[static_cast<std::size_t>(k)] + change > 0) all.push_back({true, k, change});
    for (Index k = 0; k < max_grown_; ++k)
      for (const int change : {-1, 1}) all.push_back({false, k, change});
    return all;
  }

  /// All ways to plan so many poles, or as many of them, evenly strewn, as there is work left for.
  void try_all(int planned) {
    const std::vector<PlannedPole> all = choices();
    const std::size_t count = all.size();
    double ways = 1;
    for (int k = 0; k < planned; ++k) ways *= static_cast<double>(count - static_cast<std::size_t>(k)) / (k + 1);
    const Index until = work_ + (max_work - work_) / (max_planned + 1 - planned);
    const double a_way = static_cast<double>(rim_.rows() * rim_.rows()) / 4;
    const bool strewn = ways * a_way > static_cast<double>(until - work_);
    std::vector<std::size_t> chosen(static_cast<std::size_t>(planned));
    for (std::size_t k = 0; k < chosen.size(); ++k) chosen[k] = k;
    LowDiscrepancy strewn_places;
    std::vector<PlannedPole> plan;
    while (work_ < until && candidates_.size() < max_embedded) {
      if (strewn) {
        for (std::size_t& choice : chosen) choice = strewn_places.next(count);
        std::sort(chosen.begin(), chosen.end());
        if (++work_; std::adjacent_find(chosen.begin(), chosen.end()) != chosen.end()) continue;
      }
      plan.clear();
      int left = charge_;
      for (const std::size_t choice : chosen) {
        plan.push_back(all[choice]);
        left += all[choice].change;
      }
      if (std::abs(left) <= 1 || planned == 0) grow_with_triangle(plan, strewn, strewn_places);
      if (strewn) continue;
      std::size_t k = chosen.size();
      while (k > 0 && chosen[k - 1] == count - chosen.size() + k - 1) --k;
      if (k == 0) break;
      ++chosen[k - 1];
      for (; k < chosen.size(); ++k) chosen[k] = chosen[k - 1] + 1;
    }
  }

  bool is_odd() const { return rim_.rows() % 2 != 0; }

  /// Of an odd rim one edge gets a triangle: a quad with a corner amid the edge. Any edge is tried, or one that is strewn.
  void grow_with_triangle(const std::vector<PlannedPole>& plan, bool strewn, LowDiscrepancy& places) {
    if (!is_odd()) return grow(plan, {});
    const std::size_t count = static_cast<std::size_t>(rim_.rows());
    if (strewn) return grow(plan, places.next(count));
    for (std::size_t edge = 0; edge < count; ++edge) grow(plan, edge);
  }

  void grow(const std::vector<PlannedPole>& planned, std::optional<std::size_t> triangle) {
    check_interruption();
    plan_.wanted = wanted_;
    plan_.poles.clear();
    for (const PlannedPole& choice : planned) {
      if (choice.on_rim) {
        if ((plan_.wanted[static_cast<std::size_t>(choice.place)] += choice.change) < 1) return;
      } else {
        if (!plan_.poles.empty() && plan_.poles.back().at == choice.place) return;
        plan_.poles.push_back({choice.place, 4 + choice.change});
      }
    }
    if (triangle) plan_.wanted.insert(plan_.wanted.begin() + static_cast<Index>(*triangle) + 1, 1);
    const Index off = static_cast<Index>(planned.size() - plan_.poles.size());
    plan_.ringed = false;
    plan_.turn = 0;
    grow_planned(triangle, off);
    if (!growth_.was_round()) return;
    const std::size_t half = plan_.wanted.size() / 2, step = std::max<std::size_t>(1, half / max_turns);
    for (plan_.turn = step; plan_.turn < half; plan_.turn += step) grow_planned(triangle, off);
    plan_.ringed = true;
    plan_.turn = 0;
    grow_planned(triangle, off);
  }

  /// off: how many of the rim's vertices get other than they want.
  void grow_planned(std::optional<std::size_t> triangle, Index off) {
    const bool grown = growth_.run(plan_);
    work_ += growth_.work() + rim_.rows();
    max_grown_ = std::max(max_grown_, growth_.grown());
    if (!grown) return;
    GrownCandidate candidate;
    candidate.irregular = static_cast<double>(growth_.poles.size()) + static_cast<double>(off + growth_.off_on_rim());
    PlaneLayout& layout = candidate.layout;
    layout.rim = rim_.rows();
    layout.faces = growth_.faces();
    layout.poles = growth_.poles;
    Index vertices = growth_.vertices();
    if (triangle) {
      const Index middle = static_cast<Index>(*triangle) + 1;
      layout.faces = without(layout.faces, middle);
      for (Index& pole : layout.poles) --pole;
      --vertices;
    }
    layout.uv = PlanePoints::Zero(vertices, 2);
    layout.uv.topRows(layout.rim) = rim_;
    embed(layout);
    const QuadQuality quality = quad_quality(as_rows(layout.uv), layout.faces);
    candidate.score = quality.least + quality.mean - crowding(layout.faces.size());
    candidates_.push_back(std::move(candidate));
  }

  /// What it costs to have more or fewer faces than squares of the rim's edges fill it.
  double crowding(Index faces) const { return crowding_price * std::abs(std::log(static_cast<double>(faces) / squares_)); }

  /// Faces without a vertex, which those behind it move up to.
  static Faces without(const Faces& faces, Index gone) {
    Faces left;
    for (Index f = 0; f < faces.size(); ++f) {
      std::vector<Index> face;
      for (const Index v : faces[f])
        if (v != gone) face.push_back(v > gone ? v - 1 : v);
      left.add(face);
    }
    return left;
  }

  void compare() {
    std::stable_sort(candidates_.begin(), candidates_.end(),
                     [](const GrownCandidate& a, const GrownCandidate& b) { return coarse(a.score) > coarse(b.score); });
    if (candidates_.size() > max_smoothed) candidates_.resize(max_smoothed);
    for (GrownCandidate& candidate : candidates_) {
      candidate.score = score_of_trial(candidate.layout, candidate.irregular) - crowding(candidate.layout.faces.size());
      if (best_ && !clearly_more(candidate.score, best_->score)) continue;
      best_ = std::move(candidate);
      best_least_ = quad_quality(as_rows(best_->layout.uv), best_->layout.faces).least;
    }
    candidates_.clear();
  }

  const PlanePoints& rim_;
  const std::vector<int>& wanted_;
  int charge_ = 0;
  double squares_ = 1;
  AdvancingFront growth_;
  GrowthPlan plan_;
  Index work_ = 0, max_grown_ = 0;
  std::vector<GrownCandidate> candidates_;
  std::optional<GrownCandidate> best_;
  double best_least_ = 0;
};

/// Of the way from a vertex of the rim to the middle of the faces there: where the innermost of the rings begins, before they are smoothed.
/// A choice.
constexpr double rings_reach = share::half;
constexpr int sweeps_of_rings = count::sweeps;  ///< a choice: what follows smooths on

}  // namespace

std::optional<PlaneLayout> grown_quads(const PlanePoints& rim, const std::vector<int>& wanted) {
  if (rim.rows() < 3 || rim.rows() > max_edges) return {};
  static LruCache<std::optional<PlaneLayout>> last;
  Key key;
  for (const int quads : wanted) key.add(quads);
  for (Index k = 0; k < rim.rows(); ++k) key.add(rim.row(k));
  if (const auto kept = last.find(key)) return *kept;
  return *last.keep(std::move(key), std::make_shared<const std::optional<PlaneLayout>>(GrowthSearch(rim, wanted).run()));
}

PlaneLayout with_rows(const PlaneLayout& layout, int rows) {
  const Index n = layout.rim;
  PlaneLayout made;
  made.rim = n;
  made.uv = PlanePoints::Zero(layout.uv.rows() + rows * n, 2);
  made.uv.topRows(n) = layout.uv.topRows(n);
  made.uv.bottomRows(layout.uv.rows() - n) = layout.uv.bottomRows(layout.uv.rows() - n);
  for (Index ring = 0; ring < rows; ++ring)
    for (Index k = 0; k < n; ++k) {
      const Index outer = ring * n, next = (k + 1) % n;
      made.faces.add(std::array<Index, 4>{outer + k, outer + next, outer + n + next, outer + n + k});
    }
  PlanePoints middles = PlanePoints::Zero(n, 2);  // of the faces at a vertex of the rim
  Eigen::VectorXd at_rim = Eigen::VectorXd::Zero(n);
  for (Index f = 0; f < layout.faces.size(); ++f) {
    std::vector<Index> face(layout.faces[f].begin(), layout.faces[f].end());
    const Eigen::RowVector2d middle = layout.uv(face, Eigen::all).colwise().mean();
    for (Index& v : face) {
      if (v < n) {
        middles.row(v) += middle;
        ++at_rim[v];
      }
      v += rows * n;  // the rim's vertices become those of the innermost ring
    }
    made.faces.add(face);
  }
  for (Index k = 0; k < n; ++k)
    for (Index ring = 1; ring <= rows; ++ring)
      made.uv.row(ring * n + k) +=
          layout.uv.row(k) + rings_reach * static_cast<double>(ring) / rows * (middles.row(k) / at_rim[k] - layout.uv.row(k));
  std::vector<int> quads(static_cast<std::size_t>(made.uv.rows()), 0);
  for (const Index v : made.faces.corners) ++quads[static_cast<std::size_t>(v)];
  for (Index v = n; v < made.uv.rows(); ++v)
    if (quads[static_cast<std::size_t>(v)] != 4) made.poles.push_back(v);
  smooth_quads(made, sweeps_of_rings);
  return made;
}

}  // namespace tripatch
