// Work on all cores.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <future>
#include <thread>
#include <vector>

#include "tripatch/types.h"

namespace tripatch {

/// True in threads that are themselves one of several at work: they share nothing out.
inline thread_local bool one_of_many = false;

/// f(from, to) on pieces of [from, to) with at least `least` in each, at the same time. A thread costs some 0.1 ms.
template <class F>
void parallel_for(Index from, Index to, Index least, const F& f) {
  static const Index all_cores = std::max(1U, std::thread::hardware_concurrency());
  const Index n = to - from, cores = one_of_many ? 1 : all_cores;
  const Index shares = std::clamp<Index>(n / least, 1, cores);
  std::vector<std::future<void>> others;
  for (Index k = 1; k < shares; ++k)
    others.push_back(std::async(std::launch::async, f, from + n * k / shares, from + n * (k + 1) / shares));
  if (n > 0) f(from, from + n / shares);
  for (std::future<void>& other : others) other.get();
}

/// f(k) for each k < count, on all cores, each core the next one as soon as it is free. progress(done) is called by the caller's own
/// thread, ten times a second and after the last. What either throws ends the work and is thrown on, the first of them.
template <class F, class Progress>
void parallel_for_each(std::size_t count, const F& f, const Progress& progress) {
  constexpr std::chrono::milliseconds between_calls(100);  // often enough for a bar and for Ctrl-C
  std::atomic<std::size_t> next = 0, done = 0;
  std::atomic<bool> stop = false;
  const auto work = [&] {
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
  const std::size_t cores = std::max(1U, std::thread::hardware_concurrency());
  std::vector<std::future<void>> workers;
  for (std::size_t k = 0; k < std::min(cores, count); ++k) workers.push_back(std::async(std::launch::async, work));
  std::exception_ptr failure;
  for (std::future<void>& worker : workers) {
    try {
      while (worker.wait_for(between_calls) == std::future_status::timeout)
        if (!stop) progress(std::size_t{done});
      worker.get();
    } catch (...) {
      stop = true;
      if (!failure) failure = std::current_exception();
      if (worker.valid()) worker.wait();  // `progress` threw, not the work
    }
  }
  if (failure) std::rethrow_exception(failure);
  progress(std::size_t{done});
}

}  // namespace tripatch
