#include "tripatch/mesh/face_rows.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <numeric>
#include <optional>
#include <stdexcept>

#include "tripatch/math/box_tree.h"
#include "tripatch/math/interruption.h"
#include "tripatch/math/tolerances.h"

namespace tripatch {
namespace {

/// Rows that are passed over together where none of their vertices is asked for.
constexpr Index portion_rows = 1 << 14;
/// Vertices of a block: 2 to that power.
constexpr int block_bits = 12;
/// A mark of vertices beyond all rings.
constexpr std::uint8_t beyond = 255;

constexpr const char* ends_early = "The file ends within a face";

template <class Kind>
Kind read(const std::byte* at, bool swapped) {
  std::array<std::byte, sizeof(Kind)> bytes;
  std::memcpy(bytes.data(), at, sizeof(Kind));
  if (swapped) std::ranges::reverse(bytes);
  return std::bit_cast<Kind>(bytes);
}

template <class Number>
Number read_as(char kind, const std::byte* at, bool swapped) {
  switch (kind) {
    case 'b': return static_cast<Number>(read<std::int8_t>(at, swapped));
    case 'B': return static_cast<Number>(read<std::uint8_t>(at, swapped));
    case 'h': return static_cast<Number>(read<std::int16_t>(at, swapped));
    case 'H': return static_cast<Number>(read<std::uint16_t>(at, swapped));
    case 'i': return static_cast<Number>(read<std::int32_t>(at, swapped));
    case 'I': return static_cast<Number>(read<std::uint32_t>(at, swapped));
    case 'f': return static_cast<Number>(read<float>(at, swapped));
    default: return static_cast<Number>(read<double>(at, swapped));
  }
}

std::size_t size_of_kind(char kind) {
  return kind == 'b' || kind == 'B' ? 1 : kind == 'h' || kind == 'H' ? 2 : kind == 'd' ? 8 : 4;
}

/// Of a vertex: sums of these cancel where its neighbors do (splitmix64, Steele, Lea and Flood 2014).
std::uint64_t mixed(std::uint64_t v) {
  v += 0x9E3779B97F4A7C15U;
  v = (v ^ (v >> 30U)) * 0xBF58476D1CE4E5B9U;
  v = (v ^ (v >> 27U)) * 0x94D049BB133111EBU;
  return v ^ (v >> 31U);
}

/// A grid over boxes that tells of most places that no box is there.
class Occupied {
public:
  explicit Occupied(const std::vector<BoxTree::Box>& boxes) {
    for (const BoxTree::Box& box : boxes) whole_.extend(box);
    Vec3 mean = Vec3::Zero();
    for (const BoxTree::Box& box : boxes) mean += box.sizes() / static_cast<double>(boxes.size());
    double cell = std::max(mean.maxCoeff() / 2, tolerance::tiny);
    const auto all = [&] { return (whole_.sizes() / cell).array().floor().unaryExpr([](double x) { return x + 1; }).prod(); };
    while (!(all() <= most_cells)) cell *= 2;
    per_unit_ = 1 / cell;
    for (int k = 0; k < 3; ++k) count_[k] = static_cast<Index>(whole_.sizes()[k] * per_unit_) + 1;
    cells_.resize(static_cast<std::size_t>(count_[0] * count_[1] * count_[2]), 0);
    for (const BoxTree::Box& box : boxes)
      each_cell(box, [&](char& taken) {
        taken = 1;
        return false;
      });
  }

  bool may_meet(const BoxTree::Box& box) {
    bool found = false;
    if (whole_.intersects(box)) each_cell(box, [&](char taken) { return found = taken != 0; });
    return found;
  }

private:
  /// Until `use` returns true.
  template <class Use>
  void each_cell(const BoxTree::Box& box, const Use& use) {
    std::array<Index, 3> low, high;
    for (int k = 0; k < 3; ++k) {
      const auto at = [&](double x) {
        return static_cast<Index>(std::clamp((x - whole_.min()[k]) * per_unit_, 0.0, static_cast<double>(count_[k] - 1)));
      };
      low[k] = at(box.min()[k]), high[k] = at(box.max()[k]);
    }
    for (Index x = low[0]; x <= high[0]; ++x)
      for (Index y = low[1]; y <= high[1]; ++y)
        for (Index z = low[2]; z <= high[2]; ++z)
          if (use(cells_[static_cast<std::size_t>((x * count_[1] + y) * count_[2] + z)])) return;
  }

