// Connectivity of all-quad layouts, piece by piece: grids, rings, and pieces about one pole.
#pragma once

#include <array>
#include <vector>

#include "tripatch/types.h"

namespace tripatch {

/// Vertices one after the other along edges.
using Path = std::vector<Index>;
Path part(const Path& path, Index from, Index to);
Path backwards(Path path);

/// Lengths of the spokes of a piece with one pole in its middle, of k sides with these numbers of edges. Side i gets one of s_i
/// edges to the pole, and count_i = s_{i-1} + s_{i+1} (a grid at each corner; Tarini 2022 for k = 3). One of them may be 0: the
/// pole lies on that side. Empty where that has no such solution in integers.
std::vector<Index> spokes_of(const std::vector<Index>& counts);

class QuadBuilder {
public:
  explicit QuadBuilder(Index rim) : next_(rim) {}

  /// A loop of three sides still to be filled: side k is the path of vertices from corner k + 1 to corner k + 2, both included.
  struct Loop {
    std::array<Path, 3> side;
    std::array<bool, 3> on_rim = {false, false, false};
    Index count(int k) const { return static_cast<Index>(side[k].size()) - 1; }
  };

  Faces faces;
  Index vertex_count() const { return next_; }

  /// Three sides of any counts; an odd sum leaves one triangle.
  void fill(Loop loop);
  /// A row of quads along the whole rim; returns the loop inside, of the same counts.
  Loop ring(const Loop& outer);

  // Of any number of sides: side i is the path from corner i to corner i + 1, both included.
  /// From each side a spoke to the pole, spokes[i] edges long, and a grid at each corner.
  void about_pole(const std::vector<Path>& sides, const std::vector<Index>& spokes);
  /// Four sides, opposite ones of the same counts.
  void grid(const std::vector<Path>& sides);
  std::vector<Path> ring(const std::vector<Path>& sides);
  /// New vertices between two.
  Path path(Index a, Index b, Index edges);

private:
  Index add() { return next_++; }
  void row(const Path& outer, const Path& inner);
  void rectangle(const Path& bottom, const Path& right, const Path& top, const Path& left);
  void one_triangle(const Loop& loop);
  void straight_grid(const Loop& loop, int k);
  Loop strip_round(const Loop& loop, int k);

  Index next_;
};

}  // namespace tripatch
