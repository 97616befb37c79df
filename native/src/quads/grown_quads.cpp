#include "tripatch/quads/grown_quads.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <numbers>

#include "tripatch/math/angle.h"
#include "tripatch/math/interruption.h"
#include "tripatch/math/kept.h"
#include "tripatch/math/ties.h"

namespace tripatch {
namespace {

/// A vertex of a front, and how many quads it still wants on the side to be filled.
struct Spot {
  Index vertex = 0;
  int wanted = 0;
};
/// A loop still to be filled, counterclockwise.
using Front = std::vector<Spot>;

/// On the lattice that a front is unrolled on, each of its edges one step long.
struct Step {
  int x = 0, y = 0;
  bool operator==(const Step&) const = default;
};
Step operator+(Step a, Step b) { return {a.x + b.x, a.y + b.y}; }
Step operator-(Step a, Step b) { return {a.x - b.x, a.y - b.y}; }
/// To the right, upwards, to the left, downwards.
int turned(int direction) { return ((direction % 4) + 4) % 4; }
Step along(int direction) {
  constexpr std::array<Step, 4> steps = {{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};
  return steps[static_cast<std::size_t>(turned(direction))];
}

/// A pole that is planned: the vertex that grows as number `at`, and its valence.
struct Pole {
  Index at = 0;
  int valence = 4;
};

/// What is tried: the quads at each vertex of the rim, the poles that are planned, by rising number, and how a front without corners gets four:
/// on a ring of quads or not, the first so many vertices on.
struct GrowthPlan {
  std::vector<int> wanted;
  std::vector<Pole> poles;
  bool ringed = false;
  std::size_t turn = 0;
};

/// Tries to fill a rim, one after the other.
class Growth {
public:
  explicit Growth(Index most) : most_(most) {}

  bool run(const GrowthPlan& plan) {
    plan_ = &plan;
    used_ = 0;
    round_ = false;
    off_on_rim_ = work_ = 0;
    quads_.clear();
    poles.clear();
    left_.clear();
    first_ = vertices_ = static_cast<Index>(plan.wanted.size());
    front_.clear();
    for (const int quads : plan.wanted) front_.push_back({static_cast<Index>(front_.size()), quads});
    bool good = fill(front_);
    while (good && !left_.empty()) {
      Front front = std::move(left_.back());
      left_.pop_back();
      good = fill(front);
    }
    return good && planned_all();
  }

  bool planned_all() const { return used_ == plan_->poles.size(); }
  /// Whether a front had no corners; and how many of the rim's vertices got other than they want for that.
  bool was_round() const { return round_; }
  Index off_on_rim() const { return off_on_rim_; }
  /// How many vertices have grown, and how much was walked for it.
  Index grown() const { return vertices_ - first_; }
  Index work() const { return work_; }

  Faces faces() const {
    Faces all;
    for (const std::array<Index, 4>& quad : quads_) all.add(quad);
    return all;
  }
  std::vector<Index> poles;
  Index vertices() const { return vertices_; }

private:
  /// Where a vertex of a front lies on the lattice, and the directions of the edges to it and from it.
  struct Place {
    Step at;
    int in = 0, out = 0;
  };

  bool fill(Front& front) {
    std::size_t from = 0;
    while (front.size() > 4) {
      const std::size_t count = front.size();
      std::size_t v = 0;
      while (v < count && front[(from + v) % count].wanted != 1) ++v;
      if (v == count) {
        if (!make_round(front)) return false;
        continue;
      }
      v = (from + v) % count;
      from = v;
      if (!close(front, v)) return false;
    }
    if (front.size() < 4) return front.empty();
    for (const Spot& spot : front)
      if (spot.wanted != 1) return false;
    quads_.push_back(std::array{front[0].vertex, front[1].vertex, front[2].vertex, front[3].vertex});
    return true;
  }

  /// A front that has no corner, only vertices that it runs straight on at, gets four, on the rim or on a ring of quads within.
  bool make_round(Front& front) {
    const std::size_t count = front.size(), half = count / 2;
    for (const Spot& spot : front)
      if (spot.wanted != 2) return false;
    if (!planned_all() || count % 2 != 0) return false;
    round_ = true;
    if (plan_->ringed) {
      const Index made = vertices_;
      vertices_ += static_cast<Index>(count);
      for (std::size_t k = 0; k < count; ++k) {
        const Index next = static_cast<Index>((k + 1) % count), here = static_cast<Index>(k);
        quads_.push_back(std::array{front[k].vertex, front[(k + 1) % count].vertex, made + next, made + here});
      }
      for (std::size_t k = 0; k < count; ++k) front[k].vertex = made + static_cast<Index>(k);
    }
    for (const std::size_t corner : {std::size_t{0}, half / 2, half, half + half / 2}) {
      Spot& spot = front[(corner + plan_->turn) % count];
      spot.wanted = 1;
      if (spot.vertex < first_) {
        ++off_on_rim_;
      } else {
        poles.push_back(spot.vertex);
      }
    }
    return true;
  }

  /// A quad at the v-th vertex of a front, which wants no other.
  bool close(Front& front, std::size_t v) {
    const std::size_t count = front.size();
    const auto at = [&](std::size_t k) -> Spot& { return front[(v + k) % count]; };
    Spot &next = at(1), &previous = at(count - 1);
    if (static_cast<Index>(quads_.size()) >= most_) return false;
    if (previous.wanted == 1 || next.wanted == 1) {  // across a corridor
      const bool before = previous.wanted == 1;
      Spot &one = before ? at(count - 2) : previous, &other = before ? next : at(2);
      if (one.wanted < 2 || other.wanted < 2) return false;
      if (before)
        quads_.push_back(std::array{one.vertex, previous.vertex, front[v].vertex, other.vertex});
      else
        quads_.push_back(std::array{one.vertex, front[v].vertex, next.vertex, other.vertex});
      --one.wanted;
      --other.wanted;
      const std::size_t gone = v, also = before ? (v + count - 1) % count : (v + 1) % count;
      front.erase(front.begin() + static_cast<Index>(std::max(gone, also)));
      front.erase(front.begin() + static_cast<Index>(std::min(gone, also)));
      return true;
    }
    // A new vertex opposite, unless one is there already.
    const int charge = charge_of(front);
    const bool all = planned_all();
    if (all && std::abs(charge) > 1) return false;
    unroll(front, v);
    if (charge != 0) unroll_backwards(front, v);
    work_ += static_cast<Index>(count);
    constexpr Step opposite = {1, 1};
    std::optional<Step> apex;
    if (all) {
      if (charge == 0 && !(forwards_[count].at == Step{})) return false;
      if (charge != 0) apex = center(forwards_[count].at, charge);
      if (charge != 0 && !apex) return false;
    }
    for (std::size_t k = 4; k + 4 <= count; k += 2) {
      if (forwards_[k].at == opposite && part(front, v, k, forwards_[k], true)) return true;
      if (charge != 0 && backwards_[k].at == opposite && part(front, v, k, backwards_[k], false)) return true;
    }
    int valence = 4;
    if (!all && plan_->poles[used_].at == grown()) {
      valence = plan_->poles[used_++].valence;
    } else if (apex && *apex == opposite) {
      valence = 4 - charge;
    }
    const Index made = vertices_++;
    if (valence != 4) poles.push_back(made);
    quads_.push_back(std::array{previous.vertex, front[v].vertex, next.vertex, made});
    --previous.wanted;
    --next.wanted;
    front[v] = {made, valence - 1};
    return true;
  }

  /// The quad at v whose fourth vertex is the k-th on, which parts the front in two. False where they do not lie on one sheet: the part
  /// along which they were found to meet, forwards or backwards, has no pole inside.
  bool part(Front& front, std::size_t v, std::size_t k, const Place& there, bool forwards) {
    const std::size_t count = front.size();
    const auto at = [&](std::size_t j) -> const Spot& { return front[(v + j) % count]; };
    const auto quads = [](int in, int out) {
      const int turn = turned(out - in);
      return 2 - (turn == 3 ? -1 : turn);
    };
    const int one = quads(there.in, 3), other = quads(0, there.out);  // before the new quad and behind it
    if (one < 1 || other < 1 || one + 1 + other != at(k).wanted) return false;
    Front first, second;
    for (std::size_t j = 1; j <= k; ++j) first.push_back(at(j));
    --first.front().wanted;
    first.back().wanted = one;
    for (std::size_t j = k; j < count; ++j) second.push_back(at(j));
    second.front().wanted = other;
    --second.back().wanted;
    if (charge_of(forwards ? first : second) != 0) return false;
    quads_.push_back(std::array{at(count - 1).vertex, at(0).vertex, at(1).vertex, at(k).vertex});
    left_.push_back(std::move(second));
    left_.push_back(std::move(first));
    front.clear();
    return true;
  }

  /// From the v-th vertex on, at the origin with the edge from it to the right; the last is that vertex again.
  void unroll(const Front& front, std::size_t v) {
    const std::size_t count = front.size();
    forwards_.resize(count + 1);
    Place last = {{}, turned(front[v].wanted - 2), 0};
    forwards_[0] = last;
    for (std::size_t k = 1, at = v; k <= count; ++k) {
      if (++at == count) at = 0;
      last = {last.at + along(last.out), last.out, turned(last.out + 2 - front[at].wanted)};
      forwards_[k] = last;
    }
  }
  void unroll_backwards(const Front& front, std::size_t v) {
    const std::size_t count = front.size();
    backwards_.resize(count + 1);
    Place next = {{}, turned(front[v].wanted - 2), 0};
    backwards_[count] = next;
    for (std::size_t k = count, at = v; k-- > 0;) {
      at = (at == 0 ? count : at) - 1;
      next = {next.at - along(next.in), turned(next.in - 2 + front[at].wanted), next.in};
      backwards_[k] = next;
    }
  }

  /// Of the vertices inside: the sum of 4 less their valence.
  static int charge_of(const Front& front) {
    int turns = 0;
    for (const Spot& spot : front) turns += 2 - spot.wanted;
    return 4 - turns;
  }
  /// About which point of the lattice a front turns that ends at a step off its beginning, a right angle too little or too far.
  static std::optional<Step> center(Step end, int charge) {
    const Step twice = charge > 0 ? Step{end.x + end.y, end.y - end.x} : Step{end.x - end.y, end.x + end.y};
    if (twice.x % 2 != 0 || twice.y % 2 != 0) return {};
    return Step{twice.x / 2, twice.y / 2};
  }

  const GrowthPlan* plan_ = nullptr;
  bool round_ = false;
  Index off_on_rim_ = 0;
  std::size_t used_ = 0;
  Index most_, first_ = 0, vertices_ = 0, work_ = 0;
  Front front_;
  std::vector<Front> left_;
  std::vector<std::array<Index, 4>> quads_;
  std::vector<Place> forwards_, backwards_;  ///< of the front and vertex that are looked at
};

/// What is walked at most in trying: some milliseconds.
constexpr Index most_work = 1'000'000;
/// Of a rim. The work for each quad grows with the edges of its front, and there are as many as the square of these: a fifth of a second.
constexpr Index most_edges = 1000;
// Reported of 400 outlines is of ellipses and lobes of 6 to 29 edges that want corners at random: how many of them get a layout whose
// least scaled Jacobian is 0.05 lower, and how many one that is 0.05 higher, or none and one.
/// Quads in a rim of n edges, at most: n^2 over this, and four. Between four corners n^2 / 16 grow, between two n^2 / 8, on a ring of quads
/// n^2 / 16 + n, which is as many at 8 edges; a front that turns by less never closes. Of 2,000 ellipses and lobes of 6 to 29 edges 220 change
/// with 12, one with 4.
constexpr Index squared_edges_a_quad = 8, few_quads = 4;
/// Poles that are planned, inside or on the rim; one more may follow from where a front closes. With two 113 of 400 lower, 1 higher; with four
/// 5 and 71.
constexpr int most_planned = 3;
/// Of a plane layout: with a larger least scaled Jacobian no more poles are tried. With 0.2 17 of 400 lower, with 0.45 17 higher.
constexpr double good = 0.3;
/// Of the logarithm of how many faces there are against squares of the rim's edges. A choice: a third more cost as much as a pole and a half.
constexpr double crowding_price = 0.1;
/// Of the layouts with as many poles, the best as they are embedded: those that are smoothed and compared. With two 5 of 400 lower, with eight
/// 4 higher.
constexpr std::size_t most_smoothed = 4;
/// Of those that are embedded, with as many poles. With 12 38 of 400 lower, 7 higher; with 48 6 and 39.
constexpr std::size_t most_embedded = 24;

/// A pole that is planned: on the rim, where a quad more or less than wanted is taken, or inside.
struct PlannedPole {
  bool on_rim = false;
  Index place = 0;
  int change = 0;  ///< of the quads there, against those wanted, or against four
};

/// Ways to turn the four corners of a round front that are tried: of a rim of up to 62 edges all. A choice.
constexpr std::size_t most_turns = 16;

struct GrownCandidate {
  PlaneLayout layout;
  double score = 0;
  double irregular = 0;
};

/// Numbers that are strewn evenly, and in no order, below others.
class Strewn {
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
      : rim_(rim), wanted_(wanted), growth_(most_quads(rim.rows() + (is_odd() ? 1 : 0))) {
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
    for (int planned = 0; planned <= most_planned; ++planned) {
      try_all(planned);
      compare();
      if (best_ && best_least_ > good) break;
    }
    if (!best_) return {};
    return std::move(best_->layout);
  }

private:
  static Index most_quads(Index edges) { return edges * edges / squared_edges_a_quad + few_quads; }

  std::vector<PlannedPole> choices() const {
    std::vector<PlannedPole> all;
    for (Index k = 0; k < rim_.rows(); ++k)
      for (const int change : {-1, 1})
        if (wanted_[static_cast<std::size_t>(k)] + change > 0) all.push_back({true, k, change});
    for (Index k = 0; k < most_grown_; ++k)
      for (const int change : {-1, 1}) all.push_back({false, k, change});
    return all;
  }

  /// All ways to plan so many poles, or as many of them, evenly strewn, as there is work left for.
  void try_all(int planned) {
    const std::vector<PlannedPole> all = choices();
    const std::size_t count = all.size();
    double ways = 1;
    for (int k = 0; k < planned; ++k) ways *= static_cast<double>(count - static_cast<std::size_t>(k)) / (k + 1);
    const Index until = work_ + (most_work - work_) / (most_planned + 1 - planned);
    const double a_way = static_cast<double>(rim_.rows() * rim_.rows()) / 4;
    const bool strewn = ways * a_way > static_cast<double>(until - work_);
    std::vector<std::size_t> chosen(static_cast<std::size_t>(planned));
    for (std::size_t k = 0; k < chosen.size(); ++k) chosen[k] = k;
    Strewn strewn_places;
    std::vector<PlannedPole> plan;
    while (work_ < until && candidates_.size() < most_embedded) {
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
  void grow_with_triangle(const std::vector<PlannedPole>& plan, bool strewn, Strewn& places) {
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
    const std::size_t half = plan_.wanted.size() / 2, step = std::max<std::size_t>(1, half / most_turns);
    for (plan_.turn = step; plan_.turn < half; plan_.turn += step) grow_planned(triangle, off);
    plan_.ringed = true;
    plan_.turn = 0;
    grow_planned(triangle, off);
  }

  /// off: how many of the rim's vertices get other than they want.
  void grow_planned(std::optional<std::size_t> triangle, Index off) {
    const bool grown = growth_.run(plan_);
    work_ += growth_.work() + rim_.rows();
    most_grown_ = std::max(most_grown_, growth_.grown());
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
    if (candidates_.size() > most_smoothed) candidates_.resize(most_smoothed);
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
  Growth growth_;
  GrowthPlan plan_;
  Index work_ = 0, most_grown_ = 0;
  std::vector<GrownCandidate> candidates_;
  std::optional<GrownCandidate> best_;
  double best_least_ = 0;
};

/// Of the way from a vertex of the rim to the middle of the faces there: where the innermost of the rings begins, before they are smoothed.
/// A choice.
constexpr double rings_reach = 0.5;
constexpr int sweeps_of_rings = 20;  ///< a choice: what follows smooths on

/// Of one rim, which a cage lays out several times. A choice.
constexpr std::size_t kept_layouts_grown = 6;

/// Of the quads that meet at a vertex, how many the faces around a hole leave.
double quads_left(const Points& vertices, const Connectivity& around, Index v, WantedQuads which) {
  double left = 4;
  for (const Connectivity::Corner c : around.at(v)) {
    const Vec3 at = vertices.row(v), next = vertices.row(around.next(c)), previous = vertices.row(around.previous(c));
    const bool counts = which == WantedQuads::by_number && around.faces()[around.face(c)].size() == 4;
    left -= counts ? 1 : angle_between(next - at, previous - at) / (std::numbers::pi / 2);
  }
  return left;
}

}  // namespace

std::vector<int> wanted_quads(const Points& vertices, const Connectivity& around, const std::vector<Index>& rim,
                              WantedQuads which) {
  std::vector<int> wanted;
  double owed = 0;
  for (const Index v : rim) {
    const double exact = v < around.vertices() ? quads_left(vertices, around, v, which) : 2;  // a new one is on an edge
    const bool whole = coarse(exact) == std::round(exact);
    const int quads = std::max(1, static_cast<int>(std::lround(coarse(exact + (whole ? 0 : owed)))));
    if (!whole) owed += exact - quads;
    wanted.push_back(quads);
  }
  return wanted;
}

std::optional<PlaneLayout> grown_quads(const PlanePoints& rim, const std::vector<int>& wanted) {
  if (rim.rows() < 3 || rim.rows() > most_edges) return {};
  static Kept<std::optional<PlaneLayout>> last(kept_layouts_grown);
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