  static constexpr double most_cells = 1 << 24;
  BoxTree::Box whole_;
  double per_unit_ = 1;
  std::array<Index, 3> count_{};
  std::vector<char> cells_;
};

}  // namespace

Vec3 PointRows::operator[](Index v) const {
  const std::byte* const row = data.data() + static_cast<std::size_t>(v) * stride;
  Vec3 p;
  for (int k = 0; k < 3; ++k) p[k] = read_as<double>(kind[k], row + at[k], swapped);
  return p;
}

std::array<Vec3, 2> PointRows::box(Index rows) const {
  BoxTree::Box all;
  for (Index v = 0; v < rows; ++v)
    if (const Vec3 p = (*this)[v]; p.allFinite()) all.extend(p);
  return {all.min(), all.max()};
}

FaceRows::FaceRows(std::span<const std::byte> data, std::size_t first, Index rows, RowLayout layout, Index vertices)
    : data_(data), layout_(std::move(layout)), rows_(rows), vertices_(vertices), starts_{first} {
  if (first > data.size() || rows < 0 || vertices < 0 || vertices >= std::numeric_limits<std::uint32_t>::max() ||
      layout_.corners >= layout_.lists.size())
    throw InvalidArgument("The rows of faces are not in the file");
  look_through();
}

/// The rows of most files: one list, whose number of entries is a byte.
template <class Kind, class Use>
void FaceRows::each_short_row_of(std::size_t portion, const Use& use) const {
  const Index first = static_cast<Index>(portion) * portion_rows, end = std::min(rows_, first + portion_rows);
  const std::byte* const data = data_.data();
  const std::size_t before = layout_.lists[0].before, after = layout_.after, size = data_.size();
  std::array<Index, 256> corners;
  std::size_t at = starts_[portion];
  for (Index f = first; f < end; ++f) {
    const std::size_t list = at + before + 1;
    if (list > size) throw InvalidArgument(ends_early);
    const auto count = std::to_integer<std::size_t>(data[list - 1]);
    const std::size_t next = list + count * sizeof(Kind) + after;
    if (next > size) throw InvalidArgument(ends_early);
    for (std::size_t k = 0; k < count; ++k)
      corners[k] = static_cast<Index>(read<Kind>(data + list + k * sizeof(Kind), layout_.swapped));
    use(at, std::span<const Index>(corners.data(), count), next);
    at = next;
  }
}

/// use: of the byte that a row begins at, its corners (unaligned), their number, and the byte that it ends at.
template <class Kind, class Use>
void FaceRows::each_row_of(std::size_t portion, const Use& use) const {
  if (layout_.lists.size() == 1 && layout_.lists[0].count == 'B') return each_short_row_of<Kind>(portion, use);
  const Index first = static_cast<Index>(portion) * portion_rows, end = std::min(rows_, first + portion_rows);
  const std::byte* const data = data_.data();
  const std::size_t size = data_.size();
  std::size_t at = starts_[portion];
  std::vector<Index> corners;
  for (Index f = first; f < end; ++f) {
    const std::size_t start = at;
    for (std::size_t l = 0; l < layout_.lists.size(); ++l) {
      const RowList& list = layout_.lists[l];
      at += list.before;
      const std::size_t of_count = size_of_kind(list.count);
      if (at + of_count > size) throw InvalidArgument(ends_early);
      const Index count = read_as<Index>(list.count, data + at, layout_.swapped);
      at += of_count;
      if (count < 0 || static_cast<std::size_t>(count) > (size - at) / list.size) throw InvalidArgument(ends_early);
      if (l == layout_.corners) {
        corners.resize(static_cast<std::size_t>(count));
        for (Index k = 0; k < count; ++k)
          corners[static_cast<std::size_t>(k)] =
              static_cast<Index>(read<Kind>(data + at + static_cast<std::size_t>(k) * sizeof(Kind), layout_.swapped));
      }
      at += static_cast<std::size_t>(count) * list.size;
    }
    at += layout_.after;
    if (at > size) throw InvalidArgument(ends_early);
    use(start, std::span<const Index>(corners), at);
  }
}

template <class Use>
void FaceRows::each_row(std::size_t portion, const Use& use) const {
  switch (layout_.kind) {
    case 'b': return each_row_of<std::int8_t>(portion, use);
    case 'B': return each_row_of<std::uint8_t>(portion, use);
    case 'h': return each_row_of<std::int16_t>(portion, use);
    case 'H': return each_row_of<std::uint16_t>(portion, use);
    case 'i': return each_row_of<std::int32_t>(portion, use);
    default: return each_row_of<std::uint32_t>(portion, use);
  }
}

/// An edge of two faces adds its end to the sum of its beginning once, and takes it away once; that of one face leaves it there.
void FaceRows::look_through() {
  std::vector<std::uint64_t> sums(static_cast<std::size_t>(vertices_), 0);
  std::vector<std::uint64_t> mix;
  for (Index done = 0; done < rows_; done += portion_rows) {
    check_interruption();
    std::size_t at = starts_.back();
    std::array<Index, 2> range = {vertices_, -1};
    each_row(starts_.size() - 1, [&](std::size_t, std::span<const Index> face, std::size_t end) {
      at = end;
      if (face.size() < 3) return;
      const std::size_t n = face.size();
      mix.resize(n);
      for (std::size_t k = 0; k < n; ++k) {
        const Index v = face[k];
        if (v < 0 || v >= vertices_) throw std::out_of_range(std::to_string(faces_));
        range = {std::min(range[0], v), std::max(range[1], v)};
        mix[k] = mixed(static_cast<std::uint64_t>(v));
      }
      ++faces_;
      for (std::size_t k = 0; k < n; ++k)
        sums[static_cast<std::size_t>(face[k])] += mix[k + 1 < n ? k + 1 : 0] - mix[k > 0 ? k - 1 : n - 1];
    });
    starts_.push_back(at);
    range_.push_back(range);
  }
  end_ = starts_.back();
  for (Index v = 0; v < vertices_; ++v)
    if (sums[static_cast<std::size_t>(v)] != 0) at_borders_.push_back(v);
  sums = {};
  marks_.resize(static_cast<std::size_t>(vertices_), 0);
  blocks_.resize((static_cast<std::size_t>(vertices_) >> block_bits) + 1, 0);
  number_ = std::make_unique_for_overwrite<std::uint32_t[]>(static_cast<std::size_t>(vertices_));
}

void FaceRows::mark(Index v, std::uint8_t value) {
  marks_[static_cast<std::size_t>(v)] = value;
  blocks_[static_cast<std::size_t>(v) >> block_bits] = 1;
}

bool FaceRows::may_touch(std::size_t portion) const {
  const auto [low, high] = range_[portion];
  if (high < 0) return false;
  const auto first = blocks_.begin() + (low >> block_bits), end = blocks_.begin() + (high >> block_bits) + 1;
  return std::find(first, end, 1) != end;
}

void FaceRows::take_rings(int rings, std::vector<std::size_t>& taken) {
  for (int ring = 1; ring <= rings; ++ring)
    for (std::size_t p = 0; p < portions(); ++p) {
      if (!may_touch(p)) continue;
      check_interruption();
      each_row(p, [&](std::size_t start, std::span<const Index> face, std::size_t) {
        // a mark less one: those without have the highest
        const bool touches = face.size() > 2 && std::ranges::any_of(face, [&](Index v) {
                               return static_cast<std::uint8_t>(marks_[static_cast<std::size_t>(v)] - 1) < ring;
                             });
        if (!touches) return;
        if (ring == rings) taken.push_back(start);
        for (Index v : face)
          if (marks_[static_cast<std::size_t>(v)] == 0) mark(v, static_cast<std::uint8_t>(ring + 1));
      });
    }
}

/// Those that have a mark, which they lose.
void FaceRows::take_vertices(int rings, FacePart& part) {
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    if (!blocks_[b]) continue;
    blocks_[b] = 0;
    const std::size_t end = std::min((b + 1) << block_bits, marks_.size());
    for (std::size_t v = b << block_bits; v < end; ++v) {
      if (!marks_[v]) continue;
      number_[v] = static_cast<std::uint32_t>(part.vertices.size());
      part.vertices.push_back(static_cast<Index>(v));
      part.known.push_back(static_cast<char>(marks_[v] <= rings));
      marks_[v] = 0;
    }
  }
}

