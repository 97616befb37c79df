// Basic types that pass between the rooms: points, meshes by index, refusals.
#pragma once

#include <Eigen/Core>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <ranges>
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

/// Vertex indices that somebody else owns, of 64 bits or of 32.
class IndicesRef {
public:
  class Iterator {
  public:
    // NOLINTBEGIN(readability-identifier-naming): the standard library's
    using value_type = Index;
    using difference_type = std::ptrdiff_t;
    using reference = Index;
    using pointer = void;
    using iterator_category = std::random_access_iterator_tag;
    // NOLINTEND(readability-identifier-naming)
    Iterator() = default;
    Iterator(const void* data, bool is_short, std::ptrdiff_t at) : data_(data), is_short_(is_short), at_(at) {}
    Index operator*() const { return (*this)[0]; }
    Index operator[](std::ptrdiff_t k) const {
      return is_short_ ? static_cast<const std::int32_t*>(data_)[at_ + k] : static_cast<const Index*>(data_)[at_ + k];
    }
    Iterator& operator+=(std::ptrdiff_t by) { return at_ += by, *this; }
    Iterator& operator-=(std::ptrdiff_t by) { return at_ -= by, *this; }
    Iterator& operator++() { return *this += 1; }
    Iterator& operator--() { return *this -= 1; }
    Iterator operator++(int) { return std::exchange(*this, *this + 1); }
    Iterator operator--(int) { return std::exchange(*this, *this - 1); }
    friend Iterator operator+(Iterator it, std::ptrdiff_t by) { return it += by; }
    friend Iterator operator+(std::ptrdiff_t by, Iterator it) { return it += by; }
    friend Iterator operator-(Iterator it, std::ptrdiff_t by) { return it -= by; }
    friend std::ptrdiff_t operator-(const Iterator& a, const Iterator& b) { return a.at_ - b.at_; }
    bool operator==(const Iterator& other) const { return at_ == other.at_; }
    auto operator<=>(const Iterator& other) const { return at_ <=> other.at_; }

  private:
    const void* data_ = nullptr;
    bool is_short_ = false;
    std::ptrdiff_t at_ = 0;
  };

  IndicesRef() = default;
  // NOLINTBEGIN(google-explicit-constructor): as of a vector to a span
  IndicesRef(std::span<const Index> indices) : data_(indices.data()), size_(indices.size()) {}
  IndicesRef(std::span<const std::int32_t> indices) : data_(indices.data()), size_(indices.size()), is_short_(true) {}
  IndicesRef(const std::vector<Index>& indices) : IndicesRef(std::span(indices)) {}
  IndicesRef(const std::vector<std::int32_t>& indices) : IndicesRef(std::span(indices)) {}
  // NOLINTEND(google-explicit-constructor)

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  Iterator begin() const { return {data_, is_short_, 0}; }
  Iterator end() const { return begin() + static_cast<std::ptrdiff_t>(size_); }
  Index operator[](std::size_t k) const { return begin()[static_cast<std::ptrdiff_t>(k)]; }
  Index front() const { return (*this)[0]; }
  Index back() const { return (*this)[size_ - 1]; }
  /// use(span of the indices as they are).
  template <class Use>
  decltype(auto) visit(const Use& use) const {
    return is_short_ ? use(std::span(static_cast<const std::int32_t*>(data_), size_))
                     : use(std::span(static_cast<const Index*>(data_), size_));
  }
  IndicesRef subspan(std::size_t first, std::size_t count) const {
    return visit([&](auto indices) { return IndicesRef(indices.subspan(first, count)); });
  }

private:
  const void* data_ = nullptr;
  std::size_t size_ = 0;
  bool is_short_ = false;
};

}  // namespace tripatch

/// @cond
template <>
inline constexpr bool std::ranges::enable_borrowed_range<tripatch::IndicesRef> = true;
/// @endcond

namespace tripatch {

/// Faces of any size by vertex index, in arrays that somebody else owns: face f has corners[offsets[f]] .. corners[offsets[f + 1] - 1].
struct FacesRef {
  std::span<const Index> offsets;
  IndicesRef corners;

  Index size() const { return static_cast<Index>(offsets.size()) - 1; }
  IndicesRef operator[](Index f) const {
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
  std::span<const Index> operator[](Index f) const {
    return {corners.data() + offsets[f], static_cast<std::size_t>(offsets[f + 1] - offsets[f])};
  }
  template <class Indices>
  void add(const Indices& face) {
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
