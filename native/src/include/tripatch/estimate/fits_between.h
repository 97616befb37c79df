// Planes along a long side between those that are fitted, where these tell them as well as fits of their own would.
#pragma once

#include <optional>
#include <vector>

#include "tripatch/estimate/side_draft.h"
#include "tripatch/estimate/vertex_fit.h"

namespace tripatch {

/// Whether a vertex of a side of so many edges can do without a fit of its own: every second, or three of four, but near the ends; the same
/// from both of them.
bool is_between(int vertex, int edges);

/// Of a side with fits at all vertices that are not between others, and these with what lies at them: polynomials of degree 5 through those
/// around it (Lagrange). Halving the distance of what they go through divides what they miss by 64.
class FitsBetween {
public:
  /// Both must outlive it.
  FitsBetween(const SideDraft& side, const std::vector<VertexFit>& fits);
  /// At a vertex between others; nothing where those next to it are not told by what lies around them either.
  std::optional<VertexFit> at(int vertex);

private:
  bool is_told(std::size_t place);

  const SideDraft& side_;
  const std::vector<VertexFit>& fits_;
  std::vector<int> fitted_;                ///< vertices
  std::vector<std::optional<bool>> told_;  ///< of each, once it was asked for
};

}  // namespace tripatch