/// Of one row at each start: the portions are walked as far as needed.
void FaceRows::copy_rows(FacePart& part) const {
  std::size_t next = 0;
  const std::size_t size = size_of_kind(layout_.kind);
  for (std::size_t p = 0; p < portions() && next < part.starts.size(); ++p) {
    if (part.starts[next] >= starts_[p + 1]) continue;
    each_row(p, [&](std::size_t start, std::span<const Index> face, std::size_t end) {
      if (next >= part.starts.size() || part.starts[next] != start) return;
      ++next;
      const std::size_t row = part.rows.size();
      part.rows.append(reinterpret_cast<const char*>(data_.data() + start), end - start);
      std::size_t at = 0;
      for (std::size_t l = 0; l <= layout_.corners; ++l) {
        const RowList& list = layout_.lists[l];
        at += list.before;
        const auto count = read_as<std::size_t>(list.count, data_.data() + start + at, layout_.swapped);
        at += size_of_kind(list.count);
        if (l < layout_.corners) at += count * list.size;
      }
      for (std::size_t k = 0; k < face.size(); ++k) {
        const std::uint32_t v = number_[static_cast<std::size_t>(face[k])];
        for (std::size_t byte = 0; byte < size; ++byte) {
          const std::size_t shift =
              8 * (layout_.swapped == (std::endian::native == std::endian::little) ? size - 1 - byte : byte);
          part.rows[row + at + k * size + byte] = static_cast<char>(v >> shift & 255U);
        }
      }
    });
  }
}

