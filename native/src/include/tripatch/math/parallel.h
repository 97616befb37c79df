// Work on several threads: those of one pool for the whole process.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <functional>
#include <optional>
#include <utility>

#include "tripatch/math/interruption.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/types.h"

namespace tripatch {

/// Whether this thread shares out what it does: not if it is itself one of several at work, nor where there is one thread only.
bool may_share();

/// While it lives, this thread shares nothing out.
class SerialScope {
public:
  explicit SerialScope(bool serial = true);
  ~SerialScope();
  SerialScope(const SerialScope&) = delete;
  SerialScope& operator=(const SerialScope&) = delete;

private:
  bool before_;
};

/// Pieces of work for threads of the pool and for whoever waits for them. They are begun in order.
class Job {
public:
  using Piece = std::function<void(Index)>;
  struct Options {
    Index max_helpers;                              ///< threads of the pool that work at the same time
    bool serial;                                    ///< whether these share nothing out
    const Cancel* cancel = CancelScope::current();  ///< ends what they do
  };

  /// piece(k) for each k < count from now on.
  Job(Index count, Piece piece, const Options& options);
  /// What is not begun is not done; what is, is waited for.
  ~Job();
  Job(const Job&) = delete;
  Job& operator=(const Job&) = delete;

  /// Does what is left, by this thread too if it `works`, and waits for the others; while it does, it calls waiting(), which ends the work if it
  /// throws. Throws on what a piece has thrown, of several the first that was not interrupted.
  void finish(bool works = true, const std::function<void()>& waiting = check_interruption);

private:
  friend class ThreadPool;
  void work();
  void fail(Index piece, bool interrupted);

  const Piece piece_;
  const Index count_;
  const Options options_;
  std::atomic<Index> next_ = 0, helpers_ = 0;
  // what follows is guarded by the pool
  std::exception_ptr failure_;
  std::pair<bool, Index> failed_at_;  // whether it was interrupted, and which piece
};

/// How many threads may work on what this thread shares out now, itself among them.
Index free_threads();

/// f(from, to) on pieces of [from, to) with at least `least` in each, at the same time. Other threads than the caller's share nothing out of
/// what they do.
template <class F>
void parallel_for(Index from, Index to, Index least, const F& f) {
  const Index n = to - from, shares = n < 2 * least ? 1 : std::min(n / least, free_threads());
  check_interruption();
  if (shares > 1) {
    const auto share = [&](Index k) { f(from + n * k / shares, from + n * (k + 1) / shares); };
    Job(shares, std::cref(share), {.max_helpers = shares - 1, .serial = true}).finish();
  } else if (n > 0) {
    f(from, to);
  }
}

/// f() and g(), at the same time where a core is free and they are worth one.
template <class F, class G>
void both_at_once(const F& f, const G& g, bool worth_one = true) {
  parallel_for(0, 2, worth_one ? 1 : 2, [&](Index from, Index to) {
    if (from == 0) f();
    if (to == 2) g();
  });
}

/// f(k) for each k < count, which take long each, at the same time where cores are free and they are worth them.
template <class F>
void each_at_once(Index count, const F& f, bool worth_it) {
  parallel_for(0, count, worth_it ? 1 : count, [&](Index from, Index to) {
    for (Index k = from; k < to; ++k) f(k);
  });
}

/// Whether f(k) is true for each k < count, on all cores where they are many; each takes some 10 ns.
template <class F>
bool holds_for_all(Index count, const F& f) {
  constexpr Index share = count::portion;  // several times what it costs to share
  std::atomic<bool> all = true;
  parallel_for(0, count, share, [&](Index from, Index to) {
    for (Index next = from; next < to && all;) {
      check_interruption();
      const Index end = std::min(next + 256, to);
      while (next < end && f(next)) ++next;
      if (next < end) all = false;
    }
  });
  return all;
}

/// f(k) for each k < count, on all cores, each core the next one as soon as it is free. progress(done) is called by the caller's own
/// thread, twenty times a second and after the last. What either throws ends the work, also in the middle of an f that looks at
/// check_interruption, and is thrown on, the first of them.
void parallel_for_each(std::size_t count, const std::function<void(std::size_t)>& f,
                       const std::function<void(std::size_t)>& progress);

/// f() by another thread from now on, whose result is probably wanted later. It is ended where nobody has asked for that.
template <class T>
class AsyncTask {
public:
  template <class F>
  explicit AsyncTask(F f)
      : job_(1, [this, f = std::move(f)](Index) { result_ = f(); }, {.max_helpers = 1, .serial = false, .cancel = &cancel_}) {}
  ~AsyncTask() { cancel_.request(); }  // the job waits for the thread
  AsyncTask(const AsyncTask&) = delete;
  AsyncTask& operator=(const AsyncTask&) = delete;

  /// Once. Throws what f does; an interruption of this thread ends f too.
  T get() {
    job_.finish(true, [this] {
      try {
        check_interruption();
      } catch (const Interrupted&) {
        cancel_.request();
        throw;
      }
    });
    return std::move(*result_);
  }

private:
  Cancel cancel_;
  std::optional<T> result_;
  Job job_;  // the last: it ends first
};

}  // namespace tripatch
