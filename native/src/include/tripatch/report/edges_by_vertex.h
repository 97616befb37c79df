// The edges of some faces, each with all that comes along it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "tripatch/math/interruption.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/types.h"

namespace tripatch {

/// What comes along an edge, filed under its higher vertex; in 32 bits, as a mesh counts its corners, for edges are most of the memory.
struct EdgeUse {
  std::uint32_t low, what;
};

/// Edges by their higher vertex, what comes along one in its order: each vertex of the fill's own has a place, those of the mesh, whose
/// numbers say nothing of how many there are, share the last. But where they are no more than the corners of the faces they have places,
/// too. First every edge is counted, then every one is added.
class EdgesByVertex {
public:
  EdgesByVertex(Index of_mesh, Index own, Index corners)
      : first_(of_mesh <= corners ? 0 : of_mesh), last_(of_mesh - first_ + own), end_(last_ + 3, 0) {}

  void count(Index a, Index b) { ++end_[place(std::max(a, b)) + 2]; }
  void counted() {
    for (std::size_t k = 1; k < end_.size(); ++k) end_[k] += end_[k - 1];
    uses_ = std::make_unique_for_overwrite<EdgeUse[]>(end_.back());
  }
  void add(Index a, Index b, std::size_t what) {
    const Index low = std::min(a, b), high = std::max(a, b), at = place(high);
    if (at == last_) of_mesh_.push_back({high, end_[at + 1]});
    uses_[end_[at + 1]++] = {static_cast<std::uint32_t>(low), static_cast<std::uint32_t>(what)};
  }

  /// use(higher vertex, all that comes along an edge) for each edge.
  template <class Use>
  void for_edges(const Use& use) {
    for (Index at = 0; at < last_; ++at) {
      if (at % 256 == 0) check_interruption();
      each_of(first_ + at, uses_.get() + end_[at], uses_.get() + end_[at + 1], use);
    }
    std::stable_sort(of_mesh_.begin(), of_mesh_.end(), [](const OfMesh& p, const OfMesh& q) { return p.high < q.high; });
    std::vector<EdgeUse> uses;
    for (std::size_t k = 0; k < of_mesh_.size(); ++k) {
      uses.push_back(uses_[of_mesh_[k].at]);
      if (k + 1 < of_mesh_.size() && of_mesh_[k + 1].high == of_mesh_[k].high) continue;
      each_of(of_mesh_[k].high, uses.data(), uses.data() + uses.size(), use);
      uses.clear();
    }
  }

private:
  struct OfMesh {
    Index high, at;
  };
  static constexpr std::ptrdiff_t many =
      count::dozens;  ///< edges at a vertex, from which on halving is less than putting one after the other

  Index place(Index high) const { return high < first_ ? last_ : high - first_; }

  template <class Use>
  static void each_of(Index high, EdgeUse* from, EdgeUse* to, const Use& use) {
    if (to - from > many)
      std::stable_sort(from, to, [](const EdgeUse& p, const EdgeUse& q) { return p.low < q.low; });
    else
      for (EdgeUse* next = from + 1; next < to; ++next) {
        const EdgeUse moved = *next;
        EdgeUse* at = next;
        for (; at > from && moved.low < at[-1].low; --at) *at = at[-1];
        *at = moved;
      }
    for (EdgeUse* last = from; from < to; from = last) {
      while (last < to && last->low == from->low) ++last;
      use(high, std::span<const EdgeUse>(from, last));
    }
  }

  Index first_, last_;
  std::vector<Index> end_;  // of the place before; while edges are added one place on, which this moves to where it belongs
  std::unique_ptr<EdgeUse[]> uses_;
  std::vector<OfMesh> of_mesh_;  // of the last place
};

}  // namespace tripatch
