#include <array>
#include <atomic>
#include <catch2/catch.hpp>
#include <numeric>
#include <string>
#include <thread>
#include <vector>

#include "tripatch/boundary/osd_error_scope.h"

using namespace tripatch;

TEST_CASE("messages that nobody waits for are left to others") {
  CHECK(!OsdErrorScope::takes_error("somebody else's"));
  CHECK(!OsdErrorScope::takes_warning());
  {
    const OsdErrorScope complaint;
    CHECK(OsdErrorScope::takes_warning());
    CHECK(OsdErrorScope::takes_error("mine"));
    CHECK(complaint.text() == "mine");
  }
  CHECK(!OsdErrorScope::takes_error("somebody else's"));
}

TEST_CASE("the innermost complaint takes a message, and the outer one goes on after it") {
  const OsdErrorScope outer;
  {
    const OsdErrorScope inner;
    OsdErrorScope::takes_error("inner");
    CHECK(inner.text() == "inner");
  }
  CHECK(outer.text().empty());
  OsdErrorScope::takes_error("outer");
  CHECK(outer.text() == "outer");
}

TEST_CASE("each thread hears its own messages") {
  std::atomic<int> wrong = 0;
  std::vector<std::thread> threads;
  for (int k = 0; k < 4; ++k)
    threads.emplace_back([&, k] {
      for (int i = 0; i < 1000; ++i) {
        const OsdErrorScope complaint;
        const std::string message = std::to_string(k) + " " + std::to_string(i);
        OsdErrorScope::takes_error(message.c_str());
        wrong += complaint.text() != message;
      }
    });
  for (std::thread& thread : threads) thread.join();
  CHECK(wrong == 0);
}

TEST_CASE("of what cannot be subdivided the reason is said in numbers of the mesh, with its place") {
  const OsdErrorScope complaint;
  Faces faces;
  for (const std::vector<Index>& face : {std::vector<Index>{0, 1, 2}, {7, 4, 3, 9, 1, 3}, {5, 6, 7}}) faces.add(face);
  const CodedRefusal twice = not_subdivided(Subdivided::cage, faces, std::vector<Index>{1, 2}, complaint);
  CHECK(std::string(twice.what()) == "The cage cannot be subdivided: a face passes vertex 3 twice");
  CHECK(twice.where() == std::vector<Index>{3});

  std::vector<Index> wide(65536);
  for (std::size_t k = 0; k < wide.size(); ++k) wide[k] = static_cast<Index>(k) + 12;
  faces.add(wide);
  const CodedRefusal corners = not_subdivided(Subdivided::mesh, faces, std::vector<Index>{1, 3}, complaint);
  CHECK(std::string(corners.what()) == "The mesh cannot be subdivided: a face at vertex 12 has 65536 corners, more than 65535");
  CHECK(corners.where() == std::vector<Index>{12});
  CHECK(not_subdivided(Subdivided::cage, faces, std::vector<Index>{1, 2}, complaint).where() == std::vector<Index>{3});

  Faces fan;
  for (Index k = 0; k < 65536; ++k) fan.add(std::array<Index, 3>{4, 5 + k, 6 + k});
  std::vector<Index> all(fan.size());
  std::iota(all.begin(), all.end(), Index{0});
  const CodedRefusal many = not_subdivided(Subdivided::cage, fan, all, complaint);
  CHECK(std::string(many.what()) == "The cage cannot be subdivided: 65536 faces meet at vertex 4, more than 65535");
  CHECK(many.where() == std::vector<Index>{4});
  all.pop_back();
  OsdErrorScope::takes_error("so");
  const CodedRefusal unknown = not_subdivided(Subdivided::cage, fan, all, complaint);
  CHECK(std::string(unknown.what()) == "The cage cannot be subdivided. OpenSubdiv reports: so");
}
