// Work on all cores.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <exception>
#include <future>
#include <thread>
#include <vector>

#include "tripatch/math/interruption.h"
#include "tripatch/math/kept_threads.h"
#include "tripatch/types.h"

namespace tripatch {

/// True in threads that are themselves one of several at work: they share nothing out.
inline thread_local bool one_of_many = false;

/// Threads that work at a time: as many as cores, or as the environment's TRIPATCH_THREADS says where several processes share these.
inline unsigned most_threads() {
  static const unsigned most = [] {
    const unsigned cores = std::max(1U, std::thread::hardware_concurrency());
    const char* said = std::getenv("TRIPATCH_THREADS");
    const int threads = said ? std::atoi(said) : 0;
    return threads > 0 ? std::min(cores, static_cast<unsigned>(threads)) : cores;
  }();
  return most;
}

/// While it lives, this thread is one of several at work.
class Alone {
public:
  Alone() : before_(one_of_many) { one_of_many = true; }
  ~Alone() { one_of_many = before_; }
  Alone(const Alone&) = delete;
  Alone& operator=(const Alone&) = delete;

private:
  bool before_;
};

/// f(from, to) on pieces of [from, to) with at least `least` in each, at the same time: see KeptThread for what that costs. Other threads
/// than the caller's share nothing out of what they do.
template <class F>
void parallel_for(Index from, Index to, Index least, const F& f) {
  const std::size_t others_at_most = one_of_many ? 0 : KeptThreads::free(most_threads() - 1);
  const Index n = to - from, cores = 1 + static_cast<Index>(others_at_most);
  const Index shares = std::clamp<Index>(n / least, 1, cores);
  check_interruption();
  const auto share = [&f, flag = interruption](Index first, Index last) {
    const InterruptedBy inherited(flag);
    const Alone alone;
    f(first, last);
  };
  std::vector<InOtherThread> others;  // declared after `share`: its destructor waits for threads that still call it
  for (Index k = 1; k < shares; ++k)
    others.emplace_back(most_threads() - 1,
                        [&share, first = from + n * k / shares, last = from + n * (k + 1) / shares] { share(first, last); });
  if (n > 0) f(from, from + n / shares);
  for (InOtherThread& other : others) other.wait();
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
  constexpr Index share = 4000;  // several times what it costs to share
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
template <class F, class Progress>
void parallel_for_each(std::size_t count, const F& f, const Progress& progress) {
  constexpr std::chrono::milliseconds between_calls(50);  // often enough for a bar, and for Ctrl-C to be obeyed within 100 ms
  std::atomic<std::size_t> next = 0, done = 0;
  std::atomic<bool> stop = false;
  const auto work = [&] {
    const InterruptedBy stopped(&stop);
    one_of_many = count > 1;
    for (std::size_t k = next++; k < count && !stop; k = next++) {
      try {
        f(k);
      } catch (...) {
        stop = true;
        throw;
      }
      ++done;
    }
  };
  const std::size_t cores = most_threads();
  std::vector<std::future<void>> workers;
  for (std::size_t k = 0; k < std::min(cores, count); ++k) workers.push_back(std::async(std::launch::async, work));
  std::exception_ptr failure;
  bool interrupted = false;  // which is what a failure makes of the other workers
  for (std::future<void>& worker : workers) {
    try {
      while (worker.wait_for(between_calls) == std::future_status::timeout)
        if (!stop) {
          check_interruption();
          progress(std::size_t{done});
        }
      worker.get();
    } catch (const Interrupted&) {
      stop = interrupted = true;
      if (worker.valid()) worker.wait();
    } catch (...) {
      stop = true;
      if (!failure) failure = std::current_exception();
      if (worker.valid()) worker.wait();  // `progress` threw, not the work
    }
  }
  if (failure) std::rethrow_exception(failure);
  if (interrupted) throw Interrupted();
  progress(std::size_t{done});
}

}  // namespace tripatch
