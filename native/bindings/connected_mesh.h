// A mesh of Python's arrays, for several questions.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "arrays.h"
#include "tripatch/hole/outer_borders.h"
#include "tripatch/mesh/border_loops.h"
#include "tripatch/mesh/connectivity.h"

/// A mesh in arrays of Python, with what is found of it once for several questions.
class ConnectedMesh {
public:
  ConnectedMesh(Array vertices, IndexArray offsets, py::array corners)
      : vertices_(std::move(vertices)),
        offsets_(std::move(offsets)),
        corners_(std::move(corners)),
        mesh_{rows_of(vertices_), faces_from(offsets_, corners_)},
        around_(mesh_) {}

  const tripatch::Mesh& mesh() const { return mesh_; }
  const tripatch::Connectivity& around() const { return around_; }
  const std::vector<std::vector<tripatch::Index>>& loops() {
    if (!loops_) loops_ = tripatch::border_loops(around_, &unclosed_);
    return *loops_;
  }
  /// The chains of border edges that close to no loop.
  const std::vector<std::vector<tripatch::Index>>& unclosed() {
    loops();
    return unclosed_;
  }
  const std::vector<tripatch::Border>& borders() {
    if (!borders_) borders_ = tripatch::borders_of(mesh_, around_, loops());
    return *borders_;
  }

private:
  Array vertices_;
  IndexArray offsets_;
  py::array corners_;
  tripatch::Mesh mesh_;
  tripatch::Connectivity around_;
  std::optional<std::vector<std::vector<tripatch::Index>>> loops_;
  std::vector<std::vector<tripatch::Index>> unclosed_;
  std::optional<std::vector<tripatch::Border>> borders_;
};
