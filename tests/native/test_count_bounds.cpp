// What counts may be asked for.
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <numbers>

#include "test_refusals.h"
#include "tripatch/fill.h"

using namespace tripatch;

namespace {

/// Rings of quads around a hole of n edges: vertex k of ring j, the rim is ring 0.
struct Rings {
  Points vertices;
  Faces faces;
  std::vector<Index> rim;
  Rings(Index n, Index rings, const std::function<Vec3(double angle, Index ring)>& at) : vertices(n * (rings + 1), 3) {
    for (Index j = 0; j <= rings; ++j)
      for (Index k = 0; k < n; ++k) {
        vertices.row(j * n + k) = at(2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n), j);
        const Index next = (k + 1) % n;
        if (j < rings) faces.add(std::array<Index, 4>{j * n + next, j * n + k, (j + 1) * n + k, (j + 1) * n + next});
        if (j == 0) rim.push_back(k);
      }
  }
  Mesh mesh() const { return {vertices, faces}; }
  Fill filled(const std::function<void(FillOptions&)>& choose = {}) const {
    FillOptions options;
    options.rim = rim;
    if (choose) choose(options);
    return fill(mesh(), options);
  }
};

Vec3 flat(double angle, Index ring) { return Vec3(std::cos(angle), std::sin(angle), 0) * (1 + 0.5 * static_cast<double>(ring)); }

}  // namespace

TEST_CASE("triangles have one edge a side or more, quads a hundred extra rows at most") {
  const Rings hole(6, 2, flat);
  const auto with = [&](Output output, int resolution) {
    return hole.filled([&](FillOptions& options) {
      options.output = output;
      options.resolution = resolution;
    });
  };
  CHECK_THROWS_WITH(with(Output::triangles, 0), "resolution must be from 1 to 10000, not 0");
  CHECK_NOTHROW(with(Output::triangles, 1));
  CHECK_THROWS_WITH(with(Output::quads, 101), "resolution must be from 0 to 100, not 101");
  CHECK_NOTHROW(with(Output::quads, 100));
}
