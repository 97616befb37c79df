// How work that takes long is ended from outside.
#pragma once

#include <atomic>
#include <exception>

namespace tripatch {

/// Thrown where work that was asked to end does.
class Interrupted final : public std::exception {
public:
  const char* what() const noexcept override { return "interrupted"; }
};

/// What this thread's work looks at: true ends it; null: nothing does.
inline thread_local const std::atomic<bool>* interruption = nullptr;

/// To be called in every loop that may take more than some milliseconds.
inline void check_interruption() {
  if (interruption && interruption->load(std::memory_order_relaxed)) throw Interrupted();
}

/// While it lives, work of this thread ends when `flag` becomes true. parallel_for hands the flag on to its threads.
class InterruptedBy {
public:
  explicit InterruptedBy(const std::atomic<bool>* flag) : before_(interruption) { interruption = flag; }
  ~InterruptedBy() { interruption = before_; }
  InterruptedBy(const InterruptedBy&) = delete;
  InterruptedBy& operator=(const InterruptedBy&) = delete;

private:
  const std::atomic<bool>* before_;
};

}  // namespace tripatch
