#include "tripatch/parametrization/layout_mesh.h"

#include <algorithm>
#include <numeric>
#include <span>

#include "tripatch/math/tolerant_compare.h"

namespace tripatch {
namespace {

using Triangle = LayoutMesh::Triangle;

/// An edge is 3 * triangle + k, from the triangle's corner k to the next.
int next_in_triangle(int edge) { return edge % 3 == 2 ? edge - 2 : edge + 1; }

/// Across edge k of triangle t the other triangle's edge, or -1. False where an edge is no manifold's.
bool find_neighbors(const std::vector<Triangle>& triangles, int count, std::vector<int>& across) {
  across.assign(3 * triangles.size(), -1);
  const auto ends = [&](int edge) { return std::minmax(triangles[edge / 3][edge % 3], triangles[edge / 3][(edge + 1) % 3]); };
  std::vector<int> start(count + 1, 0);  // of the edges of each lower end
  for (int edge = 0; edge < static_cast<int>(across.size()); ++edge) ++start[ends(edge).first + 1];
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<std::array<int, 2>> others(across.size());  // (higher end, edge)
  std::vector<int> next(start.begin(), start.end() - 1);
  for (int edge = 0; edge < static_cast<int>(across.size()); ++edge) {
    const auto [low, high] = ends(edge);
    if (low == high) return false;
    others[next[low]++] = {high, edge};
  }
  for (int low = 0; low < count; ++low) {
    const std::span<std::array<int, 2>> here(others.begin() + start[low], others.begin() + start[low + 1]);
    std::sort(here.begin(), here.end());
    const auto same = [&](std::size_t i, std::size_t j) { return j < here.size() && here[i][0] == here[j][0]; };
    for (std::size_t i = 0; i < here.size(); ++i) {
      if (!same(i, i + 1)) continue;
      const int one = here[i][1], other = here[i + 1][1];
      if (same(i, i + 2) || triangles[one / 3][one % 3] == triangles[other / 3][other % 3]) return false;
      across[one] = other;
      across[other] = one;
      ++i;
    }
  }
  return true;
}

/// Loops of border edges as the triangles traverse them, no vertex twice in one.
std::vector<std::vector<int>> border_loops(const std::vector<Triangle>& triangles, const std::vector<int>& across, int count) {
  std::vector<std::vector<int>> loops;
  std::vector<char> done(across.size(), 0);
  std::vector<int> place(count, -1);
  for (int start = 0; start < static_cast<int>(across.size()); ++start) {
    if (across[start] >= 0 || done[start]) continue;
    std::vector<int> walk;
    for (int h = start; !done[h];) {
      done[h] = 1;
      const int v = triangles[h / 3][h % 3];
      if (place[v] >= 0) {  // a part of the walk is closed
        loops.emplace_back(walk.begin() + place[v], walk.end());
        for (int u : loops.back()) place[u] = -1;
        walk.resize(walk.size() - loops.back().size());
      }
      place[v] = static_cast<int>(walk.size());
      walk.push_back(v);
      h = next_in_triangle(h);
      while (across[h] >= 0) h = next_in_triangle(across[h]);
    }
    for (int u : walk) place[u] = -1;
    loops.push_back(std::move(walk));
  }
  return loops;
}

/// Every vertex has one fan of triangles.
bool fans_are_whole(const std::vector<Triangle>& triangles, const std::vector<int>& across, int count) {
  std::vector<int> corners(count, 0), turned(count, -1);
  for (const Triangle& t : triangles)
    for (int v : t) ++corners[v];
  for (int h = 0; h < static_cast<int>(across.size()); ++h) {
    const int v = triangles[h / 3][h % 3];
    if (turned[v] >= 0) continue;
    int first = h, n = 1;  // back to the border or around
    for (int g = across[first]; g >= 0 && (first = next_in_triangle(g)) != h; g = across[first]) {
    }
    const auto next = [&](int g) { return across[next_in_triangle(next_in_triangle(g))]; };
    for (int g = next(first); g >= 0 && g != first; g = next(g)) ++n;
    turned[v] = n;
    if (n != corners[v]) return false;
  }
  return true;
}

}  // namespace

std::optional<LayoutMesh> make_layout_mesh(const PointsRef& points, const std::vector<std::array<Index, 3>>& triangles) {
  LayoutMesh disc;
  if (triangles.empty()) return std::nullopt;
  std::vector<Triangle> all;
  all.reserve(triangles.size());
  for (const auto& t : triangles) {
    for (Index v : t)
      if (v < 0 || v >= points.rows()) throw InvalidArgument("triangles of rows that the points do not have");
    all.push_back({static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2])});
  }
  std::vector<int> across;
  if (!find_neighbors(all, static_cast<int>(points.rows()), across)) return std::nullopt;
  std::vector<char> reached(all.size(), 0);
  std::vector<int> open = {0};
  reached[0] = 1;
  while (!open.empty()) {
    const int t = open.back();
    open.pop_back();
    for (int k = 0; k < 3; ++k)
      if (const int h = across[3 * t + k]; h >= 0 && !reached[h / 3]) reached[h / 3] = 1, open.push_back(h / 3);
  }
  std::vector<int> number(points.rows(), -1);
  for (std::size_t t = 0; t < all.size(); ++t) {
    if (!reached[t]) continue;
    for (int& v : all[t]) {
      if (number[v] < 0) {
        number[v] = disc.count++;
        disc.vertices.push_back(v);
      }
      v = number[v];
    }
    disc.triangles.push_back(all[t]);
  }
  disc.real = disc.triangles.size();

  if (disc.real < all.size()) find_neighbors(disc.triangles, disc.count, across);
  std::vector<std::vector<int>> loops = border_loops(disc.triangles, across, disc.count);
  if (loops.empty()) return std::nullopt;
  std::size_t outer = 0;
  double longest = -1;
  for (std::size_t l = 0; l < loops.size(); ++l) {
    double length = 0;
    for (std::size_t k = 0; k < loops[l].size(); ++k)
      length += (points.row(disc.vertices[loops[l][k]]) - points.row(disc.vertices[loops[l][(k + 1) % loops[l].size()]])).norm();
    if (clearly_more(length, longest)) longest = length, outer = l;
  }
  for (std::size_t l = 0; l < loops.size(); ++l) {
    if (l == outer) continue;
    if (loops[l].size() < 3) return std::nullopt;
    for (std::size_t k = 0; k < loops[l].size(); ++k)
      disc.triangles.push_back({loops[l][(k + 1) % loops[l].size()], loops[l][k], disc.count});
    ++disc.count;
    disc.filled.push_back(std::move(loops[l]));
  }
  disc.border = std::move(loops[outer]);
  if (!disc.filled.empty() && !find_neighbors(disc.triangles, disc.count, across)) return std::nullopt;
  if (!fans_are_whole(disc.triangles, across, disc.count)) return std::nullopt;
  const auto border_edges = static_cast<std::size_t>(std::count(across.begin(), across.end(), -1));
  const std::size_t edges = (across.size() + border_edges) / 2;
  if (border_edges != disc.border.size() || disc.count + disc.triangles.size() != edges + 1) return std::nullopt;
  return disc;
}

}  // namespace tripatch
