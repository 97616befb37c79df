// Quads that grow in from a loop one after the other, as a grid would have them.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "tripatch/types.h"

namespace tripatch {

/// A vertex of a front, and how many quads it still wants on the side to be filled.
struct FrontVertex {
  Index vertex = 0;
  int wanted = 0;
};
/// A loop still to be filled, counterclockwise.
using Front = std::vector<FrontVertex>;

/// On the lattice that a front is unrolled on, each of its edges one step long.
struct LatticeStep {
  int x = 0, y = 0;
  bool operator==(const LatticeStep&) const = default;
};

/// A pole that is planned: the vertex that grows as number `at`, and its valence.
struct GrownPole {
  Index at = 0;
  int valence = 4;
};

/// What is tried: the quads at each vertex of the rim, the poles that are planned, by rising number, and how a front without corners gets four:
/// on a ring of quads or not, the first so many vertices on.
struct GrowthPlan {
  std::vector<int> wanted;
  std::vector<GrownPole> poles;
  bool ringed = false;
  std::size_t turn = 0;
};

/// Tries to fill a rim, one after the other.
class AdvancingFront {
public:
  explicit AdvancingFront(Index most) : most_(most) {}

  bool run(const GrowthPlan& plan);

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
    LatticeStep at;
    int in = 0, out = 0;
  };

  bool fill(Front& front);

  /// A front that has no corner, only vertices that it runs straight on at, gets four, on the rim or on a ring of quads within.
  bool make_round(Front& front);

  /// A quad at the v-th vertex of a front, which wants no other.
  bool close(Front& front, std::size_t v);

  /// The quad at v whose fourth vertex is the k-th on, which parts the front in two. False where they do not lie on one sheet: the part
  /// along which they were found to meet, forwards or backwards, has no pole inside.
  bool part(Front& front, std::size_t v, std::size_t k, const Place& there, bool forwards);

  /// From the v-th vertex on, at the origin with the edge from it to the right; the last is that vertex again.
  void unroll(const Front& front, std::size_t v);
  void unroll_backwards(const Front& front, std::size_t v);

  /// Of the vertices inside: the sum of 4 less their valence.
  static int charge_of(const Front& front) {
    int turns = 0;
    for (const FrontVertex& spot : front) turns += 2 - spot.wanted;
    return 4 - turns;
  }
  /// About which point of the lattice a front turns that ends at a step off its beginning, a right angle too little or too far.
  static std::optional<LatticeStep> center(LatticeStep end, int charge) {
    const LatticeStep twice = charge > 0 ? LatticeStep{end.x + end.y, end.y - end.x} : LatticeStep{end.x - end.y, end.x + end.y};
    if (twice.x % 2 != 0 || twice.y % 2 != 0) return {};
    return LatticeStep{twice.x / 2, twice.y / 2};
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

}  // namespace tripatch
