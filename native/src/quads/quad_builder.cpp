#include "tripatch/quads/quad_builder.h"

#include <algorithm>

namespace tripatch {

Path part(const Path& path, Index from, Index to) { return {path.begin() + from, path.begin() + to + 1}; }

Path backwards(Path path) {
  std::reverse(path.begin(), path.end());
  return path;
}

std::vector<Index> spokes_of(const std::vector<Index>& counts) {
  // rounds in steps of two: two spokes a step apart sum to the count between them, so all are sums of counts plus or minus the first
  const Index k = static_cast<Index>(counts.size()), length = k % 2 == 1 ? k : k / 2;
  std::vector<Index> spokes(k, -1);
  for (Index start = 0; start < k / length; ++start) {
    std::vector<Index> rest = {0};
    for (Index m = 0; m < length; ++m) rest.push_back(counts[(start + 2 * m + 1) % k] - rest.back());
    Index first = 0;
    if (length % 2 == 1) {
      if (rest.back() % 2 != 0) return {};
      first = rest.back() / 2;
    } else {  // of a round of even length the first is free, if the counts fit at all: all as long as can be
      if (rest.back() != 0) return {};
      Index low = 0, high = rest[1];
      for (Index m = 0; m < length; ++m) {
        if (m % 2 == 0) low = std::max(low, -rest[m]);
        if (m % 2 == 1) high = std::min(high, rest[m]);
      }
      first = (low + high) / 2;
    }
    for (Index m = 0; m < length; ++m) spokes[(start + 2 * m) % k] = m % 2 == 0 ? rest[m] + first : rest[m] - first;
  }
  if (*std::min_element(spokes.begin(), spokes.end()) < 0 || std::count(spokes.begin(), spokes.end(), 0) > 1) return {};
  return spokes;
}

void QuadBuilder::fill(Loop loop) {
  while (true) {
    int k = 0;
    for (int i = 1; i < 3; ++i)
      if (loop.count(i) > loop.count(k)) k = i;
    const Index n = loop.count(k), ni = loop.count((k + 1) % 3), nj = loop.count((k + 2) % 3), excess = n - ni - nj;
    if (excess < 0) {
      if (excess % 2 != 0) return one_triangle(loop);
      const std::vector<Path> sides = {loop.side[2], loop.side[0], loop.side[1]};
      return about_pole(sides, spokes_of({loop.count(2), loop.count(0), loop.count(1)}));
    }
    // A grid has a straight corner on its long side: right inside, and on the rim where nothing else is possible.
    if (excess == 0 && (!loop.on_rim[k] || n == 2)) return straight_grid(loop, k);
    loop = excess % 2 == 0 && ni == 1 && nj == 1 && loop.on_rim[k] ? ring(loop) : strip_round(loop, k);
  }
}

QuadBuilder::Loop QuadBuilder::ring(const Loop& outer) {
  const std::array<Index, 3> corner = {add(), add(), add()};
  Loop inner;
  for (int k = 0; k < 3; ++k) {
    inner.side[k] = path(corner[(k + 1) % 3], corner[(k + 2) % 3], outer.count(k));
    row(outer.side[k], inner.side[k]);
  }
  return inner;
}

Path QuadBuilder::path(Index a, Index b, Index edges) {
  Path p = {a};
  for (Index k = 1; k < edges; ++k) p.push_back(add());
  p.push_back(b);
  return p;
}

/// Quads between two paths of the same length, `outer` traversed forwards.
void QuadBuilder::row(const Path& outer, const Path& inner) {
  for (std::size_t k = 0; k + 1 < outer.size(); ++k)
    faces.add(std::array<Index, 4>{outer[k], outer[k + 1], inner[k + 1], inner[k]});
}

/// A grid from its four sides: bottom and top from left to right, left and right from bottom to top.
void QuadBuilder::rectangle(const Path& bottom, const Path& right, const Path& top, const Path& left) {
  Path below = bottom;
  for (std::size_t j = 1; j < left.size(); ++j) {
    const Path above = j + 1 == left.size() ? top : path(left[j], right[j], static_cast<Index>(bottom.size()) - 1);
    row(below, above);
    below = above;
  }
}

/// Odd sum: a triangle in the middle, from each of its edges a strip one quad wide to the middle edge of a side, and a grid at
/// each corner. Side i: s_{i+2} edges, the middle edge, s_{i+1} edges.
void QuadBuilder::one_triangle(const Loop& loop) {
  std::array<Index, 3> s;
  for (int i = 0; i < 3; ++i) s[i] = (loop.count((i + 1) % 3) + loop.count((i + 2) % 3) - loop.count(i) - 1) / 2;
  const auto middle = [&](int i) { return s[(i + 2) % 3]; };
  std::array<Index, 3> tip = {-1, -1, -1};  // the triangle's corner nearest to corner k
  for (int i = 0; i < 3; ++i) {
    if (s[i] > 0) continue;  // a strip of length 0: the triangle lies on the rim
    tip[(i + 1) % 3] = loop.side[i][middle(i)];
    tip[(i + 2) % 3] = loop.side[i][middle(i) + 1];
  }
  for (Index& t : tip)
    if (t < 0) t = add();
  std::array<Path, 3> first, second;  // the two edges of the strip, from the side to the triangle
  for (int i = 0; i < 3; ++i) {
    const int before = (i + 2) % 3, after = (i + 1) % 3;
    // where the neighbor's strip has no length, the grid between has none either: its two long sides are one
    first[i] = s[before] == 0 ? backwards(part(loop.side[before], middle(before) + 1, loop.count(before)))
               : s[i] == 0    ? Path{tip[after]}
                              : path(loop.side[i][middle(i)], tip[after], s[i]);
    second[i] = s[after] == 0 ? part(loop.side[after], 0, s[i])
                : s[i] == 0   ? Path{tip[before]}
                              : path(loop.side[i][middle(i) + 1], tip[before], s[i]);
    row(second[i], first[i]);
  }
  faces.add(tip);
  for (int k = 0; k < 3; ++k) {
    const int in = (k + 1) % 3, out = (k + 2) % 3;
    if (s[in] == 0 || s[out] == 0) continue;
    rectangle(part(loop.side[out], 0, s[in]), first[out], second[in],
              backwards(part(loop.side[in], middle(in) + 1, loop.count(in))));
  }
}

/// n_k = n_i + n_j: a grid whose fourth corner lies on side k.
void QuadBuilder::straight_grid(const Loop& loop, int k) {
  const int i = (k + 1) % 3, j = (k + 2) % 3;
  const Path& base = loop.side[k];
  rectangle(part(base, 0, loop.count(i)), part(base, loop.count(i), loop.count(k)), backwards(loop.side[i]),
            backwards(loop.side[j]));
}

/// A row along the two short sides, round the corner k between them; it takes an edge off each end of side k.
QuadBuilder::Loop QuadBuilder::strip_round(const Loop& loop, int k) {
  const int i = (k + 1) % 3, j = (k + 2) % 3;
  const Path& base = loop.side[k];
  const Index apex = add(), n = loop.count(k);
  Loop inner;
  inner.on_rim[k] = loop.on_rim[k];
  inner.side[k] = part(base, 1, n - 1);
  inner.side[i] = path(base[n - 1], apex, loop.count(i));
  inner.side[j] = path(apex, base[1], loop.count(j));
  row(loop.side[i], inner.side[i]);
  row(loop.side[j], inner.side[j]);
  return inner;
}

void QuadBuilder::about_pole(const std::vector<Path>& sides, const std::vector<Index>& spokes) {
  const std::size_t k = sides.size(), on = std::find(spokes.begin(), spokes.end(), 0) - spokes.begin();
  const auto before = [&](std::size_t i) { return (i + k - 1) % k; };
  const Index pole = on < k ? sides[on][spokes[before(on)]] : add();
  std::vector<Path> spoke(k);
  for (std::size_t i = 0; i < k; ++i) {
    if (on < k && i == before(on)) {  // where the pole lies on a side, the spokes of its neighbors run along that
      spoke[i] = part(sides[on], 0, spokes[i]);
    } else if (on < k && i == (on + 1) % k) {
      spoke[i] = backwards(part(sides[on], spokes[before(on)], static_cast<Index>(sides[on].size()) - 1));
    } else {
      spoke[i] = spokes[i] == 0 ? Path{pole} : path(sides[i][spokes[before(i)]], pole, spokes[i]);
    }
  }
  for (std::size_t i = 0; i < k; ++i) {
    if (spokes[i] == 0 || spokes[before(i)] == 0) continue;
    const Path& last = sides[before(i)];
    rectangle(part(sides[i], 0, spokes[before(i)]), spoke[i], spoke[before(i)],
              backwards(part(last, static_cast<Index>(last.size()) - 1 - spokes[i], static_cast<Index>(last.size()) - 1)));
  }
}

void QuadBuilder::grid(const std::vector<Path>& sides) {
  rectangle(sides[0], sides[1], backwards(sides[2]), backwards(sides[3]));
}

std::vector<Path> QuadBuilder::ring(const std::vector<Path>& sides) {
  const std::size_t k = sides.size();
  Path corner;
  for (std::size_t i = 0; i < k; ++i) corner.push_back(add());
  std::vector<Path> inner;
  for (std::size_t i = 0; i < k; ++i) {
    inner.push_back(path(corner[i], corner[(i + 1) % k], static_cast<Index>(sides[i].size()) - 1));
    row(sides[i], inner[i]);
  }
  return inner;
}

}  // namespace tripatch
