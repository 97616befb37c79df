// How work that takes long is ended from outside.
#pragma once

#include <atomic>
#include <exception>
#include <functional>

namespace tripatch {

/// Thrown where work that was asked to end does.
class Interrupted final : public std::exception {
public:
  const char* what() const noexcept override { return "interrupted"; }
};

/// Ends the work that it is given to, from any thread.
class Cancel {
public:
  void request() noexcept { requested_.store(true, std::memory_order_relaxed); }
  bool is_requested() const noexcept { return requested_.load(std::memory_order_relaxed); }

private:
  std::atomic<bool> requested_ = false;
};

/// While it lives, `cancel` ends the work of this thread and what that shares out. Null: nothing does.
class CancelScope {
public:
  explicit CancelScope(const Cancel* cancel);
  ~CancelScope();
  CancelScope(const CancelScope&) = delete;
  CancelScope& operator=(const CancelScope&) = delete;

  /// What ends the work of this thread; null: nothing does.
  static const Cancel* current();

private:
  const Cancel* before_;
};

/// To be called in every loop that may take more than some milliseconds. Throws Interrupted if the work is to end.
void check_interruption();

/// work() by this thread, which calls ask() about twenty times a second while it works. What that throws ends the work, with all of its
/// threads, and is thrown on.
void work_and_ask(const std::function<void()>& work, const std::function<void()>& ask);

}  // namespace tripatch
