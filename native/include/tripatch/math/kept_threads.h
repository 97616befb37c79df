// Threads that are kept from one piece of work to the next.
#pragma once

#include <pthread.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
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

/// A moment, a tenth of a microsecond, in which a core that works for two threads is the other's.
inline void rest() {
  for (int k = 0; k < 4; ++k) {
#if defined(__x86_64__)
    __builtin_ia32_pause();
#elif defined(__aarch64__)
    asm volatile("yield");
#endif
  }
}

/// Looks whether `known()` for some 400 us, and lets others go on now and then who may have the core; gives what it knows.
template <class Known>
bool looked_for(const Known& known) {
  constexpr int yields = 20, looks = 200;
  for (int k = 0; k < yields; ++k, std::this_thread::yield())
    for (int j = 0; j < looks; ++j, rest())
      if (known()) return true;
  return known();
}

/// A thread that does one piece of work after another, all given by one other thread. Each looks for the other a while before it sleeps: so
/// work is taken up, and its end seen, within a microsecond, where to be woken takes 20, and a new thread 40.
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
    work_ = std::move(work);
    {
      const std::lock_guard lock(mutex_);
      at_work_ = true;
    }
    given_.notify_one();
  }
  bool is_done_within(std::chrono::milliseconds time) const {
    return looked_for([this] { return !at_work_; }) || result_.wait_for(time) == std::future_status::ready;
  }
  /// Waits until the work is done; the result throws what that has thrown.
  std::future<void> done() {
    if (!looked_for([this] { return !at_work_; })) {
      std::unique_lock lock(mutex_);
      done_.wait(lock, [this] { return !at_work_; });
    }
    free_ = true;
    return std::move(result_);
  }

private:
  void do_what_is_given() {
    for (bool looks = false;; looks = true) {
      if (!looks || !looked_for([this] { return at_work_ || ended_; })) {
        std::unique_lock lock(mutex_);
        given_.wait(lock, [this] { return at_work_ || ended_; });
      }
      if (!at_work_) return;
      work_();
      work_ = {};
      {
        const std::lock_guard lock(mutex_);
        at_work_ = false;
      }
      done_.notify_one();
    }
  }

  bool free_ = true;  // known to the giver alone, as the result is
  std::future<void> result_;
  std::packaged_task<void()> work_;  // the giver's, or while at work the thread's own
  std::mutex mutex_;                 // of changes of what follows
  std::condition_variable given_, done_;
  std::atomic<bool> at_work_ = false, ended_ = false;
  std::thread thread_;  // the last: it reads the others
};

/// Those that one thread keeps.
class ThreadsOfOne {
public:
  ~ThreadsOfOne() { leave_those_of_others(); }
  KeptThread* find(std::size_t most) {
    leave_those_of_others();
    for (const auto& thread : threads_)
      if (thread->is_free()) return thread.get();
    return threads_.size() < most ? threads_.emplace_back(std::make_unique<KeptThread>()).get() : nullptr;
  }
  std::size_t at_work() {
    leave_those_of_others();
    return std::ranges::count_if(threads_, [](const auto& thread) { return !thread->is_free(); });
  }

private:
  /// After a fork those of the process that was forked are here too, but do not run.
  void leave_those_of_others() {
    if (const pid_t here = getpid(); std::exchange(process_, here) != here)
      for (auto& thread : std::exchange(threads_, {})) {
        [[maybe_unused]] const KeptThread* const left = thread.release();
      }
  }

  pid_t process_ = getpid();
  std::vector<std::unique_ptr<KeptThread>> threads_;
};

/// While one lives, what its thread shares out goes to threads that are kept, as many as that takes, until that thread ends: where a system
/// has begun a thread on the core of the one that asks for it, it takes some milliseconds until it moves it to one that is free.
class KeptThreads {
public:
  KeptThreads() : before_(std::exchange(asked_for, true)) {}
  ~KeptThreads() { asked_for = before_; }
  KeptThreads(const KeptThreads&) = delete;
  KeptThreads& operator=(const KeptThreads&) = delete;

  /// One that is free, of the thread that asks; null where it keeps none, or where `most` are at work.
  static KeptThread* free_one(std::size_t most) { return asked_for ? of_this_thread().find(most) : nullptr; }
  /// Of `most` threads, those that are not at work for the thread that asks.
  static std::size_t free(std::size_t most) { return asked_for ? most - std::min(most, of_this_thread().at_work()) : most; }

private:
  /// Ended with the thread; with the process those of its first one are left, which sleep. By the system's own means: objects of threads whose
  /// ends do something ask for a newer C library.
  static ThreadsOfOne& of_this_thread() {
    static const pthread_key_t key = [] {
      pthread_key_t made{};
      pthread_key_create(&made, [](void* threads) { delete static_cast<ThreadsOfOne*>(threads); });
      return made;
    }();
    static thread_local ThreadsOfOne* threads = nullptr;
    if (!threads) pthread_setspecific(key, threads = new ThreadsOfOne);
    return *threads;
  }

  static inline thread_local bool asked_for = false;
  bool before_;
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
