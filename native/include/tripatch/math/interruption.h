// How work that takes long is ended from outside.
#pragma once

#include <atomic>
#include <chrono>
#include <exception>
#include <utility>

namespace tripatch {

/// Thrown where work that was asked to end does.
class Interrupted final : public std::exception {
public:
  const char* what() const noexcept override { return "interrupted"; }
};

/// What this thread's work looks at: true ends it; null: nothing does.
inline thread_local const std::atomic<bool>* interruption = nullptr;

/// What a thread asks now and then while it works.
class Asking {
public:
  Asking() = default;
  virtual ~Asking() = default;
  Asking(const Asking&) = delete;
  Asking& operator=(const Asking&) = delete;

  /// At a place that is passed some thousand times a millisecond, or once in some: the clock is not looked at each time.
  void pass() {
    if (--passes_left_ <= 0) look();
  }
  const std::atomic<bool>& ended() const { return ended_; }
  /// Throws on what has been thrown, if anything.
  void rethrow() const {
    if (thrown_) std::rethrow_exception(thrown_);
  }

private:
  virtual void ask() = 0;  ///< throws what shall end the work

  using Clock = std::chrono::steady_clock;
  /// Often enough for a bar, and for Ctrl-C to be obeyed within 100 ms.
  static constexpr std::chrono::milliseconds between_calls{50};
  static constexpr std::chrono::milliseconds passes_are_rare{1};
  static constexpr int passes_a_look = 16;  // while they are not

  void look() {
    const Clock::time_point now = Clock::now();
    passes_left_ = now - last_ < passes_are_rare ? passes_a_look : 1;
    last_ = now;
    if (now < due_) return;
    try {
      ask();
    } catch (...) {
      thrown_ = std::current_exception();
      ended_ = true;
      throw Interrupted();
    }
    due_ = Clock::now() + between_calls;
  }

  std::atomic<bool> ended_ = false;
  std::exception_ptr thrown_;
  int passes_left_ = 1;
  Clock::time_point last_ = Clock::now(), due_ = last_ + between_calls;
};

/// Of this thread; null: it asks nothing. The threads that it makes never do.
inline thread_local Asking* asking = nullptr;

/// To be called in every loop that may take more than some milliseconds.
inline void check_interruption() {
  if (interruption && interruption->load(std::memory_order_relaxed)) throw Interrupted();
  if (asking) asking->pass();
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

/// work() by this thread, which calls ask() about twenty times a second while it works. What that throws ends the work, with all of its
/// threads, and is thrown on.
template <class Work, class Ask>
void work_and_ask(const Work& work, const Ask& ask) {
  class Own final : public Asking {
  public:
    explicit Own(const Ask& f) : f_(f) {}

  private:
    void ask() override { f_(); }
    const Ask& f_;
  };
  Own own(ask);
  const InterruptedBy ended(&own.ended());
  Asking* const before = std::exchange(asking, &own);
  try {
    work();
  } catch (...) {
    asking = before;
    own.rethrow();
    throw;
  }
  asking = before;
}

}  // namespace tripatch
