// Work whose result is probably wanted later.
#pragma once

#include <atomic>
#include <chrono>
#include <future>
#include <thread>
#include <utility>

#include "tripatch/math/interruption.h"
#include "tripatch/math/parallel.h"

namespace tripatch {

/// Whether a core is free for work that goes on beside other work.
inline bool has_free_core() { return !one_of_many && std::thread::hardware_concurrency() > 1; }

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

}  // namespace tripatch
