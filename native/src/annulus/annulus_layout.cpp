#include "tripatch/annulus/annulus_layout.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tripatch/math/thresholds.h"

namespace tripatch {
namespace {

/// How much an even ring counts against straight rows where rows end, and sweeps after which nothing moves by more than a hundredth of an edge: choices.
constexpr double even_ring_counts = share::half;
constexpr int relaxing_sweeps = count::hundreds;

/// The nearest of t + whole turns to another parameter.
double near_to(double t, double other) { return t - std::round(t - other); }

/// A ring of vertices: their rows, and u unwrapped, increasing.
struct Ring {
  std::vector<Index> row;
  std::vector<double> u;
  std::size_t size() const { return row.size(); }
};

/// A ring from where u is least on.
Ring ring_of(std::vector<double> u, Index first_row, bool backwards) {
  const std::size_t n = u.size();
  Ring ring;
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t place = backwards ? n - 1 - k : k;
    ring.row.push_back(first_row + static_cast<Index>(place));
    ring.u.push_back(ring.u.empty() ? u[place] : u[place] + std::ceil(ring.u.back() - u[place]));  // beyond the one before
  }
  return ring;
}

/// Where rows end: u at which the larger ring has gained one vertex after another on the smaller, counted from where it has gained least.
std::vector<double> ends_of_rows(const Ring& larger, const Ring& smaller) {
  struct Step {
    double u;
    int gain;
  };
  std::vector<Step> steps;
  for (double u : larger.u) steps.push_back({u - std::floor(u), 1});
  for (double u : smaller.u) steps.push_back({u - std::floor(u), -1});
  std::ranges::stable_sort(steps, [](const Step& a, const Step& b) { return a.u != b.u ? a.u < b.u : a.gain < b.gain; });
  int gained = 0, least = 1;
  std::size_t start = 0;
  for (std::size_t k = 0; k < steps.size(); ++k) {
    gained += steps[k].gain;
    if (gained < least) least = gained, start = k + 1;
  }
  std::rotate(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(start % steps.size()), steps.end());
  std::vector<double> ends;
  gained = 0;
  for (const Step& step : steps) {
    gained += step.gain;
    if (gained > static_cast<int>(ends.size())) ends.push_back(step.u);
  }
  ends.resize(larger.size() - smaller.size(), 0);
  return ends;
}

class LayoutBuilder {
public:
  LayoutBuilder(Index given, bool turned) : rows_(given), turned_(turned) {}

  /// One strip of faces from a ring inwards: returns the ring that it ends at. merged: of each edge of the ring, whether its ends come
  /// together there; paired: of each vertex, whether both of its edges do and make one quad. to: rows of the ring that it ends at; none: new ones.
  Ring strip(const Ring& from, const std::vector<char>& merged, const std::vector<char>& paired,
             const std::vector<Index>& to = {}) {
    const std::size_t n = from.size();
    std::size_t start = 0;  // a vertex with which a group begins
    while (start < n && merged[(start + n - 1) % n]) ++start;
    std::vector<Index> group(n);
    Ring next;
    for (std::size_t j = 0; j < n; ++j) {
      const std::size_t k = (start + j) % n;
      if (j == 0 || !merged[(k + n - 1) % n]) {
        next.row.push_back(to.empty() ? rows_++ : to[next.row.size()]);
        next.u.push_back(0);
      }
      group[k] = next.row.back();
    }
    for (std::size_t j = 0; j < n; ++j) {
      const std::size_t k = (start + j) % n, k1 = (k + 1) % n;
      if (!merged[k]) {
        add({from.row[k], from.row[k1], group[k1], group[k]});
      } else if (paired[k1]) {
        const std::size_t k2 = (k1 + 1) % n;
        add({from.row[k], from.row[k1], from.row[k2], group[k]});
        lowered.push_back(from.row[k1]);
      } else if (!paired[k]) {
        add({from.row[k], from.row[k1], group[k]});
      }
    }
    for (std::size_t k = 0; k < n; ++k) columns.push_back({from.row[k], group[k]});
    std::size_t at = 0;  // u: the mean over each group
    double sum = 0, count = 0;
    for (std::size_t j = 0; j < n; ++j) {
      const std::size_t k = (start + j) % n;
      sum += from.u[k] + (k < start ? 1 : 0);
      ++count;
      if (j + 1 < n && group[(k + 1) % n] == group[k]) continue;
      next.u[at++] = sum / count;
      sum = count = 0;
    }
    return next;
  }

