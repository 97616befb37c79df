// What scripts/instructions counts: hot_paths NAME runs one path once, on one thread and warm; without a name their names are printed.
// Only what `measured` does is counted.
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <numbers>
#include <string>

#include "tripatch/boundary/mesh_sides.h"
#include "tripatch/fill.h"
#include "tripatch/math/parallel.h"
#include "tripatch/mesh/border_loops.h"
#include "tripatch/triangulation/min_weight_triangulation.h"

using namespace tripatch;

namespace {

/// A height field of squares, two triangles each, with a right-angled triangular hole of 3 times `side` edges in its middle.
struct Waves {
  Points vertices;
  Faces faces;
  std::vector<Index> rim;

  Waves(Index cells, Index side) : vertices((cells + 1) * (cells + 1), 3) {
    const Index n = cells + 1, start = (cells - side) / 2;
    for (Index y = 0; y < n; ++y)
      for (Index x = 0; x < n; ++x)
        vertices.row(y * n + x) << static_cast<double>(x), static_cast<double>(y),
            3 * std::sin(2 * std::numbers::pi / 50 * static_cast<double>(x)) *
                std::cos(2 * std::numbers::pi / 50 * static_cast<double>(y));
    for (Index y = 0; y < cells; ++y)
      for (Index x = 0; x < cells; ++x) {
        const Index a = y * n + x, r = y - start, c = x - start;
        const bool near = r >= 0 && c >= 0;
        const auto add = [&](Index p, Index q, Index s) { faces.add(std::array{p, q, s}); };
        if (!near || r + c >= side) add(a, a + 1, a + n);
        if (!near || r + c + 1 >= side) add(a + 1, a + n + 1, a + n);
      }
    const Index corner = start * n + start;
    for (Index k = 0; k < side; ++k) rim.push_back(corner + k);
    for (Index k = 0; k < side; ++k) rim.push_back(corner + side - k + k * n);
    for (Index k = 0; k < side; ++k) rim.push_back(corner + (side - k) * n);
  }
  Mesh mesh() const { return {vertices, faces}; }
};

const Waves& waves() {
  static const Waves some(60, 32);
  return some;
}

const Connectivity& around() {
  static const Connectivity all(waves().mesh());
  return all;
}

Fill filled(std::optional<Fairing> fairing, const std::string& method = "auto") {
  FillOptions options;
  options.rim = waves().rim;
  options.fairing = fairing;
  options.method = method;
  return fill(waves().mesh(), options);
}

void spline() {
  FillOptions options;
  options.rim = waves().rim;
  options.method = "polyharmonic_spline";
  fill(waves().mesh(), options);
}

/// As meshes made by programs have them by the thousand.
void small_hole() {
  static const Waves some(20, 2);
  FillOptions options;
  options.rim = some.rim;
  fill(some.mesh(), options);
}

/// Of a rim so rough that no surface over it serves: all ways are tried, and plain triangles remain.
void slow_fill() {
  static const Waves rough = [] {
    Waves waves(40, 24);
    for (std::size_t k = 0; k < waves.rim.size(); ++k)
      waves.vertices(waves.rim[k], 2) += 6 * std::sin(7919.0 * static_cast<double>(k * k));
    return waves;
  }();
  FillOptions options;
  options.rim = rough.rim;
  fill(rough.mesh(), options);
}

void normals() {
  static const SurfacePtr patch = filled(Fairing::automatic, "side_vertex").patch;
  constexpr Index rows = 140;  // of a grid of some 10,000 points
  Points b((rows + 1) * (rows + 2) / 2, 3);
  Index k = 0;
  for (Index q = 0; q <= rows; ++q)
    for (Index p = 0; p + q <= rows; ++p)
      b.row(k++) << static_cast<double>(rows - p - q), static_cast<double>(p), static_cast<double>(q);
  patch->normals(b / static_cast<double>(rows));
}

void borders() {
  static const Waves many(200, 12);
  border_loops(Connectivity(many.mesh()));
}

/// Of a waving, jagged rim of 10,000 vertices: by parts, for the work to grow little faster than the rim. Each time of another size, for the
/// last results are kept.
void roughly() {
  constexpr Index edges = 10'000;
  static double size = 50;
  size *= 2;
  Points rim(edges, 3);
  for (Index k = 0; k < edges; ++k) {
    const double turn = 2 * std::numbers::pi * static_cast<double>(k) / edges,
                 out = 1 + 1e-4 * static_cast<double>(k * k % 7919) / 7919;
    rim.row(k) << size * out * std::cos(turn), size * out * std::sin(turn), size / 5 * std::sin(3 * turn);
  }
  min_weight_triangulation(rim);
}

const std::map<std::string, std::function<void()>> paths = {
    {"surroundings", [] { mesh_sides(waves().mesh(), around(), make_hole(waves().mesh(), around(), waves().rim, {})); }},
    {"fill without fairing", [] { filled({}); }},
    {"fill", [] { filled(Fairing::automatic); }},
    {"spline", spline},
    {"small hole", small_hole},
    {"slow fill", slow_fill},
    {"normals", normals},
    {"borders", borders},
    {"rough fill", roughly}};

}  // namespace

/// What callgrind counts.
extern "C" [[gnu::noinline]] void measured(const std::function<void()>& path) { path(); }

int main(int argc, char** argv) {
  const SerialScope no_threads;
  if (argc < 2) {
    for (const auto& [name, path] : paths) std::puts(name.c_str());
    return 0;
  }
  const std::function<void()>& path = paths.at(argv[1]);
  path();  // what is made once is made
  measured(path);
}
