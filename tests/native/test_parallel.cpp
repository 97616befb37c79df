#ifndef _WIN32
#include <sys/wait.h>
#include <unistd.h>
#endif

#include <algorithm>
#include <atomic>
#include <catch2/catch.hpp>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tripatch/math/parallel.h"
#include "tripatch/threads.h"

using namespace tripatch;

namespace {

/// While it lives, so many threads work.
class Threads {
public:
  explicit Threads(int n) { set_threads(n); }
  ~Threads() { set_threads(0); }
  Threads(const Threads&) = delete;
  Threads& operator=(const Threads&) = delete;
};

}  // namespace

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
  Cancel stop;
  stop.request();
  const CancelScope asked(&stop);
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
  AsyncTask<int> answers([] { return 42; });
  CHECK(answers.get() == 42);
  AsyncTask<int> fails([]() -> int { throw std::invalid_argument("no"); });
  CHECK_THROWS_AS(fails.get(), std::invalid_argument);
}

TEST_CASE("of two pieces of work both are done, one after the other where no core is free", "[parallel]") {
  std::atomic<int> done = 0;
  both_at_once([&] { done += 1; }, [&] { done += 10; });
  CHECK(done == 11);
  std::vector<int> order;
  {
    const SerialScope serial;
    CHECK_FALSE(may_share());
    both_at_once([&] { order.push_back(1); }, [&] { order.push_back(2); });
  }
  CHECK(order == std::vector<int>{1, 2});
  CHECK(may_share());
}

TEST_CASE("the same threads take up one piece of work after another", "[parallel]") {
  const Threads four(4);
  std::set<std::thread::id> others;
  for (int round = 0; round < 100; ++round) {
    std::mutex mutex;
    std::atomic<int> begun = 0;
    parallel_for(0, 4, 1, [&](Index, Index) {
      ++begun;
      while (begun < 4) std::this_thread::yield();
      const std::lock_guard lock(mutex);
      others.insert(std::this_thread::get_id());
    });
  }
  CHECK(others.erase(std::this_thread::get_id()) == 1);
  CHECK(others.size() == 3);
}

TEST_CASE("with one thread nothing is shared out, and with 0 as many work as at first", "[parallel]") {
  const int first = max_threads();
  {
    const Threads one(1);
    CHECK(max_threads() == 1);
    CHECK_FALSE(may_share());
    Index pieces = 0;
    parallel_for(0, 100, 1, [&](Index, Index) { ++pieces; });
    CHECK(pieces == 1);
  }
  CHECK(max_threads() == first);
}

TEST_CASE("work that fails in the caller's own share is left when nobody works on it any more", "[parallel]") {
  const Threads four(4);
  const std::thread::id caller = std::this_thread::get_id();
  for (int round = 0; round < 200; ++round) {
    std::atomic<int> at_work = 0;
    const auto fails = [&](Index, Index) {
      ++at_work;
      if (std::this_thread::get_id() != caller) std::this_thread::sleep_for(std::chrono::microseconds(200));
      --at_work;
      if (std::this_thread::get_id() == caller) throw std::invalid_argument("the caller's own");
    };
    CHECK_THROWS_AS(parallel_for(0, 4, 1, fails), std::invalid_argument);
    CHECK(at_work == 0);
  }
}

TEST_CASE("of several failures the first piece's is thrown on", "[parallel]") {
  const Threads four(4);
  for (int round = 0; round < 100; ++round) {
    std::atomic<int> begun = 0;
    const auto fails = [&](Index from, Index) {
      ++begun;
      while (begun < 4) std::this_thread::yield();
      throw std::invalid_argument(std::to_string(from));
    };
    CHECK_THROWS_WITH(parallel_for(0, 4, 1, fails), "0");
  }
}

#if !defined(_WIN32) && !defined(__SANITIZE_THREAD__)  // the one has no fork, the other knows no threads after it
TEST_CASE("a process that is forked begins threads of its own, and ends without those of the one that it comes from",
          "[parallel]") {
  const Threads two(2);
  const auto works = [] {
    std::atomic<int> done = 0;
    both_at_once([&] { done += 1; }, [&] { done += 10; });
    return done == 11;
  };
  REQUIRE(works());
  const pid_t child = fork();
  if (child == 0) {
    alarm(20);  // where it waits for a thread that is not there
    _exit(works() ? 0 : 1);
  }
  int status = -1;
  REQUIRE(waitpid(child, &status, 0) == child);
  CHECK(status == 0);
  CHECK(works());
}
#endif

TEST_CASE("all is done of what is shared out within what is shared out", "[parallel]") {
  const Threads two(2);
  std::atomic<int> done = 0;
  const auto many = [&] { parallel_for(0, 100, 10, [&](Index from, Index to) { done += static_cast<int>(to - from); }); };
  for (int round = 0; round < 20; ++round) {
    both_at_once(many, many);
    many();
  }
  CHECK(done == 20 * 300);
}

TEST_CASE("what is thrown in another thread is thrown on, and it continues with the next", "[parallel]") {
  const Threads two(2);
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
  std::atomic<int> begun = 0, ended = 0;
  const auto endless = [&]() -> int {
    ++begun;
    try {
      for (;;) check_interruption();
    } catch (const Interrupted&) {
      ++ended;
      throw;
    }
  };
  {
    const AsyncTask<int> forgotten(endless);
    while (begun == 0) std::this_thread::yield();
  }
  CHECK(ended == 1);
  Cancel stop;
  stop.request();
  const CancelScope stopped(&stop);
  CHECK_THROWS_AS(
      [&] {
        AsyncTask<int> waited_for(endless);
        while (begun == 1) std::this_thread::yield();
        return waited_for.get();
      }(),
      Interrupted);
  CHECK(ended == 2);
}