FacePart FaceRows::around(std::span<const Index> vertices, int rings, std::span<const std::size_t> more) {
  FacePart part;
  for (Index v : vertices) mark(v, 1);
  take_rings(rings, part.starts);
  std::vector<std::size_t> others(more.begin(), more.end());
  std::ranges::sort(others);
  std::size_t next = 0;
  for (std::size_t p = 0; p < portions() && next < others.size(); ++p) {
    if (others[next] >= starts_[p + 1]) continue;
    each_row(p, [&](std::size_t start, std::span<const Index> face, std::size_t) {
      if (next >= others.size() || others[next] != start) return;
      while (next < others.size() && others[next] == start) ++next;
      for (Index v : face)
        if (marks_[static_cast<std::size_t>(v)] == 0) mark(v, beyond);
    });
  }
  part.starts.insert(part.starts.end(), others.begin(), others.end());
  std::ranges::sort(part.starts);
  part.starts.erase(std::ranges::unique(part.starts).begin(), part.starts.end());
  take_vertices(rings, part);
  copy_rows(part);
  return part;
}

std::vector<Index> FaceRows::connected(std::span<const Index> asked, std::span<const Index> without) const {
  std::vector<std::uint32_t> root(static_cast<std::size_t>(vertices_));
  std::iota(root.begin(), root.end(), 0U);
  std::vector<bool> is_out(root.size(), false);
  for (Index v : without) is_out[static_cast<std::size_t>(v)] = true;
  const auto found = [&](std::uint32_t v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  for (std::size_t p = 0; p < portions(); ++p) {
    check_interruption();
    each_row(p, [&](std::size_t, std::span<const Index> face, std::size_t) {
      if (face.size() < 3) return;
      std::optional<std::uint32_t> before;
      for (Index v : face) {
        if (is_out[static_cast<std::size_t>(v)]) continue;
        const std::uint32_t own = found(static_cast<std::uint32_t>(v));
        if (before && own != *before) root[std::max(own, *before)] = std::min(own, *before);
        before = before ? std::min(own, *before) : own;
      }
    });
  }
  std::vector<Index> out;
  for (Index v : asked) out.push_back(static_cast<Index>(found(static_cast<std::uint32_t>(v))));
  return out;
}

template <class Use>
void FaceRows::each_meeting(const PointRows& points, const Eigen::Ref<const Eigen::MatrixXd>& boxes, const Use& use) const {
  std::vector<BoxTree::Box> all;
  for (Index k = 0; k < boxes.rows(); ++k)
    all.emplace_back(Vec3(boxes.row(k).head<3>().transpose()), Vec3(boxes.row(k).tail<3>().transpose()));
  if (all.empty()) return;
  Occupied occupied(all);
  const BoxTree tree(std::move(all));
  for (std::size_t p = 0; p < portions(); ++p) {
    check_interruption();
    each_row(p, [&](std::size_t start, std::span<const Index> face, std::size_t) {
      if (face.size() < 3) return;
      BoxTree::Box box;
      for (Index v : face) box.extend(points[v]);
      if (occupied.may_meet(box)) tree.each_meeting(box, [&](std::size_t k) { use(start, static_cast<Index>(k)); });
    });
  }
}

std::vector<Index> FaceRows::count_meeting(const PointRows& points, const Eigen::Ref<const Eigen::MatrixXd>& boxes) const {
  std::vector<Index> count(static_cast<std::size_t>(boxes.rows()), 0);
  each_meeting(points, boxes, [&](std::size_t, Index k) { ++count[static_cast<std::size_t>(k)]; });
  return count;
}

std::vector<std::pair<std::size_t, Index>> FaceRows::meeting(const PointRows& points,
                                                             const Eigen::Ref<const Eigen::MatrixXd>& boxes) const {
  std::vector<std::pair<std::size_t, Index>> found;
  each_meeting(points, boxes, [&](std::size_t start, Index k) { found.emplace_back(start, k); });
  return found;
}

std::string FaceRows::widened(std::size_t portion, std::size_t by) const {
  std::string out;
  const Index first = static_cast<Index>(portion) * portion_rows;
  out.reserve(starts_[portion + 1] - starts_[portion] + by * static_cast<std::size_t>(std::min(portion_rows, rows_ - first)));
  each_row(portion, [&](std::size_t start, std::span<const Index>, std::size_t end) {
    out.append(reinterpret_cast<const char*>(data_.data() + start), end - start);
    out.append(by, '\0');
  });
  return out;
}

}  // namespace tripatch
