#include "tripatch/grid/mixed_differences.h"

#include <optional>

namespace tripatch {
namespace {

/// A corner that a block of quads begins at, seen with its edges to the right and upwards.
using Corner = Connectivity::Corner;

/// Corners of the faces at a vertex, if these are four quads all around it.
std::span<const Corner> all_quads_at(const Connectivity& mesh, Index v) {
  const std::span<const Corner> at = mesh.at(v);
  if (at.size() != 4) return {};
  for (const Corner c : at)
    if (mesh.faces()[mesh.face(c)].size() != 4 || !mesh.edge(mesh.next(c), v)) return {};
  return at;
}

/// A corner's face and the one that many edges on.
Corner turned(const Connectivity& mesh, Corner c, Index edges) {
  const Index first = mesh.faces().offsets[mesh.face(c)];
  return static_cast<Corner>(first + (mesh.place(c) + edges) % 4);
}

std::optional<Corner> to_the_right(const Connectivity& mesh, Corner c) {
  const Corner low = turned(mesh, c, 1), high = turned(mesh, c, 2);
  const std::optional<Corner> beyond = mesh.edge(mesh.faces().corners[high], mesh.faces().corners[low]);
  if (!beyond || mesh.faces()[mesh.face(*beyond)].size() != 4) return {};
  return turned(mesh, *beyond, 1);
}

std::optional<Corner> upwards(const Connectivity& mesh, Corner c) {
  const Corner right = turned(mesh, c, 2), left = turned(mesh, c, 3);
  const std::optional<Corner> beyond = mesh.edge(mesh.faces().corners[left], mesh.faces().corners[right]);
  if (!beyond || mesh.faces()[mesh.face(*beyond)].size() != 4) return {};
  return *beyond;
}

/// Over the block of order x order quads to the right of a corner and above it.
class Block {
public:
  Block(const Connectivity& mesh, int order) : mesh_(mesh), order_(order) {}

  /// Whether there is such a block.
  bool walk(Corner from) {
    for (std::vector<Index>& row : at_) row.assign(max_difference_order + 1, -1);
    Corner first = from;
    for (int row = 0; row < order_; ++row) {
      Corner now = first;
      for (int column = 0; column < order_; ++column) {
        if (!put(now, row, column)) return false;
        if (column + 1 == order_) break;
        const std::optional<Corner> next = to_the_right(mesh_, now);
        if (!next) return false;
        now = *next;
      }
      if (row + 1 == order_) break;
      const std::optional<Corner> above = upwards(mesh_, first);
      if (!above) return false;
      first = *above;
    }
    return inner_vertices_are_regular();
  }

  Difference difference() const {
    Difference made;
    for (int row = 0; row <= order_; ++row)
      for (int column = 0; column <= order_; ++column)
        made.emplace_back(at_[row][column], difference_weights[order_ - 1][row] * difference_weights[order_ - 1][column]);
    return made;
  }

private:
  /// False where another vertex is there.
  bool put(Corner c, int row, int column) {
    constexpr std::array<std::array<int, 2>, 4> steps = {{{0, 0}, {0, 1}, {1, 1}, {1, 0}}};
    for (Index k = 0; k < 4; ++k) {
      Index& at = at_[row + steps[k][0]][column + steps[k][1]];
      const Index vertex = mesh_.faces().corners[turned(mesh_, c, k)];
      if (at >= 0 && at != vertex) return false;
      at = vertex;
    }
    return true;
  }
  bool inner_vertices_are_regular() const {
    for (int row = 1; row < order_; ++row)
      for (int column = 1; column < order_; ++column)
        if (all_quads_at(mesh_, at_[row][column]).empty()) return false;
    return true;
  }

  const Connectivity& mesh_;
  int order_;
  std::array<std::vector<Index>, max_difference_order + 1> at_;
};

/// Corners that blocks of an order begin at, each block once.
std::vector<Corner> beginnings(const Connectivity& mesh, int order) {
  std::vector<Corner> from;
  if (order == 2) {  // around a vertex
    for (Index v = 0; v < mesh.vertices(); ++v)
      if (const auto at = all_quads_at(mesh, v); !at.empty()) from.push_back(turned(mesh, at[0], 2));
    return from;
  }
  for (Index f = 0; f < mesh.faces().size(); ++f) {
    if (mesh.faces()[f].size() != 4) continue;
    const Corner first = static_cast<Corner>(mesh.faces().offsets[f]);
    if (order == 1) {
      from.push_back(first);
      continue;
    }
    for (const Corner c :
         all_quads_at(mesh, mesh.faces().corners[first])) {  // around a quad: the one that it shares this vertex only with
      const bool shares_edge = mesh.next(c) == mesh.previous(first) || mesh.previous(c) == mesh.next(first);
      if (mesh.face(c) != f && !shares_edge) from.push_back(turned(mesh, c, 2));
    }
  }
  return from;
}

}  // namespace

std::vector<Difference> mixed_differences(const Connectivity& mesh, int order) {
  std::vector<Difference> made;
  Block block(mesh, order);
  for (const Corner from : beginnings(mesh, order))
    if (block.walk(from)) made.push_back(block.difference());
  return made;
}

}  // namespace tripatch
