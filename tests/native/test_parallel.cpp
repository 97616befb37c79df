#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <catch2/catch.hpp>
#include <stdexcept>
#include <thread>
#include <vector>

#include "tripatch/math/meanwhile.h"
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

TEST_CASE("a running piece of work ends when progress throws, with what was thrown", "[parallel]") {
  std::atomic<int> ended = 0;
  const auto endless = [&](std::size_t) {
    for (;;) {
      try {
        parallel_for(0, 100, 10, [](Index, Index) {
          for (;;) check_interruption();
        });
      } catch (const Interrupted&) {
        ++ended;
        throw;
      }
    }
  };
  for (std::size_t count : {1, 5}) {
    ended = 0;
    CHECK_THROWS_AS(parallel_for_each(count, endless, [](std::size_t) { throw std::runtime_error("enough"); }),
                    std::runtime_error);
    CHECK(ended >= 1);
  }
  CHECK_NOTHROW(check_interruption());
}

TEST_CASE("a failure is thrown on and not what it makes of the work beside it", "[parallel]") {
  const auto work = [](std::size_t k) {
    if (k == 1) throw std::invalid_argument("the second");
    for (;;) check_interruption();
  };
  if (std::thread::hardware_concurrency() < 2) return;
  for (int again = 0; again < 20; ++again) CHECK_THROWS_AS(parallel_for_each(2, work, [](std::size_t) {}), std::invalid_argument);
}

TEST_CASE("work asks by its own thread, and what it is told ends all of it", "[parallel]") {
  const std::thread::id caller = std::this_thread::get_id();
  int asked_by_caller = 0;
  const auto tell = [&] {
    asked_by_caller += std::this_thread::get_id() == caller;
    if (asked_by_caller == 3) throw std::runtime_error("enough");
  };
  const auto endless = [](Index, Index) {
    for (;;) check_interruption();
  };
  CHECK_THROWS_AS(work_and_ask([&] { parallel_for(0, 100, 10, endless); }, tell), std::runtime_error);
  CHECK(asked_by_caller == 3);
  CHECK_THROWS_AS(work_and_ask([] { throw std::invalid_argument("the work's own"); }, [] {}), std::invalid_argument);
  CHECK_NOTHROW(check_interruption());
  CHECK(asking == nullptr);
  work_and_ask([] { check_interruption(); }, [] { FAIL("asked before it was due"); });
  const auto asked_in = [](int passes, std::chrono::milliseconds each) {
    int times = 0;
    work_and_ask(
        [&] {
          for (int k = 0; k < passes; ++k) {
            std::this_thread::sleep_for(each);
            check_interruption();
          }
        },
        [&] { ++times; });
    return times;
  };
  CHECK(asked_in(4, std::chrono::milliseconds(60)) == 4);  // whatever comes seldom is asked about each time
}

TEST_CASE("who is asked to end hands that on", "[parallel]") {
  const std::atomic<bool> stop = true;
  const InterruptedBy asked(&stop);
  CHECK_THROWS_AS(check_interruption(), Interrupted);
  CHECK_THROWS_AS(parallel_for(0, 10, 1, [](Index, Index) {}), Interrupted);
  CHECK_THROWS_AS(parallel_for_each(
                      1,
                      [](std::size_t) {
                        for (;;) check_interruption();
                      },
                      [](std::size_t) {}),
                  Interrupted);
}

TEST_CASE("work beside other work gives its result, or what it throws, where that is asked for", "[parallel]") {
  const std::thread::id caller = std::this_thread::get_id();
  Meanwhile<bool> other([&] { return std::this_thread::get_id() != caller; });
  CHECK(other.get());
  Meanwhile<int> fails([]() -> int { throw std::invalid_argument("no"); });
  CHECK_THROWS_AS(fails.get(), std::invalid_argument);
}

TEST_CASE("what two threads do together is all done, once, before they begin with the next", "[parallel]") {
  std::vector<int> done;
  std::size_t last = 0;
  std::array<int, 2> by = {0, 0}, stale = {0, 0};
  Together work([&](int k, int thread) {
    ++done[static_cast<std::size_t>(k)];
    ++by[static_cast<std::size_t>(thread)];
    stale[static_cast<std::size_t>(thread)] += done.size() != last;
  });
  int all = 0;
  for (int round = 0; round < 2000; ++round) {
    const int count = round % 7;
    done.assign(static_cast<std::size_t>(count), 0);
    last = done.size();
    work(count);
    CHECK(std::all_of(done.begin(), done.end(), [](int times) { return times == 1; }));
    all += count;
  }
  CHECK(stale[0] + stale[1] == 0);
  CHECK(by[0] + by[1] == all);
}

