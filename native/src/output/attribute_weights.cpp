#include "tripatch/output/attribute_weights.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "tripatch/math/parallel.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/messages.h"

namespace tripatch {
namespace {

/// Points that make a thread worth its start of some 0.1 ms: a point over a triangle takes about 0.1 us.
constexpr Index points_a_thread = count::portion;

}  // namespace

AttributeWeights::AttributeWeights(const Values& rim, const Values& inside, const std::vector<Index>& loops)
    : plane_(rim.cols() == 2), rim_(rim.rows()), points_(inside.rows()), rim_parameters_(rim), parameters_(inside) {
  const auto of_shape = [](Index rows, Index columns) {
    return "(" + std::to_string(rows) + ", " + std::to_string(columns) + ")";
  };
  if (rim_ < 3) throw CodedArgument(Code::out_of_range, {{"name", "len(rim)"}, {"least", 3}, {"value", rim_}});
  if ((rim.cols() != 2 && rim.cols() != 3) || rim.cols() != inside.cols())
    throw CodedArgument(
        Code::wrong_shape,
        {{"name", "inside"}, {"shape", of_shape(points_, rim.cols())}, {"given", of_shape(points_, inside.cols())}});
  if (plane_) {
    std::vector<Index> counts = loops.empty() ? std::vector<Index>{rim_} : loops;
    if (std::accumulate(counts.begin(), counts.end(), Index{0}) != rim_ || *std::ranges::min_element(counts) < 3)
      throw CodedArgument(Code::loops_miscounted, {{"count", rim_}});
    before_.resize(rim_);
    for (const Index count : counts) {
      const Index first = static_cast<Index>(next_.size());
      for (Index k = 0; k < count; ++k) next_.push_back(first + (k + 1) % count);
    }
    for (Index v = 0; v < rim_; ++v) before_[next_[v]] = v;
    return;
  }
  if (!loops.empty())
    throw CodedArgument(Code::wrong_shape, {{"name", "rim"}, {"shape", of_shape(rim_, 2)}, {"given", of_shape(rim_, 3)}});
  for (int i = 0; i < 3; ++i) rim_parameters_.col(i).maxCoeff(&corner_[i]);
  for (int i = 0; i < 3; ++i) {
    const Index first = corner_[(i + 1) % 3], last = corner_[(i + 2) % 3] == 0 ? rim_ : corner_[(i + 2) % 3];
    if (first >= last) throw CodedArgument(Code::rim_not_from_corner, {});
    for (Index v = first; v <= last; ++v) along_[i].push_back(rim_parameters_(v % rim_, (i + 2) % 3));
  }
}

void AttributeWeights::row(Index k, Index* ends, double* weights) const {
  if (plane_)
    plane_row(k, ends, weights);
  else
    triangle_row(k, ends, weights);
}

void AttributeWeights::triangle_row(Index k, Index* ends, double* weights) const {
  const double* b = parameters_.row(k).data();
  std::array<double, 3> share;
  for (int i = 0; i < 3; ++i) share[i] = std::pow(b[(i + 1) % 3] * b[(i + 2) % 3], 2);
  const double sum = share[0] + share[1] + share[2];
  for (int i = 0; i < 3; ++i) {
    const int one = (i + 1) % 3, two = (i + 2) % 3;
    const double opposite = b[one] + b[two];
    // At a corner nothing tells the segments apart: the corner has all.
    const double part = sum > 0 ? share[i] / sum : double(b[i] > 0.5);
    const double t = opposite > 0 ? b[two] / opposite : 0.5;
    const std::vector<double>& along = along_[i];
    const Index place = std::upper_bound(along.begin(), along.end(), t) - along.begin() - 1;
    const Index edge = std::clamp<Index>(place, 0, static_cast<Index>(along.size()) - 2);
    const double u = (t - along[edge]) / (along[edge + 1] - along[edge]);
    const double on_side = part * (1 - b[i]), at_corner = part * b[i] / 2;
    const Index from = 2 * (corner_[one] + edge), corner = 2 * corner_[i];
    const std::array<Index, 4> to = {from, from + 1, corner, (corner + 2 * rim_ - 1) % (2 * rim_)};
    const std::array<double, 4> by = {on_side * (1 - u), on_side * u, at_corner, at_corner};
    std::copy(to.begin(), to.end(), ends + 4 * i);
    std::copy(by.begin(), by.end(), weights + 4 * i);
  }
}

void AttributeWeights::plane_row(Index k, Index* ends, double* weights) const {
  std::iota(ends, ends + 2 * rim_, Index{0});
  std::fill_n(weights, 2 * rim_, 0.0);
  const auto away = [&](Index v) -> Eigen::Vector2d { return (rim_parameters_.row(v) - parameters_.row(k)).transpose(); };
  double sum = 0;
  for (Index e = 0; e < rim_; ++e) {
    const Eigen::Vector2d here = away(e), next = away(next_[e]);
    const double r = here.norm(), s = next.norm(), across = here.x() * next.y() - here.y() * next.x();
    if (r == 0) {  // at a vertex: half of it from either edge
      std::fill_n(weights, 2 * rim_, 0.0);
      weights[2 * e] = weights[2 * before_[e] + 1] = 0.5;
      return;
    }
    const double below = r * s + here.dot(next);
    if (s > 0 && below <= tolerance::fit * r * s) {
      std::fill_n(weights, 2 * rim_, 0.0);
      weights[2 * e] = s / (r + s);
      weights[2 * e + 1] = r / (r + s);
      return;
    }
    if (s > 0) {
      const double half_tangent = across / below;
      weights[2 * e] = half_tangent / r;
      weights[2 * e + 1] = half_tangent / s;
      sum += weights[2 * e] + weights[2 * e + 1];
    }
  }
  for (Index e = 0; e < 2 * rim_; ++e) weights[e] /= sum;
}

std::vector<Index> AttributeWeights::nearest() const {
  std::vector<Index> best(points_);
  parallel_for(0, points_, points_a_thread, [&](Index from, Index to) {
    std::vector<Index> ends(terms());
    std::vector<double> weights(terms());
    for (Index k = from; k < to; ++k) {
      row(k, ends.data(), weights.data());
      best[k] = ends[std::max_element(weights.begin(), weights.end()) - weights.begin()];
    }
  });
  return best;
}

Values AttributeWeights::blend(const Eigen::Ref<const Values>& at_ends) const {
  if (at_ends.rows() != ends())
    throw CodedArgument(Code::wrong_shape, {{"name", "values"},
                                            {"shape", "(" + std::to_string(ends()) + ", d)"},
                                            {"given", "(" + std::to_string(at_ends.rows()) + ", d)"}});
  Values out = Values::Zero(points_, at_ends.cols());
  parallel_for(0, points_, points_a_thread, [&](Index from, Index to) {
    std::vector<Index> ends(terms());
    std::vector<double> weights(terms());
    for (Index k = from; k < to; ++k) {
      row(k, ends.data(), weights.data());
      for (Index e = 0; e < terms(); ++e) out.row(k) += weights[e] * at_ends.row(ends[e]);
    }
  });
  return out;
}

}  // namespace tripatch
