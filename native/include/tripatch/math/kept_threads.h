// Threads that are kept from one piece of work to the next.
#pragma once

#include <chrono>
#include <condition_variable>
#include <future>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "tripatch/math/interruption.h"

namespace tripatch {

/// A thread that does one piece of work after another, all given by one other thread. That costs 5 us, and 20 until both go on, where a new
/// thread costs 15, and 40.
class KeptThread {
public:
  KeptThread() : thread_([this] { do_what_is_given(); }) {}
  ~KeptThread() {
    {
      const std::lock_guard lock(mutex_);
      ended_ = true;
    }
    given_.notify_one();
    thread_.join();
  }
  KeptThread(const KeptThread&) = delete;
  KeptThread& operator=(const KeptThread&) = delete;

  /// Nothing is given that has not been waited for.
  bool is_free() const { return free_; }
  void begin(std::packaged_task<void()> work) {
    free_ = false;
    result_ = work.get_future();
    {
      const std::lock_guard lock(mutex_);
      work_ = std::move(work);
    }
    given_.notify_one();
  }
  bool is_done_within(std::chrono::milliseconds time) const { return result_.wait_for(time) == std::future_status::ready; }
  /// Waits until the work is done; the result throws what that has thrown.
  std::future<void> done() {
    std::unique_lock lock(mutex_);
    done_.wait(lock, [this] { return !work_.valid(); });
    free_ = true;
    return std::move(result_);
  }

private:
  void do_what_is_given() {
    std::unique_lock lock(mutex_);
    for (;;) {
      given_.wait(lock, [this] { return work_.valid() || ended_; });
      if (!work_.valid()) return;
      lock.unlock();
      work_();
      lock.lock();
      work_ = {};
      done_.notify_one();
    }
  }

  bool free_ = true;  // known to the giver alone, as the result is
  std::future<void> result_;
  std::mutex mutex_;  // of what follows
  std::condition_variable given_, done_;
  std::packaged_task<void()> work_;  // none: it is done
  bool ended_ = false;
  std::thread thread_;  // the last: it reads the others
};

/// While it lives, what its thread shares out goes to threads that are kept: as many as that takes.
class KeptThreads {
public:
  KeptThreads() : before_(std::exchange(of_this_thread, this)) {}
  ~KeptThreads() { of_this_thread = before_; }
  KeptThreads(const KeptThreads&) = delete;
  KeptThreads& operator=(const KeptThreads&) = delete;

  /// One that is free, of the thread that asks; null where it keeps none, or where `most` are at work.
  static KeptThread* free_one(std::size_t most) { return of_this_thread ? of_this_thread->find(most) : nullptr; }

private:
  KeptThread* find(std::size_t most) {
    for (const auto& thread : threads_)
      if (thread->is_free()) return thread.get();
    return threads_.size() < most ? threads_.emplace_back(std::make_unique<KeptThread>()).get() : nullptr;
  }

  static inline thread_local KeptThreads* of_this_thread = nullptr;
  KeptThreads* before_;
  std::vector<std::unique_ptr<KeptThread>> threads_;
};

/// f() in another thread from now on, one that is kept where there is one; waited for at the latest at its end.
class InOtherThread {
public:
  template <class F>
  InOtherThread(std::size_t most_kept, F f) : kept_(KeptThreads::free_one(most_kept)) {
    if (kept_)
      kept_->begin(std::packaged_task<void()>(std::move(f)));
    else
      new_ = std::async(std::launch::async, std::move(f));
  }
  InOtherThread(InOtherThread&& other) noexcept : kept_(std::exchange(other.kept_, nullptr)), new_(std::move(other.new_)) {}
  ~InOtherThread() {
    if (kept_) kept_->done();
  }
  InOtherThread(const InOtherThread&) = delete;
  InOtherThread& operator=(const InOtherThread&) = delete;

  /// Once; throws what f does, or an interruption.
  void wait() {
    constexpr std::chrono::milliseconds between_looks(20);
    const auto is_done = [&] {
      return kept_ ? kept_->is_done_within(between_looks) : new_.wait_for(between_looks) == std::future_status::ready;
    };
    while (!is_done()) check_interruption();
    return kept_ ? std::exchange(kept_, nullptr)->done().get() : new_.get();
  }

private:
  KeptThread* kept_;
  std::future<void> new_;
};

}  // namespace tripatch
