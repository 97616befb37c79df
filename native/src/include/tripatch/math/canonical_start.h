// Where a closed walk is begun, and which way it goes, by its geometry: what is done from there on, place by place, does not hang on how
// the walk is given, nor on whether it is seen in a mirror.
#pragma once

#include <optional>
#include <vector>

#include "tripatch/types.h"

namespace tripatch {

struct CanonicalStart {
  Index place = 0;
  bool backwards = false;
  /// The k-th place, from 0 to n, of a walk of n that begins so.
  Index at(Index k, Index n) const { return (place + (backwards ? n - k : k)) % n; }
};

/// Length of a closed polygon, its vertices by row.
template <class M>
double length_around(const M& loop) {
  double sum = 0;
  for (Index k = 0; k < loop.rows(); ++k) sum += (loop.row(k) - loop.row((k + 1) % loop.rows())).norm();
  return sum;
}

/// Ways to walk a closed polygon, of which comparisons leave the best: those that are alike, but for rounding.
class CanonicalStarts {
public:
  /// backwards: the only direction, where there is no choice. places: where it may be begun; none: anywhere.
  explicit CanonicalStarts(Points loop, std::optional<bool> backwards = {}, const std::vector<Index>& places = {});

  bool decided() const { return left_.size() == 1; }
  const std::vector<CanonicalStart>& left() const { return left_; }
  /// By the distances of the polygon's vertices from those a few places on.
  void compare_along();
  /// By how near points lie to its edges; points that are not finite do not count.
  void compare_with(const Points& points);

private:
  Index size() const { return loop_.rows(); }
  Vec3 at(Index k) const { return loop_.row(((k % size()) + size()) % size()); }
  template <class OfEdge>
  void choose(const OfEdge& of_edge);

  Points loop_;
  double length_ = 0;
  std::vector<CanonicalStart> left_;
};

}  // namespace tripatch
