// The holes of a mesh whose borders lie on each other, and how their fills come back to its own vertices.
#pragma once

#include <array>
#include <map>
#include <vector>

#include "tripatch/mesh/connectivity.h"

namespace tripatch {

struct Border;
struct Fill;
struct HoleChoice;
struct Holes;

/// Faces whose vertices stand for all at their places, with the vertices that these faces had themselves.
class JoinedMesh {
public:
  /// own: the corners of the faces before; stands: for each vertex the one that stands for it.
  JoinedMesh(Faces faces, const std::vector<Index>& own, std::vector<Index> stands);

  const Faces& faces() const { return faces_; }
  std::vector<Index> in_mesh(const std::vector<Index>& loop) const;
  /// To the mesh's own vertices: at the rim those of the faces next to it. Vertices move with all at their places.
  void bring_back(Fill& fill) const;

private:
  using Edge = std::array<Index, 2>;
  using EdgeMap = std::map<Edge, Edge>;
  void bring_edges_back(std::vector<Edge>& edges) const;

  Faces faces_;
  std::vector<Index> stands_;
  EdgeMap own_;  // of edges of faces with vertices that stand for others, as a new face runs
};

/// As find_all_holes does, of faces that are joined already. unclosed: as of border_loops.
Holes holes_among(const std::vector<Border>& borders, const std::vector<std::vector<Index>>& unclosed, const Mesh& mesh,
                  const Connectivity& around, const HoleChoice& choice, bool islands);

}  // namespace tripatch
