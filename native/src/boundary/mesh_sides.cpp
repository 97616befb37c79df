// Tangent planes of a plain mesh along a rim: local polynomials of degree 4 whose noise, truncation and coefficient sizes are
// estimated from the hole itself (empirical Bayes), see docs/mathematics/surroundings.md.
#include "tripatch/boundary/mesh_sides.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <string>

namespace tripatch {
namespace {

constexpr int terms = 15;             // polynomials of degree 4 in (x, y)
constexpr int max_rings = 6;          // rings of faces around a rim vertex
constexpr int enough_points = 50;     // a stencil stops growing at this size
constexpr double same_sheet = 0.5;    // cosine: faces turned further from the vertex's own are another sheet (a cube's edge)
constexpr double least_noise = 1e-7;  // of the stencil radius: keeps the normal equations solvable
using Row = Eigen::Matrix<double, 1, terms>;
using Square = Eigen::Matrix<double, terms, terms>;
using Column = Eigen::Matrix<double, terms, 1>;

constexpr std::array<int, terms> degree_of = {0, 1, 1, 2, 2, 2, 3, 3, 3, 3, 4, 4, 4, 4, 4};

/// Taylor monomials x^i y^j / (i! j!), so that the coefficients are the derivatives of the height.
Row monomials(double x, double y) {
  const double xx = x * x, xy = x * y, yy = y * y;
  Row a;
  a << 1, x, y, xx / 2, xy, yy / 2, xx * x / 6, xx * y / 2, x * yy / 2, yy * y / 6, xx * xx / 24, xx * xy / 6, xx * yy / 4,
      xy * yy / 6, yy * yy / 24;
  return a;
}

std::string name(Index vertex) { return std::to_string(vertex); }

/// The faces near the rim with local vertex numbers, taken out of the mesh by one pass over it.
struct Patchwork {
  std::vector<Index> vertex;          // of the mesh
  std::vector<Vec3> position;         // about `origin`, over `scale`
  std::vector<int> offsets = {0};     // of faces
  std::vector<int> corners;           // local
  std::vector<Vec3> area;             // of faces: normal times twice the area
  std::vector<int> fan_offsets, fan;  // faces at each vertex
  std::vector<int> rim;               // local
  std::vector<int> beside;            // face that holds rim edge k reversed
  Vec3 origin = Vec3::Zero();
  double scale = 1;  // mean rim edge
};

Patchwork take_out(const Mesh& mesh, const Hole& hole, const std::vector<Index>& replaced) {
  const Index n = mesh.vertices.rows(), rim_size = static_cast<Index>(hole.rim.size());
  Patchwork w;
  Vec3 low = Vec3::Constant(INFINITY), high = -low;
  for (Index v : hole.rim) {
    const Vec3 p = mesh.vertices.row(v);
    if (!p.allFinite()) throw Refusal("Vertex " + name(v) + " of the rim has a coordinate that is not a finite number", {v});
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
    w.origin += p / static_cast<double>(rim_size);
  }
  double longest = 0;
  w.scale = 0;
  for (Index k = 0; k < rim_size; ++k) {
    const Index a = hole.rim[k], b = hole.rim[(k + 1) % rim_size];
    const double length = (mesh.vertices.row(a) - mesh.vertices.row(b)).norm();
    if (!(length > 1e-12 * (high - low).norm()))
      throw Refusal("The rim edge between vertices " + name(a) + " and " + name(b) + " has no length", {a, b});
    longest = std::max(longest, length);
    w.scale += length / static_cast<double>(rim_size);
  }
  std::vector<char> gone(replaced.empty() ? 0 : mesh.faces.size(), 0);
  for (Index f : replaced) gone[f] = 1;

  // Faces with a corner in a box around the rim; the box grows until every vertex within the rings has all of its faces.
  double margin = std::max(0.3 * (high - low).norm(), 2 * max_rings * longest);
  std::vector<char> inside(n);
  std::vector<int> local;
  for (;; margin *= 8) {
    const Vec3 a = low.array() - margin, b = high.array() + margin;
    bool all = true;
    for (Index v = 0; v < n; ++v) {
      inside[v] = (mesh.vertices.row(v).transpose().array() >= a.array()).all() &&
                  (mesh.vertices.row(v).transpose().array() <= b.array()).all();
      all = all && inside[v];
    }
    all = all || margin > 1e12 * (high - low).norm();
    local.assign(n, -1);
    w.vertex.clear();
    w.corners.clear();
    w.offsets = {0};
    const auto number = [&](Index v) {
      if (local[v] < 0) {
        local[v] = static_cast<int>(w.vertex.size());
        w.vertex.push_back(v);
      }
      return local[v];
    };
    w.rim.clear();
    for (Index v : hole.rim) w.rim.push_back(number(v));
    const Index* corner = mesh.faces.corners.data();
    for (Index f = 0; f < mesh.faces.size(); ++f) {
      const Index from = mesh.faces.offsets[f], to = mesh.faces.offsets[f + 1];
      bool near = false;
      for (Index c = from; c < to && !near; ++c) near = inside[corner[c]];
      if (!near || (!gone.empty() && gone[f])) continue;
      for (Index c = from; c < to; ++c) w.corners.push_back(number(corner[c]));
      w.offsets.push_back(static_cast<int>(w.corners.size()));
    }
    const int vertices = static_cast<int>(w.vertex.size()), faces = static_cast<int>(w.offsets.size()) - 1;
    w.fan_offsets.assign(vertices + 1, 0);
    for (int c : w.corners) ++w.fan_offsets[c + 1];
    for (int v = 0; v < vertices; ++v) w.fan_offsets[v + 1] += w.fan_offsets[v];
    w.fan.resize(w.corners.size());
    std::vector<int> place(w.fan_offsets.begin(), w.fan_offsets.end() - 1);
    for (int f = 0; f < faces; ++f)
      for (int c = w.offsets[f]; c < w.offsets[f + 1]; ++c) w.fan[place[w.corners[c]]++] = f;

    std::vector<int> ring(vertices, -1), queue = w.rim;
    for (int v : w.rim) ring[v] = 0;
    bool complete = true;
    for (std::size_t k = 0; k < queue.size() && complete; ++k) {
      const int v = queue[k];
      if (!mesh.vertices.row(w.vertex[v]).allFinite())
        throw Refusal("Vertex " + name(w.vertex[v]) + " beside the hole has a coordinate that is not a finite number",
                      {w.vertex[v]});
      if (ring[v] == max_rings) continue;
      complete = all || inside[w.vertex[v]];
      for (int e = w.fan_offsets[v]; e < w.fan_offsets[v + 1]; ++e)
        for (int c = w.offsets[w.fan[e]]; c < w.offsets[w.fan[e] + 1]; ++c)
          if (ring[w.corners[c]] < 0) {
            ring[w.corners[c]] = ring[v] + 1;
            queue.push_back(w.corners[c]);
          }
    }
    if (complete) break;
  }

  w.position.resize(w.vertex.size());
  for (std::size_t v = 0; v < w.vertex.size(); ++v) w.position[v] = (Vec3(mesh.vertices.row(w.vertex[v])) - w.origin) / w.scale;
  w.area.resize(w.offsets.size() - 1);
  for (std::size_t f = 0; f < w.area.size(); ++f) {
    const int from = w.offsets[f], to = w.offsets[f + 1];
    Vec3 sum = Vec3::Zero();
    const Vec3 p = w.position[w.corners[from]];
    double extent = 0;
    for (int c = from + 1; c < to; ++c) {
      const Vec3 d = w.position[w.corners[c]] - p;
      extent = std::max(extent, d.squaredNorm());
      if (c + 1 < to) sum += d.cross(w.position[w.corners[c + 1]] - p);
    }
    w.area[f] = sum.norm() > 1e-12 * extent ? sum : Vec3::Zero();
  }
  for (std::size_t k = 0; k < w.rim.size(); ++k) {
    const int a = w.rim[k], b = w.rim[(k + 1) % w.rim.size()];
    int face = -1;
    for (int e = w.fan_offsets[a]; e < w.fan_offsets[a + 1] && face < 0; ++e) {
      const int f = w.fan[e], from = w.offsets[f], size = w.offsets[f + 1] - from;
      for (int c = 0; c < size; ++c)
        if (w.corners[from + c] == b && w.corners[from + (c + 1) % size] == a) face = f;
    }
    if (face < 0)
      throw Refusal("No face continues the rim edge between vertices " + name(w.vertex[a]) + " and " + name(w.vertex[b]),
                    {w.vertex[a], w.vertex[b]});
    w.beside.push_back(face);
  }
  return w;
}

/// Sizes of what the heights are made of, in units of `scale`: everything that decides between smoothing and precision.
struct Sizes {
  double noise = 1e-6;                             // variance of a height
  double truncation = 1;                           // variance over radius^10: what degree 4 leaves out
  std::array<double, 5> term = {1, 100, 1, 1, 1};  // variances of the derivatives of each degree
};

/// The heights around one rim vertex over its first guess of a tangent plane.
struct Stencil {
  Vec3 e1, e2, e3;  // along the rim, outward, normal
  std::vector<Row> a;
  std::vector<double> z, share, g;  // height, weight of the wedge, radius^10
  double slope_noise = 1;           // of the rim's own direction: variance over that of the noise,
  int slope_order = 4;              // and what its interpolation leaves out: (derivative of this degree x slope_truncation)
  double slope_truncation = 0;
};

struct Solution {
  Column mean;
  Square covariance;
};

Solution solve(const Stencil& s, const Sizes& sizes, double radius10 = INFINITY) {
  Square p = Square::Zero();
  Column b = Column::Zero();
  for (std::size_t i = 0; i < s.a.size(); ++i) {
    if (s.g[i] > radius10) continue;
    const double w = s.share[i] / (sizes.noise + sizes.truncation * s.g[i]);
    p.selfadjointView<Eigen::Lower>().rankUpdate(s.a[i].transpose(), w);
    b += (w * s.z[i]) * s.a[i].transpose();
  }
  for (int j = 0; j < terms; ++j) p(j, j) += 1 / sizes.term[degree_of[j]];
  p(1, 1) += 1 / (sizes.noise * s.slope_noise + sizes.term[s.slope_order] * s.slope_truncation * s.slope_truncation);
  const Eigen::LLT<Square, Eigen::Lower> llt(p.selfadjointView<Eigen::Lower>());
  return {llt.solve(b), llt.solve(Square::Identity())};
}

/// Expectation maximisation over the stencils, each step lengthened; see docs/mathematics/surroundings.md.
Sizes estimate_sizes(const std::vector<Stencil>& stencils, double least) {
  Sizes sizes;
  for (int iteration = 0; iteration < 25; ++iteration) {
    std::array<double, 5> sum = {}, count = {};
    double noise = 0, truncation = 0, noise_count = 0, truncation_count = 0;
    for (const Stencil& s : stencils) {
      const Solution fit = solve(s, sizes);
      for (int j = 0; j < terms; ++j) {
        sum[degree_of[j]] += fit.mean[j] * fit.mean[j] + fit.covariance(j, j);
        count[degree_of[j]] += 1;
      }
      for (std::size_t i = 0; i < s.a.size(); ++i) {
        const double residual = s.z[i] - s.a[i].dot(fit.mean);
        const double second = residual * residual + (s.a[i] * fit.covariance).dot(s.a[i]);
        const double t = sizes.truncation * s.g[i], v = sizes.noise + t;
        const double part = sizes.noise / v;
        noise += s.share[i] * (part * part * second + part * t);
        noise_count += s.share[i];
        if (s.g[i] > 0) {
          truncation += s.share[i] * ((1 - part) * (1 - part) * second + (1 - part) * sizes.noise) / s.g[i];
          truncation_count += s.share[i];
        }
      }
    }
    const auto step = [&](double old, double next) { return std::max(old * std::pow(next / old, 1.7), least * least); };
    sizes.noise = step(sizes.noise, noise / noise_count);
    sizes.truncation = step(sizes.truncation, truncation / truncation_count);
    for (int d = 2; d <= 4; ++d) sizes.term[d] = step(sizes.term[d], sum[d] / count[d]);
  }
  return sizes;
}

/// One side before its corners are settled.
struct Draft {
  std::vector<int> vertex;  // local
  std::vector<double> t;
  double length = 0;          // of the chords, in scaled units
  std::vector<Vec3> tangent;  // unit, of the curve as it stands
  std::vector<Vec3> guess;    // normal
  std::vector<Vec3> normal;
  std::vector<double> curvature;  // across, n . II
};

PiecewisePolynomial curve(const Patchwork& w, const Draft& side, const std::vector<double>& start = {},
                          const std::vector<double>& end = {}) {
  std::vector<double> values;
  for (int v : side.vertex) values.insert(values.end(), w.position[v].data(), w.position[v].data() + 3);
  return PiecewisePolynomial::spline(side.t, values, 3, start, end);
}

/// x from 0 (nothing) to 1 (everything), smooth.
double fade(double x) {
  const double u = std::clamp(x, 0.0, 1.0);
  return u * u * (3 - 2 * u);
}

Stencil make_stencil(const Patchwork& w, const std::array<Draft, 3>& drafts, int i, int k, std::vector<int>& stamp, int mark) {
  Stencil s;
  const Draft &side = drafts[i], &before = drafts[(i + 2) % 3], &after = drafts[(i + 1) % 3];
  const int edges = static_cast<int>(side.vertex.size()) - 1;
  const Vec3 p = w.position[side.vertex[k]];
  s.e1 = side.tangent[k];
  s.e3 = (side.guess[k] - s.e1 * s.e1.dot(side.guess[k])).normalized();
  s.e2 = s.e1.cross(s.e3);

  // As far as the rings reach: the side's own vertices, and at its ends those of its neighbours. Only what lies in front of
  // this side counts, because curvature may jump at the corners (where a fillet ends).
  const int nearest = std::max(k - max_rings, 0), farthest = std::min(k + max_rings, edges);
  const std::span<const int> own(&side.vertex[nearest], farthest - nearest + 1);
  std::span<const int> first_other, last_other;
  if (nearest == 0) {
    const int count = std::min<int>(static_cast<int>(before.vertex.size()) - 1, max_rings);
    first_other = {before.vertex.data() + before.vertex.size() - 1 - count, static_cast<std::size_t>(count)};
  }
  if (farthest == edges) last_other = {after.vertex.data() + 1, std::min<std::size_t>(after.vertex.size() - 1, max_rings)};
  const Vec3 first = w.position[side.vertex[0]], last = w.position[side.vertex[edges]];
  const double h_first = (w.position[side.vertex[1]] - first).norm(), h_last = (w.position[side.vertex[edges - 1]] - last).norm();
  const auto distance = [&](const Vec3& q, std::span<const int> vertices) {
    double d = INFINITY;
    for (int v : vertices) d = std::min(d, (w.position[v] - q).squaredNorm());
    return std::sqrt(d);
  };
  const auto in_front = [&](int v) {
    const Vec3 q = w.position[v];
    if ((nearest > 0 && farthest < edges) || std::find(own.begin(), own.end(), v) != own.end()) return 1.0;
    double share = 1;
    if (nearest == 0) share *= fade(((q - first).dot(side.tangent[0]) / h_first + 0.35) / 0.25);
    if (farthest == edges) share *= fade(((last - q).dot(side.tangent[edges]) / h_last + 0.35) / 0.25);
    if (share <= 0) return share;
    const double mine = distance(q, own), other = std::min(distance(q, first_other), distance(q, last_other));
    return share * fade((1.3 - mine / std::max(other, 1e-12 * mine)) / 0.25);
  };
  std::vector<int> front = {side.vertex[k]}, next;
  stamp[side.vertex[k]] = mark;
  const auto add = [&](int v) {
    const double share = in_front(v);
    if (share <= 0) return;
    const Vec3 d = w.position[v] - p;
    s.a.push_back(monomials(d.dot(s.e1), d.dot(s.e2)));
    s.z.push_back(d.dot(s.e3));
    s.share.push_back(share);
    const double r2 = d.squaredNorm();
    s.g.push_back(r2 * r2 * r2 * r2 * r2);
  };
  add(side.vertex[k]);
  for (int ring = 0; ring < max_rings && static_cast<int>(s.a.size()) < enough_points && !front.empty(); ++ring) {
    next.clear();
    for (int v : front)
      for (int e = w.fan_offsets[v]; e < w.fan_offsets[v + 1]; ++e) {
        const int f = w.fan[e];
        if (!(w.area[f].dot(s.e3) > same_sheet * w.area[f].norm())) continue;  // also without area
        for (int c = w.offsets[f]; c < w.offsets[f + 1]; ++c)
          if (stamp[w.corners[c]] != mark) {
            stamp[w.corners[c]] = mark;
            next.push_back(w.corners[c]);
          }
      }
    for (int v : next) add(v);
    front = next;
  }

  // how well the interpolating curve knows its own direction here
  const auto chord = [&](int e) { return (w.position[side.vertex[e + 1]] - w.position[side.vertex[e]]).norm(); };
  const bool end = k == 0 || k == edges;
  const double a = chord(std::max(k - 1, 0)), b = chord(std::min(k, edges - 1)), h = std::max(a, b), l = std::min(a, b);
  s.slope_noise = std::pow((end ? 3.8 : 1.1) / l, 2);
  s.slope_order = std::min(edges + 1, 4);
  s.slope_truncation = edges == 1 ? h / 2 : edges == 2 ? h * h / 3 : h * h * h / (end ? 4 : 24);
  return s;
}

}  // namespace

MeshSides mesh_sides(const Mesh& mesh, const Hole& hole, const std::vector<Index>& replaced) {
  const Patchwork w = take_out(mesh, hole, replaced);
  const int rim_size = static_cast<int>(w.rim.size());
  std::array<Draft, 3> drafts;
  for (int i = 0; i < 3; ++i) {
    Draft& side = drafts[i];
    const int from = static_cast<int>(hole.corners[(i + 1) % 3]), to = static_cast<int>(hole.corners[(i + 2) % 3]);
    const int edges = (to - from + rim_size) % rim_size;
    if (edges < 1) throw InvalidArgument("the three corners of a hole must be three places of its rim, in its order");
    std::vector<Vec3> face;  // area vectors beside the edges
    side.t = {0};
    for (int k = 0; k <= edges; ++k) {
      side.vertex.push_back(w.rim[(from + k) % rim_size]);
      if (k == 0) continue;
      side.length += (w.position[side.vertex[k]] - w.position[side.vertex[k - 1]]).norm();
      side.t.push_back(side.length);
      face.push_back(w.area[w.beside[(from + k - 1) % rim_size]]);
    }
    for (double& t : side.t) t /= side.length;
    side.t.back() = 1;
    const PiecewisePolynomial c = curve(w, side);
    for (int k = 0; k <= edges; ++k) {
      side.tangent.push_back(c.derivative_at(side.t[k]).stableNormalized());
      Vec3 sum = Vec3::Zero();
      for (int e = std::max(k - 2, 0); e < std::min(k + 2, edges); ++e) sum += face[e];
      sum -= side.tangent[k] * side.tangent[k].dot(sum);
      if (!(sum.norm() > 0))
        throw Refusal("The faces beside vertex " + name(w.vertex[side.vertex[k]]) + " have no area", {w.vertex[side.vertex[k]]});
      side.guess.push_back(sum.normalized());
    }
  }

  std::vector<int> stamp(w.vertex.size(), -1);
  int mark = 0;
  std::vector<Stencil> samples;
  double radius = 0, points = 0;
  for (int i = 0; i < 3; ++i) {
    const int n = static_cast<int>(drafts[i].vertex.size()), step = std::max(1, n / 20);
    for (int k = 0; k < n; k += step) samples.push_back(make_stencil(w, drafts, i, k, stamp, mark++));
  }
  for (const Stencil& s : samples)
    for (double g : s.g) radius += std::pow(g, 0.2), points += 1;
  const Sizes sizes = estimate_sizes(samples, least_noise * std::sqrt(radius / points));

  MeshSides result;
  double spread = 0;
  int spread_count = 0;
  struct End {
    Vec3 normal;
    Eigen::Matrix3d information;  // of the normal
  };
  std::array<std::array<End, 2>, 3> ends;
  for (int i = 0; i < 3; ++i) {
    Draft& side = drafts[i];
    const int edges = static_cast<int>(side.vertex.size()) - 1;
    for (int k = 0; k <= edges; ++k) {
      const bool end = k == 0 || k == edges;
      Stencil s = make_stencil(w, drafts, i, k, stamp, mark++);
      Solution fit = solve(s, sizes);
      // once more over the plane just found
      side.guess[k] = s.e3 - fit.mean[2] * s.e2;
      s = make_stencil(w, drafts, i, k, stamp, mark++);
      fit = solve(s, sizes);
      const double fx = end ? fit.mean[1] : 0, fy = fit.mean[2];
      side.normal.push_back((s.e3 - fx * s.e1 - fy * s.e2).normalized());
      side.curvature.push_back(fit.mean[5] / std::pow(1 + fy * fy, 1.5));
      if (end) {
        const Eigen::Matrix2d information = fit.covariance.block<2, 2>(1, 1).inverse();
        Eigen::Matrix<double, 3, 2> frame;
        frame << s.e1, s.e2;
        ends[i][k == 0 ? 0 : 1] = {side.normal.back(), frame * information * frame.transpose()};
      }
      // the same with a smaller stencil
      std::vector<double> g(s.g);
      std::nth_element(g.begin(), g.begin() + g.size() / 2, g.end());
      const Solution small = solve(s, sizes, g[g.size() / 2]);
      spread += std::pow(small.mean[2] - fit.mean[2], 2);
      ++spread_count;
    }
  }
  result.surroundings_error = std::atan(std::sqrt(spread / spread_count)) * 180 / M_PI;

  // Corners: one plane where the two estimates agree within what they know.
  for (int corner = 0; corner < 3; ++corner) {
    const int in = (corner + 1) % 3, out = (corner + 2) % 3;
    const End &a = ends[in][1], &b = ends[out][0];
    const Eigen::Matrix3d both = a.information + b.information;
    const double angle = std::atan2(a.normal.cross(b.normal).norm(), a.normal.dot(b.normal)) * 180 / M_PI;
    if (angle > 5) continue;
    // the average weighted by information, in the plane across the mean of the two
    const Vec3 mean = (a.normal + b.normal).normalized();
    Eigen::Matrix<double, 3, 2> frame;
    frame.col(0) = mean.unitOrthogonal();
    frame.col(1) = mean.cross(frame.col(0));
    const Eigen::Matrix2d m = frame.transpose() * both * frame;
    const Eigen::Vector2d x =
        m.ldlt().solve(frame.transpose() * (a.information * a.normal + b.information * b.normal - both * mean));
    const Vec3 n = (mean + frame * x).normalized();
    drafts[in].normal.back() = n;
    drafts[out].normal.front() = n;
  }

  for (int i = 0; i < 3; ++i) {
    Draft& side = drafts[i];
    const int edges = static_cast<int>(side.vertex.size()) - 1;
    // End derivatives in their planes.
    const PiecewisePolynomial draft = curve(w, side);
    std::array<std::vector<double>, 2> given;
    for (int e = 0; e < 2; ++e) {
      const Vec3 n = e ? side.normal.back() : side.normal.front();
      Vec3 d = draft.derivative_at(e);
      Vec3 flat = d - n * n.dot(d);
      if (edges == 1) {  // the length of d that makes a circular arc of two equal angles: |chord| / cos^2(angle / 2)
        const double cosine = flat.norm() / d.norm();
        flat = flat.normalized() * (d.norm() * 2 / (1 + cosine));
      } else {
        flat = flat.normalized() * d.norm();
      }
      given[e] = {flat[0], flat[1], flat[2]};
    }
    const PiecewisePolynomial c = curve(w, side, given[0], given[1]);
    std::vector<double> r, q;
    for (int k = 0; k <= edges; ++k) {
      const Vec3 t = c.derivative_at(side.t[k]).stableNormalized();
      const Vec3 n = (side.normal[k] - t * t.dot(side.normal[k])).normalized();
      const Vec3 out = side.length * t.cross(n);
      const Vec3 bend = side.length * side.length * side.curvature[k] * n;
      r.insert(r.end(), out.data(), out.data() + 3);
      q.insert(q.end(), bend.data(), bend.data() + 3);
    }
    const auto scaled = [&](PiecewisePolynomial f) { return w.scale * std::move(f); };
    std::vector<double> positions;
    for (int v : side.vertex)
      for (int x = 0; x < 3; ++x) positions.push_back(mesh.vertices(w.vertex[v], x));
    for (auto& d : given)
      for (double& x : d) x *= w.scale;
    result.sides[i].c = PiecewisePolynomial::spline(side.t, positions, 3, given[0], given[1]);
    result.sides[i].r = scaled(PiecewisePolynomial::spline(side.t, r, 3));
    result.sides[i].q = scaled(PiecewisePolynomial::spline(side.t, q, 3));
    result.parameters[i] = side.t;
  }
  return result;
}

}  // namespace tripatch
