// Which piece each edge of a rim borders inside the hole: that of the face next to it, or another one that has the edge too.
#pragma once

#include <vector>

#include "tripatch/creases/pieces.h"

namespace tripatch {

class RimLabels {
public:
  /// found: the pieces at the rim; the arguments must outlive this.
  RimLabels(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim, const PiecesFound& found);

  /// Planes of two edges of the rim that follow each other, in none of the pieces: of a wall that has no face left. None where they are
  /// many.
  std::vector<SmoothPiece> unseen(double across) const;

  /// For each edge its piece, or pieces.size() + k for lost[k]: as few changes as can be, each where a crease can be seen. Empty: none is
  /// possible, or a piece seems to have lost nothing.
  std::vector<std::size_t> labels(const std::vector<SmoothPiece>& lost) const;

private:
  struct Rows {  // of the rim's vertices
    std::vector<char> in;
    Points normals;
  };
  Rows rows(const SmoothPiece& piece) const;
  double cost(const std::vector<Rows>& all, std::size_t edge, std::size_t piece) const;
  bool may_change(const std::vector<Rows>& all, std::size_t place, std::size_t before, std::size_t here) const;
  bool has_edge_between(Index vertex, std::size_t a, std::size_t b) const;
  bool has_lost_something(const std::vector<Rows>& all, const std::vector<std::size_t>& labels, std::size_t first) const;
  Vec3 at(std::size_t place) const { return points_.row(static_cast<Index>(place % n_)); }

  const Connectivity& around_;
  const std::vector<Index>& rim_;
  const PiecesFound& found_;
  Points points_;
  std::size_t n_;
  std::vector<Rows> seen_;
};

}  // namespace tripatch
