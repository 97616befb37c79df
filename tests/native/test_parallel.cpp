#include <atomic>
#include <catch2/catch.hpp>
#include <stdexcept>
#include <thread>
#include <vector>

#include "tripatch/math/parallel.h"

using namespace tripatch;

TEST_CASE("every piece of work is done once, and progress ends with their number", "[parallel]") {
  for (std::size_t count : {0, 1, 2, 100}) {
    std::vector<std::atomic<int>> done(count);
    std::size_t told = 1000;
    parallel_for_each(count, [&](std::size_t k) { ++done[k]; }, [&](std::size_t k) { told = k; });
    for (const auto& times : done) CHECK(times == 1);
    CHECK(told == count);
  }
}

TEST_CASE("progress is told by the caller's thread, and what it throws ends the work", "[parallel]") {
  const std::thread::id caller = std::this_thread::get_id();
  std::atomic<int> done = 0;
  bool mine = true;
  const auto slow = [&](std::size_t) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    ++done;
  };
  CHECK_THROWS_AS(parallel_for_each(1000, slow,
                                    [&](std::size_t) {
                                      mine = mine && std::this_thread::get_id() == caller;
                                      throw std::runtime_error("enough");
                                    }),
                  std::runtime_error);
  CHECK(mine);
  CHECK(done < 1000);
}

TEST_CASE("the work's own exception is thrown on after all have stopped", "[parallel]") {
  std::atomic<int> running = 0;
  const auto fails = [&](std::size_t k) {
    ++running;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    --running;
    if (k == 3) throw std::invalid_argument("the fourth");
  };
  CHECK_THROWS_AS(parallel_for_each(100000, fails, [](std::size_t) {}), std::invalid_argument);
  CHECK(running == 0);
}