  void add(std::vector<Index> face) {
    if (turned_) std::reverse(face.begin(), face.end());
    faces.add(face);
  }
  Index rows() const { return rows_; }

  Faces faces;
  std::vector<Ring> rings;  // inside
  std::vector<std::array<Index, 2>> columns;
  std::vector<Index> lowered;  // vertices at which two rows end in one quad

private:
  Index rows_;
  bool turned_;
};

/// Marks edges of a ring whose ends come together in the next, near the places given. pair: two edges at a vertex for each place. Places
/// that find no room are left over.
std::vector<double> mark(const Ring& ring, const std::vector<double>& places, bool pair, std::vector<char>& merged,
                         std::vector<char>& paired) {
  const std::size_t n = ring.size();
  std::vector<double> left;
  for (const double u : places) {
    std::size_t best = n;
    double least = INFINITY;
    for (std::size_t k = 0; k < n; ++k) {
      const std::size_t before = (k + n - 1) % n, beyond = (k + 1) % n;
      // no two next to each other
      const bool free = !merged[k] && !merged[before] && !merged[beyond] && (!pair || !merged[(k + n - 2) % n]);
      const double middle = pair ? ring.u[k] : ring.u[k] + 0.5 * std::abs(near_to(ring.u[beyond], ring.u[k]) - ring.u[k]);
      const double apart = std::abs(near_to(middle, u) - u);
      if (free && apart < least - tolerance::solved) least = apart, best = k;
    }
    if (best == n) {
      left.push_back(u);
      continue;
    }
    merged[best] = 1;
    if (pair) merged[(best + n - 1) % n] = 1, paired[best] = 1;
  }
  return left;
}

/// Edges that must come together although no free one is left next to them: any, evenly.
void mark_any(std::size_t count, std::vector<char>& merged) {
  const std::size_t n = merged.size();
  for (std::size_t j = 0; j < count; ++j) {
    const std::size_t wanted = (2 * j + 1) * n / (2 * count);
    for (std::size_t k = 0; k < n; ++k)
      if (!merged[(wanted + k) % n]) {
        merged[(wanted + k) % n] = 1;
        break;
      }
  }
}

/// The turn of the smaller ring at which the rows that reach it are straightest.
std::size_t straightest(const std::vector<double>& reached, const Ring& smaller) {
  const std::size_t n = smaller.size();
  std::size_t best = 0;
  double least = INFINITY;
  for (std::size_t turn = 0; turn < n; ++turn) {
    double sum = 0;
    for (std::size_t k = 0; k < n; ++k) {
      const double u = smaller.u[(k + turn) % n], apart = near_to(u, reached[k]) - reached[k];
      sum += apart * apart;
    }
    if (sum < least - tolerance::rounding) least = sum, best = turn;
  }
  return best;
}

/// Moves the vertices inside along their rings: to the middle between those that their rows join and, where rows end, between their neighbors.
void relax(const LayoutBuilder& made, bool even, Index given, PlanePoints& uv) {
  std::vector<std::vector<std::pair<Index, double>>> near(static_cast<std::size_t>(uv.rows()));
  const auto join = [&](Index a, Index b, double weight) {
    near[static_cast<std::size_t>(a)].emplace_back(b, weight);
    near[static_cast<std::size_t>(b)].emplace_back(a, weight);
  };
  for (const auto& [a, b] : made.columns)
    if (std::ranges::find(made.lowered, a) == made.lowered.end()) join(a, b, 1);
  for (const Ring& ring : made.rings)
    for (std::size_t k = 0; even && k < ring.size(); ++k) join(ring.row[k], ring.row[(k + 1) % ring.size()], even_ring_counts);
  for (int sweep = 0; sweep < relaxing_sweeps; ++sweep)
    for (Index v = given; v < uv.rows(); ++v) {
      double sum = 0, weights = 0;
      for (const auto& [other, weight] : near[static_cast<std::size_t>(v)]) {
        sum += weight * near_to(uv(other, 0), uv(v, 0));
        weights += weight;
      }
      if (weights > 0) uv(v, 0) = sum / weights;
    }
}

std::vector<Index> irregular(const Faces& faces, Index given, Index rows) {
  std::vector<int> count(static_cast<std::size_t>(rows), 0);
  for (Index v : faces.corners) ++count[static_cast<std::size_t>(v)];
  std::vector<Index> poles;
  for (Index v = given; v < rows; ++v)
    if (count[static_cast<std::size_t>(v)] != 4) poles.push_back(v);
  return poles;
}

/// Which rows end in which strip, by twos and one by one.
struct Plan {
  std::vector<std::vector<double>> pairs, singles;
};

Plan plan_of(const std::vector<double>& ends, std::size_t strips, bool all_quads) {
  Plan plan{std::vector<std::vector<double>>(strips), std::vector<std::vector<double>>(strips)};
  std::size_t k = 0, turn = 0;
  if (all_quads && strips > 1)
    for (; k + 1 < ends.size(); k += 2, ++turn)
      plan.pairs[1 + turn % (strips - 1)].push_back((ends[k] + near_to(ends[k + 1], ends[k])) / 2);
  for (; k < ends.size(); ++k, ++turn) plan.singles[turn % strips].push_back(ends[k]);
  return plan;
}

/// Strips from the larger ring to the smaller. What finds no room in one strip ends in the next, and in the last by triangles.
void lay_strips(const Ring& larger, const Ring& smaller, Plan plan, LayoutBuilder& made) {
  Ring ring = larger;
  const std::size_t strips = plan.pairs.size();
  for (std::size_t strip = 0; strip < strips; ++strip) {
    std::vector<char> merged(ring.size(), 0), paired(ring.size(), 0);
    const bool last = strip + 1 == strips;
    const std::vector<double> pairs = mark(ring, plan.pairs[strip], true, merged, paired);
    std::vector<double>& singles = plan.singles[strip];
    if (last)
      for (double u : pairs) singles.insert(singles.end(), {u, u});
    const std::vector<double> left = mark(ring, singles, false, merged, paired);
    if (!last) {
      plan.pairs[strip + 1].insert(plan.pairs[strip + 1].end(), pairs.begin(), pairs.end());
      plan.singles[strip + 1].insert(plan.singles[strip + 1].end(), left.begin(), left.end());
      ring = made.strip(ring, merged, paired);
      made.rings.push_back(ring);
      continue;
    }
    mark_any(left.size(), merged);
    const std::vector<double> reached = LayoutBuilder(0, false).strip(ring, merged, paired).u;
    std::vector<Index> to = smaller.row;
    std::rotate(to.begin(), to.begin() + static_cast<std::ptrdiff_t>(straightest(reached, smaller)), to.end());
    made.strip(ring, merged, paired, to);
  }
}

}  // namespace

