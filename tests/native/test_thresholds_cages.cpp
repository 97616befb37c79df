// What decides how cages are made, on both sides of each threshold.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <numbers>

#include "test_cages.h"
#include "test_refusals.h"
#include "tripatch/cage/cage_fit.h"
#include "tripatch/cage/cage_layout.h"
#include "tripatch/cage_fills/tried_cages.h"
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
        const double angle = std::numbers::pi / 2 * s / segments;
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

bool is_placed(const Mesh& mesh, const std::vector<Index>& rim, const std::optional<std::vector<Index>>& corners = {}) {
  FillOptions options;
  options.rim = rim;
  options.corners = corners;
  options.output = Output::cage;
  return fill(mesh, options).report.method_reason.find("would leave the surrounding surface") != std::string::npos;
}

/// Whether the cage of 4 x 4 quads that are missing in a grid is placed where the mesh continues. The grid has waves along both of its
/// directions, so many to a side of the hole and the height of so many edges. Between corners that are given: without them its rows continue.
bool is_placed_in_waves(double waves, double height) {
  constexpr Index n = 12, hole = 4, first = (n - hole) / 2, last = first + hole;
  const auto at = [](Index i, Index j) { return i * (n + 1) + j; };
  const auto wave = [&](Index i) { return std::cos(std::numbers::pi * waves * static_cast<double>(2 * i - n) / (2 * hole)); };
  Points vertices((n + 1) * (n + 1), 3);
  Faces faces;
  for (Index i = 0; i <= n; ++i)
    for (Index j = 0; j <= n; ++j) {
      vertices.row(at(i, j)) << static_cast<double>(i), static_cast<double>(j), height * wave(i) * wave(j);
      const bool gone = i >= first && i < last && j >= first && j < last;
      if (i < n && j < n && !gone) faces.add(std::array<Index, 4>{at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  std::vector<Index> rim;
  for (Index k = 0; k < hole; ++k) rim.push_back(at(first + k, first));
  for (Index k = 0; k < hole; ++k) rim.push_back(at(last, first + k));
  for (Index k = 0; k < hole; ++k) rim.push_back(at(last - k, last));
  for (Index k = 0; k < hole; ++k) rim.push_back(at(first, last - k));
  return is_placed({vertices, faces}, rim, std::vector<Index>{rim[0], rim[hole], rim[2 * hole], rim[3 * hole]});
}

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
    CHECK(has(made.report.warnings, Code::high_valence_pole) == (most > 7));
  }
}

TEST_CASE("faces that reach four edges of the rim are strips, beside which a split edge may fold", "[thresholds]") {
  constexpr Index n = 5;
  const double edge = 2 * std::sin(std::numbers::pi / n), cosine = std::cos(2 * std::numbers::pi / n);
  for (const double reach : {3.97, 4.03}) {
    const double outer = cosine + std::sqrt(cosine * cosine - 1 + std::pow(reach * edge, 2));  // to the next vertex but outside
    Points vertices(2 * n, 3);
    Faces faces;
    std::vector<Index> rim;
    for (Index k = 0; k < n; ++k) {
      const double turn = 2 * std::numbers::pi * static_cast<double>(k) / n;
      vertices.row(k) << std::cos(turn), std::sin(turn), 0;
      vertices.row(n + k) = outer * vertices.row(k);
      faces.add(std::array<Index, 4>{(k + 1) % n, k, n + k, n + (k + 1) % n});
      rim.push_back(k);
    }
    FillOptions options;
    options.rim = rim;
    const Mesh mesh{vertices, faces};
    SidedRim hole;
    hole.rim = rim;
    CHECK(may_fold_by_splitting(FillContext(mesh, options.rim, options), hole) == (reach > 4));
  }
}

TEST_CASE("beside a strip either edge of the rim may be the shorter one, and beside sides of an edge each all may fold",
          "[thresholds]") {
  // only at the first vertex is a face, the next or the last, more than four times as long as its shorter edge, the other of the two
  Points vertices(10, 3);
  vertices.topRows(5) << 0, 0, 0, 1, 0, 0, 3.5, 1, 0, 0, 5, 0, -3, 4, 0;
  for (Index k = 0; k < 5; ++k) vertices.row(5 + k) = Vec3(1.1 * vertices(k, 0), 1.1 * vertices(k, 1) - 0.23, 0).transpose();
  vertices.rowwise() += Eigen::RowVector3d(10, 10, 0);
  for (const bool mirrored : {false, true}) {
    if (mirrored) vertices.col(0) *= -1;
    Faces faces;
    SidedRim hole;
    for (Index k = 0; k < 5; ++k) {
      const Index next = (k + 1) % 5;
      faces.add(mirrored ? std::array<Index, 4>{k, next, 5 + next, 5 + k} : std::array<Index, 4>{next, k, 5 + k, 5 + next});
      hole.rim.push_back(mirrored ? (5 - k) % 5 : k);
    }
    FillOptions options;
    options.rim = hole.rim;
    const auto may_fold = [&] {
      const Mesh mesh{vertices, faces};
      return may_fold_by_splitting(FillContext(mesh, options.rim, options), hole);
    };
    CHECK(may_fold());
    Points longer = vertices;
    vertices.row(1) += 0.4 * (vertices.row(1) - vertices.row(0));
    CHECK_FALSE(may_fold());
    vertices = longer;
  }
  Points triangle(6, 3);
  triangle << 0, 0, 0, 1, 0, 0, 0.5, 0.9, 0, -0.2, -0.1, 0, 1.2, -0.1, 0, 0.5, 1.1, 0;
  Faces faces;
  SidedRim hole;
  for (Index k = 0; k < 3; ++k) {
    faces.add(std::array<Index, 4>{(k + 1) % 3, k, 3 + k, 3 + (k + 1) % 3});
    hole.rim.push_back(k);
  }
  FillOptions options;
  options.rim = hole.rim;
  const Mesh mesh{triangle, faces};
  CHECK(may_fold_by_splitting(FillContext(mesh, options.rim, options), hole));
}

TEST_CASE("a fair cage has run off that is 0.04 of the hole's size from where the mesh would go on", "[thresholds]") {
  CHECK_FALSE(is_placed_in_waves(1, 0.39));
  CHECK(is_placed_in_waves(1, 0.42));
}

TEST_CASE("a fair cage is as likely that is 3.5 deviations from where the mesh would go on", "[thresholds]") {
  CHECK(is_placed_in_waves(1, 0.58));
  CHECK_FALSE(is_placed_in_waves(1, 0.62));
}

TEST_CASE("a fair cage has run off that is a quarter of the hole's size off, however little is known there", "[thresholds]") {
  CHECK_FALSE(is_placed_in_waves(2, 1.75));
  CHECK(is_placed_in_waves(2, 1.95));
}

TEST_CASE("between guessed corners a fair cage has run off that is 0.13 of the hole's size off", "[thresholds]") {
  const auto placed = [](double angle) {  // of a ball ten quads around
    constexpr Index n = 10, rings = 3;
    Points vertices(n * (rings + 1), 3);
    Faces faces;
    std::vector<Index> rim;
    for (Index j = 0; j <= rings; ++j)
      for (Index k = 0; k < n; ++k) {
        const double from_pole = angle + 0.3 * static_cast<double>(j), around = 2 * std::numbers::pi * static_cast<double>(k) / n;
        vertices.row(j * n + k) << std::sin(from_pole) * std::cos(around), std::sin(from_pole) * std::sin(around),
            std::cos(from_pole);
        const Index next = (k + 1) % n;
        if (j < rings) faces.add(std::array<Index, 4>{j * n + next, j * n + k, (j + 1) * n + k, (j + 1) * n + next});
        if (j == 0) rim.push_back(k);
      }
    return is_placed({vertices, faces}, rim);
  };
  CHECK_FALSE(placed(0.95));
  CHECK(placed(0.99));
}
