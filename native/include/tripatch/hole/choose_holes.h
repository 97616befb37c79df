// Which of a mesh's border loops are meant where nobody names them one by one.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "tripatch/messages.h"
#include "tripatch/types.h"

namespace tripatch {

using CountRange = std::array<int, 2>;  ///< least and most, both included

/// Documented in options.def.
struct HoleChoice {
#define HOLES_OPTION(type, name, value, ...) type name = value;
#include "tripatch/options.def"
};

/// The border loops of a mesh that are chosen, shortest first, each as find_holes has it.
std::vector<std::vector<Index>> choose_holes(const Mesh& mesh, const HoleChoice& choice = {});

class JoinedMesh;

/// The holes of a mesh. Where borders lie on each other, vertices within a millionth of the mesh's size count as one: all loops here name the
/// same one of them.
struct Holes {
  std::vector<std::vector<Index>> rims;                  ///< shortest first
  std::vector<std::vector<std::vector<Index>>> islands;  ///< of each rim the borders inside it
  std::vector<std::optional<Message>> refused;           ///< of each rim why it is no hole
  std::vector<std::vector<Index>> outer;                 ///< outer borders that are left open
  std::vector<std::vector<Index>> borders;               ///< all, and the chains of border edges that close to no loop
  std::shared_ptr<const JoinedMesh> joined;              ///< null: no borders lie on each other

  /// One of these loops by the mesh's own vertices: of those at one place that of the edge which starts there.
  std::vector<Index> in_mesh(const std::vector<Index>& loop) const;
};

/// The chosen ones. islands: borders of other parts of the mesh that lie inside a hole belong to it; else each border is a hole.
/// Example: `for (const auto& result : fill_all(mesh, find_all_holes(mesh, {.max_edges = 100})))`.
Holes find_all_holes(const Mesh& mesh, const HoleChoice& choice = {}, bool islands = true);

}  // namespace tripatch
