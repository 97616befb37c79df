#include "tripatch/math/interruption.h"

#include <chrono>
#include <utility>

#include "tripatch/math/thresholds.h"

namespace tripatch {

namespace {

using Clock = std::chrono::steady_clock;

/// Often enough for a bar, and for Ctrl-C to be obeyed within 100 ms.
constexpr std::chrono::milliseconds between_calls{50};
constexpr std::chrono::milliseconds passes_are_rare{1};
constexpr int passes_a_look = count::places;  // while they are not

/// What a thread asks now and then while it works.
class Asking {
public:
  explicit Asking(const std::function<void()>& ask) : ask_(ask) {}

  const Cancel& cancel() const { return cancel_; }
  /// At a place that is passed some thousand times a millisecond, or once in some: the clock is not looked at each time.
  void pass() {
    if (--passes_left_ <= 0) look();
  }
  /// Throws on what has been thrown, if anything.
  void rethrow() const {
    if (thrown_) std::rethrow_exception(thrown_);
  }

private:
  void look() {
    const Clock::time_point now = Clock::now();
    passes_left_ = now - last_ < passes_are_rare ? passes_a_look : 1;
    last_ = now;
    if (now < due_) return;
    try {
      ask_();
    } catch (...) {
      thrown_ = std::current_exception();
      cancel_.request();
      throw Interrupted();
    }
    due_ = Clock::now() + between_calls;
  }

  const std::function<void()>& ask_;
  Cancel cancel_;
  std::exception_ptr thrown_;
  int passes_left_ = 1;
  Clock::time_point last_ = Clock::now(), due_ = last_ + between_calls;
};

thread_local const Cancel* this_cancel = nullptr;
thread_local Asking* this_asking = nullptr;  // the threads that this one shares its work out to never ask

/// While it lives, this thread asks.
class AskingScope {
public:
  explicit AskingScope(Asking* asking) : before_(std::exchange(this_asking, asking)) {}
  ~AskingScope() { this_asking = before_; }
  AskingScope(const AskingScope&) = delete;
  AskingScope& operator=(const AskingScope&) = delete;

private:
  Asking* before_;
};

}  // namespace

CancelScope::CancelScope(const Cancel* cancel) : before_(std::exchange(this_cancel, cancel)) {}
CancelScope::~CancelScope() { this_cancel = before_; }
const Cancel* CancelScope::current() { return this_cancel; }

void check_interruption() {
  if (this_cancel && this_cancel->is_requested()) throw Interrupted();
  if (this_asking) this_asking->pass();
}

void work_and_ask(const std::function<void()>& work, const std::function<void()>& ask) {
  Asking own(ask);
  const CancelScope cancel(&own.cancel());
  const AskingScope asking(&own);
  try {
    work();
  } catch (...) {
    own.rethrow();
    throw;
  }
}

}  // namespace tripatch
