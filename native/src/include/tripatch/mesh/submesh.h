// A part of a mesh with numbers of its own, made in time and memory by the part, whatever the size of the mesh.
#pragma once

#include <span>
#include <vector>

#include "tripatch/math/thresholds.h"
#include "tripatch/mesh/connectivity.h"

namespace tripatch {

/// Numbers 0, 1, 2, ... for some of the vertices or faces of a mesh, in the order in which they are added.
class Numbering {
public:
  Numbering() = default;
  /// Of items below `most`: where these are few each has a place of its own, which is found in a third of the time.
  explicit Numbering(Index most) : direct_(most <= max_direct), place_(direct_ ? most : 0, -1) {}

  /// Whether it had no number before.
  bool add(Index item) {
    const std::size_t before = items_.size();
    return number(item) == static_cast<int>(before) && items_.size() > before;
  }
  /// The one that it has from now on.
  int number(Index item) {
    int& place = direct_ ? place_[item] : place_to_add(item);
    if (place < 0) {
      place = static_cast<int>(items_.size());
      items_.push_back(item);
    }
    return place;
  }
  /// -1: none.
  int find(Index item) const {
    if (direct_) return place_[item];
    return place_.empty() ? -1 : place_[slot(item)];
  }
  const std::vector<Index>& items() const { return items_; }
  std::size_t size() const { return items_.size(); }

private:
  static constexpr Index max_direct = count::linear;  ///< to clear as many places takes as long as to hash some hundred items

  int& place_to_add(Index item);
  std::size_t slot(Index item) const;

  bool direct_ = false;
  std::vector<Index> items_;
  /// In items_, -1 where free. By item, or open addressing, its size a power of 2 and twice that of items_ or more.
  std::vector<int> place_;
};

/// Rings around some vertices: faces[0] are those at them, vertices[1] the other vertices of these, and so on; vertices[0] are the
/// given ones. Each in the order in which it is met.
struct Rings {
  std::vector<std::vector<Index>> faces, vertices;
  /// All of them, in the mesh's order.
  std::vector<Index> all_faces() const;
};
Rings rings_around(const Connectivity& mesh, std::span<const Index> vertices, int rings);

/// Some faces of a mesh.
struct Submesh {
  std::vector<Index> face;            ///< of the mesh
  Numbering vertex;                   ///< of the mesh's vertices
  std::vector<int> offsets, corners;  ///< of the faces, by those numbers
  std::vector<int> fan_offsets, fan;  ///< faces at each vertex, by their own numbers, in their order

  std::span<const int> operator[](int f) const {
    return {&corners[offsets[f]], &corners[offsets[f]] + (offsets[f + 1] - offsets[f])};
  }
  std::span<const int> faces_at(int v) const { return {fan.data() + fan_offsets[v], fan.data() + fan_offsets[v + 1]}; }
};
/// vertices: how many the mesh has. first: those that take the first numbers.
Submesh submesh(const FacesRef& faces, Index vertices, std::vector<Index> some, std::span<const Index> first = {});

}  // namespace tripatch
