// The faces of a mesh as rows of bytes in a file, which may be larger than the memory: passes over all of them, one after the other. What is
// kept is a few bytes for each vertex.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "tripatch/types.h"

namespace tripatch {

/// A list in a row: bytes before the number of its entries, the kind of that number (as Python's `struct` names it), bytes of an entry.
struct RowList {
  std::size_t before;
  char count;
  std::size_t size;
};

/// How rows of faces are laid out: lists with numbers before, between and behind them. One of the lists has the corners.
struct RowLayout {
  std::vector<RowList> lists;
  std::size_t after = 0;  ///< bytes behind the last list
  std::size_t corners = 0;
  char kind = 'i';  ///< of a corner: b, B, h, H, i or I
  bool swapped = false;
};

/// Where positions are in rows of one length.
struct PointRows {
  std::span<const std::byte> data;  ///< from the first row on
  std::size_t stride;
  std::array<std::size_t, 3> at;
  std::array<char, 3> kind;
  bool swapped = false;

  Vec3 operator[](Index v) const;
  /// The lowest and the highest coordinates of the first rows, as far as their positions are finite.
  std::array<Vec3, 2> box(Index rows) const;
};

/// A part of the mesh with vertices of its own.
struct FacePart {
  std::vector<Index> vertices;      ///< of the whole mesh, by rising number
  std::vector<char> known;          ///< whether all faces at each are in the part
  std::string rows;                 ///< of its faces, as in the file but for the numbers of their vertices
  std::vector<std::size_t> starts;  ///< where they begin in the file
};

class FaceRows {
public:
  /// Of a mesh of so many vertices. data: of the file, which must outlive it. Throws InvalidArgument where the rows do not fit into it;
  /// std::out_of_range, with the number of the face, where one names a vertex that does not exist.
  FaceRows(std::span<const std::byte> data, std::size_t first, Index rows, RowLayout layout, Index vertices);

  std::size_t end() const { return end_; }
  /// Of three corners and more.
  Index faces() const { return faces_; }
  /// The vertices at which an edge may have one face, by rising number: all of those, and some where faces disagree.
  const std::vector<Index>& at_borders() const { return at_borders_; }

  /// The faces within so many rings around vertices (fewer than 250), and those that begin at some bytes.
  FacePart around(std::span<const Index> vertices, int rings, std::span<const std::size_t> more = {});
  /// For some vertices a number that is the same for those which faces connect through vertices other than `without`.
  std::vector<Index> connected(std::span<const Index> asked, std::span<const Index> without) const;
  /// How many faces meet each of some boxes (rows of lowest and highest coordinates).
  std::vector<Index> count_meeting(const PointRows& points, const Eigen::Ref<const Eigen::MatrixXd>& boxes) const;
  /// Where these faces begin, and the boxes.
  std::vector<std::pair<std::size_t, Index>> meeting(const PointRows& points,
                                                     const Eigen::Ref<const Eigen::MatrixXd>& boxes) const;

  /// Rows are read in so many portions.
  std::size_t portions() const { return starts_.size() - 1; }
  /// The rows of a portion, each with so many bytes of zero behind it.
  std::string widened(std::size_t portion, std::size_t by) const;

private:
  template <class Use>
  void each_row(std::size_t portion, const Use& use) const;
  template <class Kind, class Use>
  void each_row_of(std::size_t portion, const Use& use) const;
  template <class Kind, class Use>
  void each_short_row_of(std::size_t portion, const Use& use) const;
  template <class Use>
  void each_meeting(const PointRows& points, const Eigen::Ref<const Eigen::MatrixXd>& boxes, const Use& use) const;
  void look_through();
  void mark(Index v, std::uint8_t value);
  bool may_touch(std::size_t portion) const;
  void take_rings(int rings, std::vector<std::size_t>& taken);
  void take_vertices(int rings, FacePart& part);
  void copy_rows(FacePart& part) const;

  std::span<const std::byte> data_;
  RowLayout layout_;
  Index rows_, vertices_, faces_ = 0;
  std::size_t end_ = 0;
  std::vector<std::size_t> starts_;          // of each portion, and the end
  std::vector<std::array<Index, 2>> range_;  // of each portion its lowest and highest vertex
  std::vector<Index> at_borders_;
  std::vector<std::uint8_t> marks_, blocks_;  // of each vertex; whether one of a block has a mark
  std::unique_ptr<std::uint32_t[]> number_;   // in a part, of vertices that have a mark
};

}  // namespace tripatch