AnnulusLayout annulus_layout(const std::vector<double>& first, const std::vector<double>& second, int rings, bool all_quads) {
  const Index m = static_cast<Index>(first.size()), n = static_cast<Index>(second.size());
  const Ring outer = ring_of(first, 0, false), inner = ring_of(second, m, true);
  const bool turned = n > m;
  const Ring &larger = turned ? inner : outer, &smaller = turned ? outer : inner;
  LayoutBuilder made(m + n, turned);
  lay_strips(larger, smaller, plan_of(ends_of_rows(larger, smaller), static_cast<std::size_t>(rings), all_quads), made);
  AnnulusLayout out;
  out.uv.resize(made.rows(), 2);
  for (Index k = 0; k < m; ++k) out.uv.row(k) << first[static_cast<std::size_t>(k)], 0;
  for (Index k = 0; k < n; ++k) out.uv.row(m + k) << second[static_cast<std::size_t>(k)], 1;
  for (std::size_t j = 0; j < made.rings.size(); ++j) {
    const double v = static_cast<double>(j + 1) / rings;
    for (std::size_t k = 0; k < made.rings[j].size(); ++k)
      out.uv.row(made.rings[j].row[k]) << made.rings[j].u[k], turned ? 1 - v : v;
  }
  relax(made, m != n, m + n, out.uv);
  // a third of a ring from the quad in which two rows end, where its other three corners are
  for (const Index v : made.lowered)
    if (v >= m + n) out.uv(v, 1) += (turned ? 1.0 : -1.0) / (3 * rings);
  for (Index v = 0; v < out.uv.rows(); ++v) out.uv(v, 0) -= std::floor(out.uv(v, 0));
  out.poles = irregular(made.faces, m + n, out.uv.rows());
  out.faces = std::move(made.faces);
  return out;
}

}  // namespace tripatch
