// What decides how cages are made, on both sides of each threshold.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>

#include "test_cages.h"
#include "tripatch/cage/cage_fit.h"
#include "tripatch/cage/cage_layout.h"
#include "tripatch/fill.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

/// The corner (1, 1, 1) of a cube of 1 whose three edges there are bevelled: strips of long quads, and the hole where they meet.
struct BevelledCorner {
  explicit BevelledCorner(int segments, double width = 0.2) {
    const std::array<Vec3, 3> axis = {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
    std::array<std::vector<Vec3>, 3> arcs;
    for (int k = 0; k < 3; ++k)
      for (int s = 0; s <= segments; ++s) {
        const double angle = M_PI / 2 * s / segments;
        arcs[k].push_back((1 - width) * Vec3::Ones() + width * (std::cos(angle) * axis[k] + std::sin(angle) * axis[(k + 1) % 3]));
      }
    for (int k = 0; k < 3; ++k) {
      const Vec3 cut = Vec3::Ones() - axis[(k + 2) % 3];
      const auto far = [&](int s) { return Vec3(arcs[k][s].cwiseProduct(cut)); };
      for (int s = 0; s < segments; ++s) add({arcs[k][s + 1], arcs[k][s], far(s), far(s + 1)});
      std::vector<Vec3> end = {Vec3::Zero(), axis[(k + 1) % 3]};
      for (int s = segments; s >= 0; --s) end.push_back(far(s));
      end.push_back(axis[k]);
      add(end);
      const Vec3 along = (1 - width) * axis[(k + 1) % 3], across = (1 - width) * axis[(k + 2) % 3];
      add({axis[k], axis[k] + along, axis[k] + along + across, axis[k] + across});
    }
    vertices.resize(static_cast<Index>(points_.size()), 3);
    for (Index v = 0; v < vertices.rows(); ++v) vertices.row(v) = points_[static_cast<std::size_t>(v)];
    std::vector<Index> rim;
    for (const std::vector<Vec3>& arc : arcs)
      for (int s = 0; s < segments; ++s) rim.push_back(vertex(arc[s]));
    hole = make_hole({vertices, faces}, rim, std::array<Index, 3>{vertex(arcs[0][0]), vertex(arcs[1][0]), vertex(arcs[2][0])});
  }
  Mesh mesh() const { return {vertices, faces}; }

  Points vertices;
  Faces faces;
  Hole hole;

private:
  Index vertex(const Vec3& p) {
    const std::array<long, 3> place = {std::lround(1e9 * p[0]), std::lround(1e9 * p[1]), std::lround(1e9 * p[2])};
    const auto [found, is_new] = number_.try_emplace(place, static_cast<Index>(points_.size()));
    if (is_new) points_.push_back(p);
    return found->second;
  }
  void add(const std::vector<Vec3>& corners) {
    std::vector<Index> face;
    for (const Vec3& p : corners) face.push_back(vertex(p));
    faces.add(face);
  }
  std::map<std::array<long, 3>, Index> number_;
  std::vector<Vec3> points_;
};

}  // namespace

TEST_CASE("surroundings that a fair cage cannot hold move four times as far, up to three times over", "[thresholds]") {
  const BevelledCorner corner(3);
  const std::vector<CageHole> holes = {{corner.hole, cage_layout(corner.hole, corner.vertices, false, 0, {0, 0})}};
  struct Made {
    Points inside;
    bool bent;  // more than before
  };
  const auto made = [&](int power) {  // of four, times what is tolerated
    CageOptions options;
    options.fair_open = std::ldexp(options.fair_open, 2 * power);
    CageFit fit(corner.mesh(), holes, {}, {}, options);
    const CageEnergies energies = fit.make_fair()[0];
    return Made{fit.inside(0), energies.after > energies.before};
  };
  const Made once = made(0);
  for (const int power : {-1, -2, -3}) {
    const Made later = made(power);
    CHECK_FALSE(later.bent);
    CHECK(later.inside == once.inside);
  }
  CHECK(made(1).inside != once.inside);  // as far as at first
  CHECK(made(-4).bent);
}

TEST_CASE("a cage's report warns of poles of more than seven triangles", "[thresholds]") {
  for (const int longest : {7, 6}) {  // sides of 1, 1 and so many edges: a pole of 7 triangles, of 8
    const Index n = 2 + longest;
    constexpr Index rings = 5;
    Points vertices(rings * n, 3);
    Faces faces;
    FillOptions options;
    for (Index k = 0; k < n; ++k) {
      const Vec3 p = k < 2 ? Vec3(Vec3::Unit(k)) : Vec3(Vec3::Unit(2) + (Vec3::UnitX() - Vec3::UnitZ()) * (k - 2) / longest);
      for (Index j = 0; j < rings; ++j) {
        vertices.row(j * n + k) = Vec3::Constant(1.0 / 3) + (1 + 0.3 * static_cast<double>(j)) * (p - Vec3::Constant(1.0 / 3));
        if (j + 1 == rings) continue;
        const Index a = j * n + k, b = j * n + (k + 1) % n;
        faces.add(std::array<Index, 3>{b, a, a + n});
        faces.add(std::array<Index, 3>{b, a + n, b + n});
      }
    }
    options.rim.emplace();
    for (Index k = 0; k < n; ++k) options.rim->push_back(k);
    options.corners = {0, 1, 2};
    options.output = Output::cage;
    options.subdivision.loop = true;
    const Fill made = fill({vertices, faces}, options);
    Index most = 0;
    for (const auto& [vertex, valence] : made.report.poles) most = std::max(most, valence);
    CHECK(most == 14 - longest);
    CHECK(std::any_of(made.report.warnings.begin(), made.report.warnings.end(),
                      [](const std::string& said) { return said.find("Pole of valence 8") == 0; }) == (most > 7));
  }
}
