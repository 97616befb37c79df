// Work on all cores.
#pragma once

#include <algorithm>
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

}  // namespace tripatch