TEST_CASE("of two pieces of work both are done, one after the other where no core is free", "[parallel]") {
  std::atomic<int> done = 0;
  both_at_once([&] { done += 1; }, [&] { done += 10; });
  CHECK(done == 11);
  std::vector<int> order;
  {
    const Alone alone;
    CHECK_FALSE(has_free_core());
    both_at_once([&] { order.push_back(1); }, [&] { order.push_back(2); });
  }
  CHECK(order == std::vector<int>{1, 2});
  CHECK(has_free_core() == (std::thread::hardware_concurrency() > 1));
}

TEST_CASE("what a thread that keeps others shares out goes to the same ones time and again", "[parallel]") {
  const std::thread::id caller = std::this_thread::get_id();
  std::vector<std::thread::id> others;
  for (int round = 0; round < 100; ++round) {
    const KeptThreads kept;  // also by one after another
    both_at_once([] {}, [&] { others.push_back(std::this_thread::get_id()); });
  }
  REQUIRE(others.size() == 100);
  CHECK(std::all_of(others.begin(), others.end(), [&](std::thread::id other) { return other == others[0]; }));
  CHECK((others[0] != caller) == has_free_core());
}

#ifndef __SANITIZE_THREAD__  // which knows no threads after a fork
TEST_CASE("a process that is forked begins threads of its own, and ends without those of the one that it comes from",
          "[parallel]") {
  const KeptThreads kept;
  const auto works = [] {
    std::atomic<int> done = 0;
    both_at_once([&] { done += 1; }, [&] { done += 10; });
    return done == 11;
  };
  REQUIRE(works());
  const pid_t child = fork();
  if (child == 0) {
    alarm(20);  // where it waits for a thread that is not there
    std::thread([] { const KeptThreads of_this; }).join();
    _exit(works() ? 0 : 1);
  }
  int status = -1;
  REQUIRE(waitpid(child, &status, 0) == child);
  CHECK(status == 0);
  CHECK(works());
}
#endif

TEST_CASE("threads that are kept do all of what is shared out within what is shared out", "[parallel]") {
  const KeptThreads kept;
  std::atomic<int> done = 0;
  const auto many = [&] { parallel_for(0, 100, 10, [&](Index from, Index to) { done += static_cast<int>(to - from); }); };
  for (int round = 0; round < 20; ++round) {
    both_at_once(many, many);
    const KeptThreads inner;
    many();
  }
  CHECK(done == 20 * 300);
}

TEST_CASE("what is thrown in a thread that is kept is thrown on, and it goes on with the next", "[parallel]") {
  const KeptThreads kept;
  const auto fails = [](int) { throw std::invalid_argument("no"); };
  for (int round = 0; round < 20; ++round) {
    CHECK_THROWS_AS(both_at_once([] {}, [&] { fails(round); }), std::invalid_argument);
    CHECK_THROWS_AS(both_at_once([&] { fails(round); }, [] {}), std::invalid_argument);
    CHECK_THROWS_AS(both_at_once([&] { fails(round); }, [&] { fails(round); }), std::invalid_argument);
    bool first = false, second = false;
    both_at_once([&] { first = true; }, [&] { second = true; });
    CHECK((first && second));
  }
}

TEST_CASE("work beside other work ends where nobody asks for its result, or who waits for it is interrupted", "[parallel]") {
  std::atomic<int> ended = 0;
  const auto endless = [&]() -> int {
    try {
      for (;;) check_interruption();
    } catch (const Interrupted&) {
      ++ended;
      throw;
    }
  };
  {
    const Meanwhile<int> forgotten(endless);
  }
  CHECK(ended == 1);
  const std::atomic<bool> stop = true;
  const InterruptedBy stopped(&stop);
  CHECK_THROWS_AS(
      [&] {
        Meanwhile<int> waited_for(endless);
        return waited_for.get();
      }(),
      Interrupted);
  CHECK(ended == 2);
}
