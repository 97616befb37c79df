// Speed of the kernels: points per second of every construction by order of derivatives, triangulation, report.
#include <benchmark/benchmark.h>

#include <cmath>
#include <numbers>

#include "tripatch/constructions/methods.h"
#include "tripatch/fairing/folds.h"
#include "tripatch/output/triangulate.h"
#include "tripatch/report/report.h"

using namespace tripatch;

namespace {

/// A sphere octant: the sides as 100 pieces each, as a mesh gives them.
Sides octant() {
  Sides sides;
  for (int i = 0; i < 3; ++i) {
    const Vec3 a = Vec3::Unit((i + 1) % 3), b = Vec3::Unit((i + 2) % 3), across = -Vec3::Unit(i);
    constexpr int edges = 100;
    std::vector<double> t, points, rays;
    for (int k = 0; k <= edges; ++k) {
      t.push_back(static_cast<double>(k) / edges);
      const Vec3 p = std::cos(t.back() * std::numbers::pi / 2) * a + std::sin(t.back() * std::numbers::pi / 2) * b;
      for (int x = 0; x < 3; ++x) points.push_back(p[x]), rays.push_back(across[x]);
    }
    sides[i].c = PiecewisePolynomial::spline(t, points, 3);
    sides[i].r = PiecewisePolynomial::spline(t, rays, 3);
    sides[i].rim = t;
  }
  return sides;
}

Points grid(Index n) {
  Points b((n + 1) * (n + 2) / 2, 3);
  Index row = 0;
  for (Index q = 0; q <= n; ++q)
    for (Index p = 0; p + q <= n; ++p) b.row(row++) << n - p - q, p, q;
  return b / static_cast<double>(n);
}

void evaluate(benchmark::State& state, const Method& method, int order) {
  const SurfacePtr patch = method.from_boundary(make_boundary(octant()), {});
  const Points b = grid(100);
  std::vector<double> out(static_cast<std::size_t>(b.rows()) * jet_size(order) * 3);
  for (auto _ : state) {
    patch->evaluate(b.data(), b.rows(), order, out.data());
    benchmark::DoNotOptimize(out.data());
  }
  state.SetItemsProcessed(state.iterations() * b.rows());
}

std::vector<double> even(int n) {
  std::vector<double> t;
  for (int k = 0; k <= n; ++k) t.push_back(static_cast<double>(k) / n);
  return t;
}

void triangles(benchmark::State& state, std::array<int, 3> counts, std::optional<int> resolution = {}) {
  const SurfacePtr patch = find_method("side_vertex").from_boundary(make_boundary(octant()), {});
  const std::array<std::vector<double>, 3> parameters = {even(counts[0]), even(counts[1]), even(counts[2])};
  std::size_t made = 0;
  for (auto _ : state) {
    made = triangulate(parameters, resolution, *patch).triangles.size();
    benchmark::DoNotOptimize(made);
  }
  state.SetItemsProcessed(state.iterations() * static_cast<Index>(made));
}

void report(benchmark::State& state) {
  const Sides sides = octant();
  const SurfacePtr patch = find_method("side_vertex").from_boundary(make_boundary(sides), {});
  for (auto _ : state) {
    Report r;
    measure_seam(*patch, sides, r);
    r.folds = count_folds(*patch, sides);
    benchmark::DoNotOptimize(r);
  }
}

const bool registered = [] {
  for (const Method& method : methods())
    if (method.from_boundary)
      for (int order : {0, 1, 2, 3})
        benchmark::RegisterBenchmark((std::string(method.name) + "/order:" + std::to_string(order)).c_str(),
                                     [&method, order](benchmark::State& state) { evaluate(state, method, order); });
  for (const std::array<int, 3>& counts : {std::array<int, 3>{100, 100, 100}, {40, 10, 5}, {100, 99, 100}, {500, 3, 3}})
    benchmark::RegisterBenchmark(
        ("triangulate/" + std::to_string(counts[0]) + "/" + std::to_string(counts[1]) + "/" + std::to_string(counts[2])).c_str(),
        [counts](benchmark::State& state) { triangles(state, counts); });
  for (int resolution : {199, 1000})
    benchmark::RegisterBenchmark(("triangulate/32/32/32/resolution:" + std::to_string(resolution)).c_str(),
                                 [resolution](benchmark::State& state) { triangles(state, {32, 32, 32}, resolution); });
  benchmark::RegisterBenchmark("report", report);
  return true;
}();

}  // namespace
