#include <atomic>
#include <catch2/catch.hpp>
#include <string>
#include <thread>
#include <vector>

#include "tripatch/boundary/complaint.h"

using namespace tripatch;

TEST_CASE("messages that nobody waits for are left to others") {
  CHECK(!Complaint::takes_error("somebody else's"));
  CHECK(!Complaint::takes_warning());
  {
    const Complaint complaint;
    CHECK(Complaint::takes_warning());
    CHECK(Complaint::takes_error("mine"));
    CHECK(complaint.text() == "mine");
  }
  CHECK(!Complaint::takes_error("somebody else's"));
}

TEST_CASE("the innermost complaint takes a message, and the outer one goes on after it") {
  const Complaint outer;
  {
    const Complaint inner;
    Complaint::takes_error("inner");
    CHECK(inner.text() == "inner");
  }
  CHECK(outer.text().empty());
  Complaint::takes_error("outer");
  CHECK(outer.text() == "outer");
}

TEST_CASE("each thread hears its own messages") {
  std::atomic<int> wrong = 0;
  std::vector<std::thread> threads;
  for (int k = 0; k < 4; ++k)
    threads.emplace_back([&, k] {
      for (int i = 0; i < 1000; ++i) {
        const Complaint complaint;
        const std::string message = std::to_string(k) + " " + std::to_string(i);
        Complaint::takes_error(message.c_str());
        wrong += complaint.text() != message;
      }
    });
  for (std::thread& thread : threads) thread.join();
  CHECK(wrong == 0);
}
