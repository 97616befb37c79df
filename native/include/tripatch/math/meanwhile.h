// Work whose result is probably wanted later.
#pragma once

#include <atomic>
#include <chrono>
#include <future>
#include <optional>
#include <thread>
#include <utility>

#include "tripatch/math/interruption.h"
#include "tripatch/math/parallel.h"

namespace tripatch {

/// Whether a core is free for work that goes on beside other work.
inline bool has_free_core() { return !one_of_many && most_threads() > 1; }

/// f() in a thread of its own from now on. It is ended where nobody has asked for its result.
template <class T>
class Meanwhile {
public:
  template <class F>
  explicit Meanwhile(F f)
      : work_(std::async(std::launch::async, [this, f = std::move(f)] {
          const InterruptedBy ended(&end_);
          return f();
        })) {}
  ~Meanwhile() { end_ = true; }  // the future waits for the thread
  Meanwhile(const Meanwhile&) = delete;
  Meanwhile& operator=(const Meanwhile&) = delete;

  /// Once. Throws what f does; an interruption of this thread ends f too.
  T get() {
    constexpr std::chrono::milliseconds between_looks(20);
    while (work_.wait_for(between_looks) == std::future_status::timeout) check_interruption();
    return work_.get();
  }

private:
  std::atomic<bool> end_ = false;
  std::future<T> work_;  // the last: it ends first
};

/// f(k, thread) for each k below a count, time and again, by this thread (0) and where a core is free by another (1), which looks for
/// work all the while: it takes up some in less than a microsecond, where a new thread takes twenty. f must not throw.
template <class F>
class Together {
public:
  explicit Together(F f) : f_(std::move(f)) {
    if (!has_free_core()) return;
    helper_.emplace(most_threads() - 1, [this] {
      for (int looks = 0; !end_.load(std::memory_order_relaxed); ++looks) {
        if (take_what_is_left(1)) looks = 0;
        if (looks > most_looks) std::this_thread::yield();
      }
    });
  }
  ~Together() { end_ = true; }  // the thread is waited for
  Together(const Together&) = delete;
  Together& operator=(const Together&) = delete;

  void operator()(int count) {
    done_.store(0, std::memory_order_relaxed);
    left_.store(count, std::memory_order_release);
    take_what_is_left(0);
    for (int looks = 0; done_.load(std::memory_order_acquire) < count; ++looks)
      if (looks > most_looks) std::this_thread::yield();
  }

private:
  static constexpr int most_looks = 20'000;  ///< some 20 us, before others are let go on who may have the core

  bool take_what_is_left(int thread) {
    bool any = false;
    for (int left = left_.load(std::memory_order_relaxed); left > 0;) {
      if (!left_.compare_exchange_weak(left, left - 1, std::memory_order_acquire, std::memory_order_relaxed)) continue;
      f_(left - 1, thread);
      any = true;
      done_.fetch_add(1, std::memory_order_release);
      left = left_.load(std::memory_order_relaxed);
    }
    return any;
  }

  F f_;
  std::atomic<int> left_ = 0, done_ = 0;
  std::atomic<bool> end_ = false;
  std::optional<InOtherThread> helper_;  // the last: it ends first
};

}  // namespace tripatch
