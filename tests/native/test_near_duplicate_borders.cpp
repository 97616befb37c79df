// Borders that lie upon each other, on meshes whose faces are parted by giving them vertices of their own.
#include <catch2/catch.hpp>
#include <cmath>

#include "test_refusals.h"
#include "tripatch/fill.h"
#include "tripatch/hole/near_duplicate_borders.h"
#include "tripatch/mesh/border_loops.h"

using namespace tripatch;

namespace {

struct Sheet {
  Points vertices;
  Faces faces;
  Mesh mesh() const { return {vertices, faces}; }
  std::vector<std::vector<Index>> rims() const { return border_loops(Connectivity(mesh())); }
  std::vector<std::optional<Message>> told() const { return told_of_near_duplicate_borders(mesh(), rims()); }
  std::vector<std::string> texts() const {
    std::vector<std::string> out;
    for (const std::optional<Message>& each : told()) out.push_back(each ? each->text() : "");
    return out;
  }
};

/// A saddle over six squares a side, that in the middle left out; those from a column on have vertices of their own.
Sheet parted_from(int column) {
  constexpr int n = 6, row = n + 1;
  Sheet made{Points(2 * row * row, 3), {}};
  for (int j = 0; j < row; ++j)
    for (int i = 0; i < row; ++i)
      for (int copy : {0, row * row}) made.vertices.row(copy + j * row + i) = Vec3(i, j, 0.01 * (i * i - j * j));
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const Index a = j * row + i + (i < column ? 0 : row * row), b = a + row;
      if (i != 2 || j != 2) made.faces.add(std::array<Index, 4>{a, a + 1, b + 1, b});
    }
  return made;
}

/// The same with vertices of its own for every face.
Sheet parted_everywhere(const Sheet& joined) {
  Sheet made{Points(static_cast<Index>(joined.faces.corners.size()), 3), {}};
  Index next = 0;
  for (Index f = 0; f < joined.faces.size(); ++f) {
    std::vector<Index> face;
    for (Index v : joined.faces[f]) {
      made.vertices.row(next) = joined.vertices.row(v);
      face.push_back(next++);
    }
    made.faces.add(face);
  }
  return made;
}

bool names(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("of a joined mesh nothing is told, whatever lies unused at its places") {
  for (const std::optional<Message>& told : parted_from(6).told()) CHECK(!told);
}

TEST_CASE("a seam beside a hole is told of the borders that run along it only") {
  const Sheet s = parted_from(4);  // two columns on are joined to nothing; the hole is among the others
  const std::vector<std::vector<Index>> rims = s.rims();
  REQUIRE(rims.size() == 3);
  REQUIRE(rims[0].size() == 4);
  const std::vector<std::optional<Message>> told = s.told();
  CHECK(!told[0]);
  CHECK(names(told[1]->text(), "6 of the 16 edges"));
  CHECK(names(told[2]->text(), "6 of the 20 edges"));
}

TEST_CASE("a seam that ends in a hole is told of its rim, whose edges beside it count only") {
  const Sheet s = parted_from(3);  // the seam runs along one side of the hole
  const std::vector<std::optional<Message>> told = s.told();
  REQUIRE(told.size() == 2);
  for (const std::optional<Message>& each : told) CHECK(names(each->text(), "5 of the "));
  CHECK(told[0]->code == Code::edges_on_borders);
}

TEST_CASE("the last digit of a coordinate parts what lies upon each other, the sign of zero does not") {
  Sheet s = parted_everywhere({parted_from(6)});
  std::size_t before = 0, after = 0;
  for (const std::optional<Message>& each : s.told()) before += each ? 1 : 0;
  CHECK(before == 35);
  for (Index v = 0; v < s.vertices.rows(); ++v)
    for (int k = 0; k < 3; ++k)
      if (s.vertices(v, k) == 0 && v % 2 == 1) s.vertices(v, k) = -0.0;
  CHECK(s.texts() == parted_everywhere({parted_from(6)}).texts());
  for (Index v = 0; v < s.vertices.rows(); ++v) s.vertices(v, 2) = 100 + static_cast<double>(v) * 1e-13;
  for (const std::optional<Message>& each : s.told()) after += each ? 1 : 0;
  CHECK(after == 0);
}

TEST_CASE("fills and refusals of such rims say so, one or all, near the origin and far away") {
  for (double away : {0.0, 1e6}) {
    Sheet soup = parted_everywhere(parted_from(6)), seam = parted_from(3);
    soup.vertices.array() += away;
    seam.vertices.array() += away;
    const std::vector<std::vector<Index>> rims = soup.rims();
    for (const auto& result : fill_all(soup.mesh(), rims)) {
      const Refused& refused = std::get<Refused>(result);
      CHECK(refused.message.code == Code::loose_face);
      REQUIRE(refused.also.size() == 1);
      CHECK(code_of(refused.also[0]).ends_with("_on_borders"));
    }
    FillOptions options;
    options.rim = rims[3];
    CHECK(refusal_code([&] { fill(soup.mesh(), options); }) == "loose_face");
    options.rim = seam.rims()[0];
    const Fill one = fill(seam.mesh(), options);
    const Fill all = std::get<Fill>(fill_all(seam.mesh(), {*options.rim})[0]);
    for (const Fill* each : {&one, &all}) {
      REQUIRE(!each->report.warnings.empty());
      CHECK(code_of(each->report.warnings.back()).ends_with("_on_borders"));
    }
  }
}
