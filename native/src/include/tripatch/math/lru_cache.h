// The last few results of what takes long and is asked for again and again, as while somebody moves a slider.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "tripatch/math/piecewise_polynomial.h"
#include "tripatch/types.h"

namespace tripatch {

/// All that a result depends on, bit for bit: equal keys have the same results.
class Key {
public:
  void add(double value) { bits_.push_back(std::bit_cast<std::uint64_t>(value)); }
  template <class Derived>
  void add(const Eigen::DenseBase<Derived>& vector) {
    for (Index k = 0; k < vector.size(); ++k) add(static_cast<double>(vector[k]));
  }
  template <class T>
  void add(const std::vector<T>& all) {
    add(static_cast<double>(all.size()));
    for (const auto& each : all) add(each);
  }
  template <class T>
  void add(const std::optional<T>& value) {
    add(value.has_value() ? 1.0 : 0.0);
    if (value) add(*value);
  }
  void add(const PiecewisePolynomial& field) {
    add(static_cast<double>(field.degree()));
    add(field.breaks());
    std::vector<double> coefficients(static_cast<std::size_t>((field.degree() + 1) * field.dimension()));
    for (Index p = 0; p < field.pieces(); ++p) {  // about the middle of a piece they are its own
      field.taylor((field.breaks()[p] + field.breaks()[p + 1]) / 2, field.degree(), coefficients.data());
      add(coefficients);
    }
  }

  bool operator==(const Key& other) const { return bits_ == other.bits_; }

private:
  std::vector<std::uint64_t> bits_;
};

/// Results by key, those last asked for first; from any thread.
template <class Value>
class LruCache {
public:
  /// most: more than one hole asks for while it is shaped; a choice.
  explicit LruCache(std::size_t most = 6) : most_(most) {}

  std::shared_ptr<const Value> find(const Key& key) {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (auto entry = last_.begin(); entry != last_.end(); ++entry) {
      if (!(entry->first == key)) continue;
      std::rotate(last_.begin(), entry, entry + 1);
      return last_.front().second;
    }
    return {};
  }
  std::shared_ptr<const Value> keep(Key key, std::shared_ptr<const Value> value) {
    const std::lock_guard<std::mutex> lock(mutex_);
    last_.emplace_front(std::move(key), value);
    if (last_.size() > most_) last_.pop_back();
    return value;
  }

private:
  std::size_t most_;
  std::mutex mutex_;
  std::deque<std::pair<Key, std::shared_ptr<const Value>>> last_;
};

}  // namespace tripatch
