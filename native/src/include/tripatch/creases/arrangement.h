// How the smooth pieces around a hole meet in it: where each continues until it meets others, the hole has creases and corners.
#pragma once

#include <optional>
#include <vector>

#include "tripatch/creases/pieces.h"

namespace tripatch {

/// Corners are numbered: places in the rim, then nodes.
struct Arrangement {
  /// Where two pieces meet.
  class Crease {
  public:
    /// points: along it, both ends included, deviation: of each.
    Crease(Points points, Eigen::VectorXd deviation);
    double length() const { return along_[along_.size() - 1]; }
    /// At shares of the length.
    Points at(const Eigen::VectorXd& shares) const;
    Eigen::VectorXd deviation(const Eigen::VectorXd& shares) const;

    std::array<Index, 2> ends = {-1, -1};  ///< corners

  private:
    Points points_;
    Eigen::VectorXd deviation_, along_;
  };
  /// A step around a part: from a corner to that of the next step.
  struct Step {
    Index corner = 0;
    Index crease = -1;  ///< none: straight, as the rim
    bool reversed = false;
  };
  /// What one piece covers.
  struct Part {
    std::vector<Step> loop;    ///< as new faces traverse it
    std::vector<Index> faces;  ///< of the surroundings, the piece's
  };

  std::vector<Vec3> nodes;  ///< corners inside the hole
  Eigen::VectorXd node_deviation;
  std::vector<Crease> creases;
  std::vector<Part> parts;
};

/// rim: as new faces traverse it, `across` in diameter. Of all ways in which the pieces at the rim can meet in threes that with the least
/// area. None where there is one piece, or no way is free of turned and crossing parts.
std::optional<Arrangement> arrangement_of(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim,
                                          const PiecesFound& found, double across);

}  // namespace tripatch
