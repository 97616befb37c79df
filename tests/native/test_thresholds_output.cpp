// What decides on triangles and weights, on both sides of its thresholds; those of quads are in test_quad_cover and test_pair_quads.
#include <catch2/catch.hpp>
#include <cmath>

#include "tripatch/output/attribute_weights.h"
#include "tripatch/output/domain_mesh.h"
#include "tripatch/output/regular_grid.h"
#include "tripatch/output/triangulate.h"
#include "tripatch/patch/bezier_triangle.h"

using namespace tripatch;

namespace {

using Parameters = std::array<std::vector<double>, 3>;

const BezierTriangle flat((Points(3, 3) << 0, 0, 0, 1, 0, 0, 0.5, std::sqrt(0.75), 0).finished());

/// n edges, growing like t^power, on side 0; even ones on the others.
Parameters graded(int n, double power = 1, int others = 0) {
  Parameters parameters;
  for (int i = 0; i < 3; ++i) {
    const int edges = i > 0 && others ? others : n;
    for (int k = 0; k <= edges; ++k) parameters[i].push_back(std::pow(static_cast<double>(k) / edges, i == 0 ? power : 1));
  }
  return parameters;
}

double worst_shape(const TriangleMesh& mesh, const Points& x) {
  double worst = 1;
  for (const auto& t : mesh.triangles) worst = std::min(worst, shape(x.row(t[0]), x.row(t[1]), x.row(t[2])));
  return worst;
}

}  // namespace

namespace {

/// The equilateral triangle over a domain that is projected such that its points come nearer to corner 2 by so many times.
class Projected final : public Surface {
public:
  explicit Projected(double times) : times_(times) {}
  void evaluate(const double* b, Index n, int, double* out) const override {  // positions only
    for (Index k = 0; k < n; ++k, b += 3, out += 3) {
      const double last = b[2] / times_, sum = b[0] + b[1] + last;
      out[0] = (b[1] + 0.5 * last) / sum, out[1] = std::sqrt(0.75) * last / sum, out[2] = 0;
    }
  }

private:
  double times_;
};

/// Of n edges a side at these parameters; none where it squeezes its triangles.
std::optional<TriangleMesh> grid_of(const std::array<std::vector<double>, 3>& parameters, const Surface& surface) {
  const Index n = static_cast<Index>(parameters[0].size()) - 1;
  Points rim = Points::Zero(3 * n, 3);
  for (Index k = 0; k < 3 * n; ++k) {
    const Index from = k / n, side = (from + 2) % 3;
    rim(k, from) = 1 - parameters[side][k % n], rim(k, (from + 1) % 3) = parameters[side][k % n];
  }
  return regular_grid(parameters, rim, surface);
}

}  // namespace

TEST_CASE("the regular grid is taken down to triangles of shape 0.2 in space", "[thresholds]") {
  std::vector<double> even;
  for (int k = 0; k <= 6; ++k) even.push_back(k / 6.0);
  for (const double wanted : {0.195, 0.205}) {
    const double height = (1 - std::sqrt(1 - wanted * wanted)) / wanted;  // an equilateral triangle so high: 2 h / (1 + h^2)
    const BezierTriangle flat((Points(3, 3) << 0, 0, 0, 1, 0, 0, 0.5, std::sqrt(0.75) * height, 0).finished());
    CHECK(grid_of({even, even, even}, flat).has_value() == (wanted > 0.2));
  }
}

TEST_CASE("and to triangles of shape 0.1 in the domain, where the patch stretches them back", "[thresholds]") {
  const auto grid = [](double times) {
    std::array<std::vector<double>, 3> parameters;
    for (int k = 0; k <= 6; ++k) {
      const double t = k / 6.0, nearer = times * t / (times * t + 1 - t), farther = t / (t + times * (1 - t));
      parameters[0].push_back(nearer), parameters[1].push_back(farther), parameters[2].push_back(t);
    }
    return grid_of(parameters, Projected(times));
  };
  double low = 1, high = 100;
  REQUIRE(grid(low));
  REQUIRE_FALSE(grid(high));
  while (high > 1.001 * low) {
    const double middle = std::sqrt(low * high);
    (grid(middle) ? low : high) = middle;
  }
  const TriangleMesh last = *grid(low);
  const double worst = worst_shape(last, last.barycentric);
  CHECK(worst >= 0.1);
  CHECK(worst < 0.105);
}

