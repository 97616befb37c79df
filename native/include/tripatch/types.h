// Basic types that pass between the rooms: points, meshes by index, refusals.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace tripatch {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Index = std::ptrdiff_t;
/// n points, one a row, in the units of the input.
using Points = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
using PointsRef = Eigen::Ref<const Points>;

/// What cannot be filled, in the user's words, with the place. The mesh is untouched when it is thrown.
class Refusal : public std::runtime_error {
public:
  Refusal(const std::string& reason, std::vector<Index> where = {}) : std::runtime_error(reason), where_(std::move(where)) {}
  /// Vertex indices of the mesh.
  const std::vector<Index>& where() const { return where_; }

private:
  std::vector<Index> where_;
};

/// Wrong shapes, ranges and names: a mistake of the caller (ValueError in Python), not of the mesh.
class InvalidArgument : public std::invalid_argument {
public:
  using std::invalid_argument::invalid_argument;
};

/// Faces of any size by vertex index, in arrays that somebody else owns: face f has corners[offsets[f]] .. corners[offsets[f + 1] - 1].
struct FacesRef {
  std::span<const Index> offsets;
  std::span<const Index> corners;

  Index size() const { return static_cast<Index>(offsets.size()) - 1; }
  std::span<const Index> operator[](Index f) const {
    return corners.subspan(static_cast<std::size_t>(offsets[f]), static_cast<std::size_t>(offsets[f + 1] - offsets[f]));
  }
};

/// The same with arrays of its own.
struct Faces {
  std::vector<Index> offsets = {0};
  std::vector<Index> corners;

  Faces() = default;
  explicit Faces(const FacesRef& faces)
      : offsets(faces.offsets.begin(), faces.offsets.end()), corners(faces.corners.begin(), faces.corners.end()) {}
  operator FacesRef() const { return {offsets, corners}; }  // NOLINT(google-explicit-constructor): as of a vector to a span

  Index size() const { return static_cast<Index>(offsets.size()) - 1; }
  std::span<const Index> operator[](Index f) const { return FacesRef(*this)[f]; }
  void add(std::span<const Index> face) {
    corners.insert(corners.end(), face.begin(), face.end());
    offsets.push_back(static_cast<Index>(corners.size()));
  }
};

/// A mesh that somebody else owns: its vertices (n x 3) and its faces.
struct Mesh {
  PointsRef vertices;
  FacesRef faces;
};

}  // namespace tripatch
