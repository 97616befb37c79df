#include "tripatch/math/canonical_start.h"

#include <algorithm>
#include <array>

#include "tripatch/math/thresholds.h"
#include "tripatch/math/tolerant_compare.h"

namespace tripatch {
namespace {

/// Edges are compared with points at this share of their length: not in the middle, so that the two directions differ.
constexpr double off_middle = share::three_tenths;
/// How vertices a few places on count: unlike each other, so that no two arrangements of lengths come to the same sum but by chance.
constexpr std::array<double, 3> places_on = {1, 0.37, 0.21};

/// The sum of what each edge of a closed walk has, those later on counting less, for every beginning of it.
Eigen::VectorXd sums_from(const Eigen::VectorXd& each) {
  const Index n = each.size();
  const double less = 1 - 1 / static_cast<double>(n + 1);
  double sum = 0, power = 1;
  for (Index k = n; k-- > 0;) sum = each[k] + less * sum;
  for (Index k = 0; k < n; ++k) power *= less;
  Eigen::VectorXd sums(n);
  for (Index k = n; k-- > 0;) sums[k] = sum = each[k] * (1 - power) + less * sum;
  return sums;
}

}  // namespace

CanonicalStarts::CanonicalStarts(Points loop, std::optional<bool> backwards, const std::vector<Index>& places)
    : loop_(std::move(loop)) {
  for (const bool way : {false, true}) {
    if (backwards.value_or(way) != way) continue;
    for (Index k = 0; k < size() && places.empty(); ++k) left_.push_back({k, way});
    for (Index k : places) left_.push_back({k, way});
  }
  length_ = length_around(loop_);
}

/// Leaves those of the largest sum.
template <class OfEdge>
void CanonicalStarts::choose(const OfEdge& of_edge) {
  const Index n = size();
  std::array<Eigen::VectorXd, 2> sums;
  for (const CanonicalStart& b : left_) {
    Eigen::VectorXd& own = sums[b.backwards];
    if (own.size() > 0) continue;
    own.resize(n);
    for (Index j = 0; j < n; ++j) own[j] = b.backwards ? of_edge(n - j, -1) : of_edge(j, 1);
    own = sums_from(own);
  }
  const auto value = [&](const CanonicalStart& b) { return sums[b.backwards][b.backwards ? (n - b.place) % n : b.place]; };
  double most = 0;
  for (const CanonicalStart& b : left_) most = std::max(most, value(b));
  std::erase_if(left_, [&](const CanonicalStart& b) { return clearly_less(value(b), most); });
}

void CanonicalStarts::compare_along() {
  choose([&](Index k, Index step) {
    double sum = 0;
    for (std::size_t j = 0; j < places_on.size(); ++j)
      sum += places_on[j] * (at(k + (static_cast<Index>(j) + 1) * step) - at(k)).norm();
    return sum;
  });
}

void CanonicalStarts::compare_with(const Points& points) {
  Eigen::Array<double, Eigen::Dynamic, 3> finite(points.rows(), 3);
  Index count = 0;
  for (Index k = 0; k < points.rows(); ++k)
    if (points.row(k).allFinite()) finite.row(count++) = points.row(k).array();
  finite.conservativeResize(count, 3);
  const double edge = length_ / static_cast<double>(size()), square = std::max(edge * edge, tolerance::tiny);
  choose([&](Index k, Index step) {
    const Vec3 p = (1 - off_middle) * at(k) + off_middle * at(k + step);
    return (square /
            (square + (finite.col(0) - p[0]).square() + (finite.col(1) - p[1]).square() + (finite.col(2) - p[2]).square()))
        .sum();
  });
}

}  // namespace tripatch