TEST_CASE("a regular grid has up to a thousand edges a side", "[thresholds]") {
  CHECK(triangulate(graded(1000), {}, flat).triangles.size() == 1'000'000);
  CHECK(triangulate(graded(1001), {}, flat).triangles.size() < 400'000);  // 50,000, and what a thousand edges a side need to grow
}

TEST_CASE("a fill that follows its rim is coarser inside where it would have more than 50,000 triangles", "[thresholds]") {
  // counts that differ by one have no regular grid; n edges a side ask for n^2 triangles
  const auto density = [](int n) {
    return static_cast<double>(triangulate(graded(n, 1, n + 1), {}, flat).triangles.size()) / (n * n);
  };
  const double below = density(200), above = density(330);
  CHECK(below > 0.8);
  CHECK(above < 0.75);
}

namespace {

/// Of the triangles whose corners lie each in the middle of six neighbors, as those of a lattice do inside, how many there are and the least shape.
std::pair<Index, double> lattices_of(const TriangleMesh& mesh) {
  const Index n = mesh.barycentric.rows();
  Points sum = Points::Zero(n, 3);
  std::vector<int> count(n, 0);
  for (const auto& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) sum.row(t[k]) += mesh.barycentric.row(t[(k + 1) % 3]), ++count[t[k]];
  const auto is_regular = [&](Index v) {
    return count[v] == 6 && (sum.row(v) / 6 - mesh.barycentric.row(v)).cwiseAbs().maxCoeff() < 1e-12;
  };
  const Points x = flat.positions(mesh.barycentric);
  std::pair<Index, double> found = {0, 1};
  for (const auto& t : mesh.triangles)
    if (is_regular(t[0]) && is_regular(t[1]) && is_regular(t[2]))
      ++found.first, found.second = std::min(found.second, shape(x.row(t[0]), x.row(t[1]), x.row(t[2])));
  return found;
}

}  // namespace

TEST_CASE("triangles of a shape of 0.7 and more become lattices", "[thresholds]") {
  double least = 1;
  for (int edges : {1, 3, 5, 7})
    least = std::min(least, lattices_of(triangulate(graded(edges), 4 * coarse_resolution, flat)).second);
  CHECK(least >= lattice_shape);
  CHECK(least < lattice_shape + 0.1);
}

TEST_CASE("a point lies on an edge of a plane domain to rounding of its angle", "[thresholds]") {
  const Values rim = (Values(4, 2) << 0, 0, 1, 0, 1, 1, 0, 1).finished();
  // 1 + cos is 8 h^2 at the height h over the middle of an edge of length 1
  const double height = std::sqrt(1e-14 / 8);
  for (const double share : {0.9, 1.1}) {
    const AttributeWeights weights(rim, (Values(1, 2) << 0.5, share * height).finished());
    std::vector<Index> ends(weights.terms());
    std::vector<double> terms(weights.terms());
    weights.row(0, ends.data(), terms.data());
    CHECK(std::count(terms.begin(), terms.end(), 0.0) == (share < 1 ? 6 : 0));
    CHECK(terms[0] == Approx(0.5).epsilon(1e-6));
  }
}

namespace {

/// So distorted that edges stay too long however often they are split.
class Crumpled final : public Surface {
public:
  void evaluate(const double* b, Index n, int, double* out) const override {  // positions only
    for (Index k = 0; k < n; ++k, b += 3, out += 3) {
      const double bubble = 27 * b[0] * b[1] * b[2];
      out[0] = b[1] + 0.5 * b[2], out[1] = std::sqrt(0.75) * b[2];
      out[2] = 1e4 * bubble * std::sin(6000 * b[1]) * std::cos(6000 * b[2]);
    }
  }
};

}  // namespace

TEST_CASE("a crumpled surface gets five triangles to a squared edge of its rim, and twenty times what a resolution asks for",
          "[thresholds]") {
  const Parameters rim = graded(6, 1, 7);  // 20 edges
  const double by_rim = static_cast<double>(triangulate(rim, {}, Crumpled()).triangles.size()),
               by_resolution = static_cast<double>(triangulate(rim, 4, Crumpled()).triangles.size());
  CHECK(by_rim <= 5 * 20 * 20);
  CHECK(by_rim > 0.9 * 5 * 20 * 20);
  CHECK(by_resolution <= 20 * (2 * 4 * 4 + 20));
  CHECK(by_resolution > 0.9 * 20 * (2 * 4 * 4 + 20));
}
