// Where the smooth pieces around a hole meet: three in a corner, two along a crease.
#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <vector>

#include "tripatch/creases/pieces.h"

namespace tripatch {

class Meetings {
public:
  /// pieces and rim (its vertices): must outlive this.
  Meetings(const std::vector<SmoothPiece>& pieces, const Points& rim, double across)
      : pieces_(pieces), rim_(rim), across_(across) {}

  /// The corner of three pieces, no farther from the rim than the hole is large.
  std::optional<Vec3> node(std::array<std::size_t, 3> of);

  /// Points along the crease of two pieces between two of its points, both included; none where they do not meet there.
  std::optional<Points> crease(std::size_t a, std::size_t b, const Vec3& from, const Vec3& to) const;

  /// Scene units: points so near to a crease lie on it.
  double within(std::size_t a, std::size_t b) const { return std::max(pieces_[a].tolerance(), pieces_[b].tolerance()); }

  /// Standard deviations of points where pieces meet: these pieces' own, across each; scene units.
  Eigen::VectorXd deviation(const std::vector<std::size_t>& of, const Points& points) const;

private:
  std::optional<Vec3> found_node(const std::array<std::size_t, 3>& of) const;

  const std::vector<SmoothPiece>& pieces_;
  const Points& rim_;
  double across_;
  std::map<std::array<std::size_t, 3>, std::optional<Vec3>> nodes_;
};

}  // namespace tripatch
