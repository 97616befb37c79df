#include "tripatch/quads/quad_growth.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace tripatch {
namespace {

LatticeStep operator+(LatticeStep a, LatticeStep b) { return {a.x + b.x, a.y + b.y}; }
LatticeStep operator-(LatticeStep a, LatticeStep b) { return {a.x - b.x, a.y - b.y}; }
/// To the right, upwards, to the left, downwards.
int turned(int direction) { return ((direction % 4) + 4) % 4; }
LatticeStep along(int direction) {
  constexpr std::array<LatticeStep, 4> steps = {{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};
  return steps[static_cast<std::size_t>(turned(direction))];
}

}  // namespace

bool AdvancingFront::run(const GrowthPlan& plan) {
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

bool AdvancingFront::fill(Front& front) {
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
  for (const FrontVertex& spot : front)
    if (spot.wanted != 1) return false;
  quads_.push_back(std::array{front[0].vertex, front[1].vertex, front[2].vertex, front[3].vertex});
  return true;
}

bool AdvancingFront::make_round(Front& front) {
  const std::size_t count = front.size(), half = count / 2;
  for (const FrontVertex& spot : front)
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
    FrontVertex& spot = front[(corner + plan_->turn) % count];
    spot.wanted = 1;
    if (spot.vertex < first_) {
      ++off_on_rim_;
    } else {
      poles.push_back(spot.vertex);
    }
  }
  return true;
}

bool AdvancingFront::close(Front& front, std::size_t v) {
  const std::size_t count = front.size();
  const auto at = [&](std::size_t k) -> FrontVertex& { return front[(v + k) % count]; };
  FrontVertex &next = at(1), &previous = at(count - 1);
  if (static_cast<Index>(quads_.size()) >= most_) return false;
  if (previous.wanted == 1 || next.wanted == 1) {  // across a corridor
    const bool before = previous.wanted == 1;
    FrontVertex &one = before ? at(count - 2) : previous, &other = before ? next : at(2);
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
  constexpr LatticeStep opposite = {1, 1};
  std::optional<LatticeStep> apex;
  if (all) {
    if (charge == 0 && !(forwards_[count].at == LatticeStep{})) return false;
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

bool AdvancingFront::part(Front& front, std::size_t v, std::size_t k, const Place& there, bool forwards) {
  const std::size_t count = front.size();
  const auto at = [&](std::size_t j) -> const FrontVertex& { return front[(v + j) % count]; };
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

void AdvancingFront::unroll(const Front& front, std::size_t v) {
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

void AdvancingFront::unroll_backwards(const Front& front, std::size_t v) {
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

}  // namespace tripatch
