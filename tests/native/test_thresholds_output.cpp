// What decides on triangles and weights, on both sides of its thresholds; those of quads are in test_quad_cover and test_pair_quads.
#include <catch2/catch.hpp>
#include <cmath>

#include "tripatch/output/attribute_weights.h"
#include "tripatch/output/domain_mesh.h"
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

TEST_CASE("the regular grid is taken down to triangles of shape 0.1 in the domain", "[thresholds]") {
  double worst_taken = 1, power = 1;
  for (; power < 4; power += 0.05) {  // side 0 is graded more and more, and the grid squeezed
    const TriangleMesh mesh = triangulate(graded(8, power), {}, flat);
    const double worst = worst_shape(mesh, mesh.barycentric);
    if (mesh.triangles.size() != 64) break;  // remeshed: any number
    worst_taken = std::min(worst_taken, worst);
  }
  CHECK(power < 4);
  CHECK(worst_taken >= 0.1);
  CHECK(worst_taken < 0.3);
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
