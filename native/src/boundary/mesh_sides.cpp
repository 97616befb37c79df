// Tangent planes of a plain mesh along a rim: local polynomials of degree 5 whose noise, truncation and coefficient sizes are
// estimated from the hole itself (empirical Bayes: MacKay 1992, Bayesian interpolation). docs/mathematics/surroundings.md has the
// formulas and what they reach.
#include "tripatch/boundary/mesh_sides.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <string>

#include "tripatch/math/parallel.h"

namespace tripatch {
namespace {

constexpr int degree = 5;  // of the local polynomials
constexpr int terms = 21;
constexpr int max_rings = 6;          // rings of faces around a rim vertex
constexpr int enough_points = 50;     // a stencil stops growing at this size
constexpr int samples_a_side = 6;     // about as many stencils a side tell the sizes
constexpr int most_iterations = 14;   // of the sizes
constexpr double settled = 0.03;      // relative change of a variance: no more iterations
constexpr double flat_enough = 5e-4;  // slope over the guess of a plane: no second fit
constexpr double same_sheet = 0.5;    // cosine: faces turned further from the vertex's own are another sheet (a cube's edge)
constexpr double steep = 0.5;         // cosine: what is turned further counts for nothing, and fully from 0.8 on
constexpr double sharp_bend = 8 * M_PI / 180;  // radians: edges that bend less are never sharp
constexpr double least_noise = 1e-7;           // of the stencil radius: keeps the normal equations solvable
using Square = Eigen::Matrix<double, terms, terms>;
using Column = Eigen::Matrix<double, terms, 1>;
using Columns = Eigen::Matrix<double, Eigen::Dynamic, 2 * degree + 1>;

/// The term of x^i y^j / (i! j!), so that the coefficients are the derivatives of the height.
struct Term {
  int i, j;
  double over;  // 1 / (i! j!)
};
constexpr std::array<Term, terms> term = [] {
  std::array<Term, terms> all{};
  constexpr std::array<double, degree + 1> factorial = {1, 1, 2, 6, 24, 120};
  for (int d = 0, k = 0; d <= degree; ++d)
    for (int j = 0; j <= d; ++j, ++k) all[k] = {d - j, j, 1 / (factorial[d - j] * factorial[j])};
  return all;
}();

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
  std::vector<int> across;            // face beyond the edge that starts at a corner; -1: none, or the edge is sharp
  std::vector<char> on_chord;         // vertices that say nothing of the surface, see put_on_edge
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

/// True for a vertex that was put on an edge between a and b and left there: straight between them, in faces that would be those of
/// the edge without it (it has no other neighbours, or those of triangles that were cut in two). It lies on a chord of the surface.
bool put_on_edge(const Patchwork& w, int v) {
  constexpr double straight = 1e-4;
  std::vector<std::array<int, 2>> beside;  // v's neighbours in each face, as they follow each other around it
  bool triangles = true;
  for (int e = w.fan_offsets[v]; e < w.fan_offsets[v + 1]; ++e) {
    const int from = w.offsets[w.fan[e]], size = w.offsets[w.fan[e] + 1] - from;
    const int* c = &w.corners[from];
    const auto k = std::find(c, c + size, v) - c;
    beside.push_back({c[(k + 1) % size], c[(k + size - 1) % size]});
    triangles = triangles && size == 3;
  }
  const auto between = [&](int a, int b) {
    const Vec3 p = w.position[a] - w.position[v], q = w.position[b] - w.position[v];
    return p.dot(q) < 0 && p.cross(q).norm() <= straight * p.norm() * q.norm();
  };
  const std::size_t faces = beside.size();
  if (faces == 0) return false;
  const auto [first, second] = beside[0];
  if (faces == 1 || (faces == 2 && beside[1][0] == second && beside[1][1] == first)) return between(first, second);
  if (!triangles || (faces != 2 && faces != 4)) return false;
  const auto starts = [&](int a) { return std::find_if(beside.begin(), beside.end(), [&](const auto& o) { return o[0] == a; }); };
  const auto ends = [&](int a) { return std::any_of(beside.begin(), beside.end(), [&](const auto& o) { return o[1] == a; }); };
  std::vector<int> around = {first};  // from the open end, where there is one
  for (const auto& o : beside)
    if (!ends(o[0])) around = {o[0]};
  for (std::size_t k = 0; k < faces; ++k) {
    const auto next = starts(around.back());
    if (next == beside.end()) return false;
    around.push_back((*next)[1]);
  }
  if (faces == 2) return between(around[0], around[2]);
  return around[4] == around[0] && (between(around[0], around[2]) || between(around[1], around[3]));
}

/// Neighbours of the faces within the rings. An edge is sharp if it bends by more than 8 degrees and twice as much as any
/// edge near it that runs its way: a chamfer's edge is, the edges of a coarse sphere or cylinder are not.
void find_neighbours(Patchwork& w) {
  const int faces = static_cast<int>(w.area.size());
  std::vector<char> reached(faces, 0), seen(w.vertex.size(), 0);
  std::vector<int> near, front = w.rim, next;
  for (int v : front) seen[v] = 1;
  for (int ring = 0; ring < max_rings; ++ring, front = std::move(next)) {
    next.clear();
    for (int v : front)
      for (int e = w.fan_offsets[v]; e < w.fan_offsets[v + 1]; ++e) {
        const int f = w.fan[e];
        if (reached[f]) continue;
        reached[f] = 1;
        near.push_back(f);
        for (int c = w.offsets[f]; c < w.offsets[f + 1]; ++c)
          if (!seen[w.corners[c]]) {
            seen[w.corners[c]] = 1;
            next.push_back(w.corners[c]);
          }
      }
  }
  std::vector<int> across(w.corners.size(), -1);  // the face beyond the edge that starts at a corner
  std::vector<double> bend(w.corners.size(), 0);  // radians
  const auto after = [&](int f, int c) { return c + 1 < w.offsets[f + 1] ? c + 1 : w.offsets[f]; };
  for (int f : near)
    for (int c = w.offsets[f]; c < w.offsets[f + 1]; ++c) {
      const int a = w.corners[c], b = w.corners[after(f, c)];
      for (int e = w.fan_offsets[a]; e < w.fan_offsets[a + 1] && across[c] < 0; ++e) {
        const int g = w.fan[e];
        if (g == f || !reached[g]) continue;
        for (int d = w.offsets[g]; d < w.offsets[g + 1]; ++d)
          if (w.corners[d] == b) across[c] = g;
      }
      if (across[c] >= 0) bend[c] = std::atan2(w.area[f].cross(w.area[across[c]]).norm(), w.area[f].dot(w.area[across[c]]));
    }
  w.across = across;
  w.on_chord.assign(w.vertex.size(), 0);
  for (std::size_t v = 0; v < seen.size(); ++v) w.on_chord[v] = seen[v] && put_on_edge(w, static_cast<int>(v));
  for (int v : w.rim) w.on_chord[v] = 0;
  for (int f : near)
    for (int c = w.offsets[f]; c < w.offsets[f + 1]; ++c) {
      if (bend[c] <= sharp_bend) continue;
      const int a = w.corners[c], b = w.corners[after(f, c)];
      std::vector<int> around = {f, across[c]};
      for (std::size_t k = 0, round = 0, end = 2; round < 2; ++round, end = around.size())
        for (; k < end; ++k)
          for (int d = w.offsets[around[k]]; d < w.offsets[around[k] + 1]; ++d)
            if (across[d] >= 0 && std::find(around.begin(), around.end(), across[d]) == around.end()) around.push_back(across[d]);
      double others = -1;  // the largest bend of those edges
      const Vec3 way = w.position[b] - w.position[a];
      for (int g : around)
        for (int d = w.offsets[g]; d < w.offsets[g + 1]; ++d) {
          const int p = w.corners[d], q = w.corners[after(g, d)];
          if (p == a || p == b || q == a || q == b || across[d] < 0) continue;
          const Vec3 direction = w.position[q] - w.position[p];
          if (std::abs(direction.dot(way)) > 0.7 * direction.norm() * way.norm()) others = std::max(others, bend[d]);
        }
      if (others >= 0 && bend[c] > sharp_bend + 2 * others) w.across[c] = -1;
    }
}

/// Sizes of what the heights, in units of `scale`: everything that decides between smoothing and precision.
struct Sizes {
  double noise = 1e-6;    // variance of a height
  double truncation = 1;  // variance over radius^(2 degree + 2): what the polynomial leaves out
  std::array<double, degree + 1> term = {1, 100, 1, 1, 1, 1};  // variances of the derivatives of each degree
  double tilt = 100;                                           // variance of the slope across the rim against the faces beside it
};

/// The heights around one rim vertex over its first guess of a tangent plane.
struct Stencil {
  Vec3 e1, e2, e3;              // along the rim, outward, normal
  Columns x, y;                 // powers 0 .. 2 degree of the places
  Eigen::VectorXd z, share, g;  // height, weight by place, radius^(2 degree + 2)
  double faces = 0;             // slope across the rim of the faces beside it
  double faces_noise = 0;       // its variance over that of the noise
  double slope_noise = 1;       // of the rim's own direction: variance over that of the noise,
  int slope_order = 4;          // and what its interpolation leaves out: (derivative of this degree x slope_truncation)
  double slope_truncation = 0;
};

/// (i, j): sum of w x^i y^j for i + j <= degree.
template <int Degree>
Eigen::Matrix<double, Degree + 1, Degree + 1> moments(const Stencil& s, const Eigen::VectorXd& w) {
  Eigen::Matrix<double, Degree + 1, Degree + 1> m;
  Eigen::VectorXd wx(w.size());
  for (int i = 0; i <= Degree; ++i) {
    wx = w.cwiseProduct(s.x.col(i));
    m.row(i).head(Degree + 1 - i).noalias() = wx.transpose() * s.y.leftCols(Degree + 1 - i);
  }
  return m;
}

/// The heights of a polynomial.
Eigen::VectorXd heights(const Stencil& s, const Column& coefficients) {
  Eigen::VectorXd z = Eigen::VectorXd::Zero(s.z.size());
  for (int k = 0; k < terms; ++k)
    z.array() += coefficients[k] * term[k].over * s.x.col(term[k].i).array() * s.y.col(term[k].j).array();
  return z;
}

struct Solution {
  Column mean, prior;                       // coefficients, inverse variances
  Eigen::LLT<Square, Eigen::Lower> factor;  // of the inverse covariance
};

/// The normal matrix of monomials has 66 different entries, sums of w x^i y^j, for its 231.
Solution solve(const Stencil& s, const Sizes& sizes, const Eigen::VectorXd& w) {
  const auto m = moments<2 * degree>(s, w);
  const auto right = moments<degree>(s, w.cwiseProduct(s.z));
  Solution r;
  Square p;
  Column b;
  for (int k = 0; k < terms; ++k) {
    for (int l = k; l < terms; ++l) p(l, k) = term[k].over * term[l].over * m(term[k].i + term[l].i, term[k].j + term[l].j);
    b[k] = term[k].over * right(term[k].i, term[k].j);
    r.prior[k] = 1 / sizes.term[term[k].i + term[k].j];
  }
  r.prior[2] = 1 / (sizes.tilt + sizes.noise * s.faces_noise);
  b[2] += r.prior[2] * s.faces;
  r.prior[1] += 1 / (sizes.noise * s.slope_noise + sizes.term[s.slope_order] * s.slope_truncation * s.slope_truncation);
  p.diagonal() += r.prior;
  r.factor.compute(p);
  r.mean = r.factor.solve(b);
  return r;
}

using SquareRows = Eigen::Matrix<double, terms, terms, Eigen::RowMajor>;

/// The lower triangle of the inverse. By rows and without its zeros: at this size several times faster than the general solver.
SquareRows inverse(const Eigen::LLT<Square, Eigen::Lower>& factor) {
  const Square& l = factor.matrixLLT();
  SquareRows half = SquareRows::Zero(), all = SquareRows::Zero();  // half: the inverse of l
  for (int i = 0; i < terms; ++i) {
    for (int k = 0; k < i; ++k) half.row(i).head(k + 1) -= l(i, k) * half.row(k).head(k + 1);
    half(i, i) = 1;
    half.row(i).head(i + 1) /= l(i, i);
    for (int k = 0; k <= i; ++k) all.row(k).head(k + 1) += half(i, k) * half.row(i).head(k + 1);
  }
  return all;
}

Solution solve(const Stencil& s, const Sizes& sizes) {
  return solve(s, sizes, s.share.array() / (sizes.noise + sizes.truncation * s.g.array()));
}

/// Sizes that make the heights of all stencils likeliest (MacKay 1992, eqs. 4.9 to 4.11: each size is the mean square of what it
/// explains over the number of its well-determined parameters). The slopes across the rim are those of the faces beside it but for a
/// tilt of a size of its own: where the next vertices are far, as beside a bevel of long strips, that is all there is to know them by,
/// and its likeliest size is next to nothing. `radius`: mean distance of the points;
/// `bend`: squared curvature that the faces show. Starts from no noise, so that coarse but clean meshes are not smoothed.
Sizes estimate_sizes(const std::array<std::vector<Stencil>, 3>& stencils, double radius, double bend) {
  Sizes sizes;
  const double least = least_noise * radius;
  // the variance of a term of this degree that makes heights of `least` at the radius
  const auto floor = [&](int d) { return std::pow(least / std::pow(radius, d), 2); };
  const double least_bend = 0.3 * bend;
  bend = std::max(bend, 0.01 / (radius * radius));
  sizes.term = {1, 100, bend, bend * bend, std::pow(bend, 3), std::pow(bend, 4)};
  sizes.noise = least * least;
  sizes.tilt = bend;
  sizes.truncation = std::pow(bend, 5) / 720 / 720;
  struct Explained {  // by one stencil
    std::array<double, degree + 1> sum = {}, count = {};
    double noise = 0, truncation = 0, noise_count = 0, truncation_count = 0, tilt = 0, tilt_count = 0;
  };
  const auto explain = [&](const Stencil& s) {
    Explained e;
    const Eigen::ArrayXd v = sizes.noise + sizes.truncation * s.g.array(), part = sizes.noise / v, w = s.share.array() / v;
    const Solution fit = solve(s, sizes, w);
    const SquareRows covariance = inverse(fit.factor);
    for (int j = 0; j < terms; ++j) {
      const int d = term[j].i + term[j].j;
      if (d == 1) continue;
      e.sum[d] += fit.mean[j] * fit.mean[j];
      e.count[d] += std::max(1 - covariance(j, j) / sizes.term[d], 1e-3);
    }
    e.tilt = std::pow(fit.mean[2] - s.faces, 2);
    e.tilt_count = std::max(1 - covariance(2, 2) * fit.prior[2], 1e-3);
    // The points less the parameters that they determine: all, and those whose error is noise.
    const auto m = moments<2 * degree>(s, w * part);
    double noisy = 0;
    for (int k = 0; k < terms; ++k)
      for (int l = k; l < terms; ++l)
        noisy +=
            (k == l ? 1 : 2) * covariance(l, k) * term[k].over * term[l].over * m(term[k].i + term[l].i, term[k].j + term[l].j);
    const double points = s.share.sum(), noise_points = (s.share.array() * part).sum();
    const double all = terms - covariance.diagonal().dot(fit.prior);
    e.noise_count = std::max(noise_points - noisy, 1e-3 * noise_points);
    e.truncation_count = std::max(points - noise_points - (all - noisy), 1e-3 * (points - noise_points));
    const Eigen::ArrayXd square = s.share.array() * (s.z - heights(s, fit.mean)).array().square();
    e.noise = (part.square() * square).sum();
    e.truncation = (s.g.array() > 0).select((1 - part).square() * square / s.g.array(), 0.0).sum();
    return e;
  };
  bool all = false;  // every second stencil of a side tells nearly the same
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    const Sizes before = sizes;
    std::array<double, degree + 1> sum = {}, count = {};
    double noise = 0, truncation = 0, noise_count = 0, truncation_count = 0, tilt = 0, tilt_count = 0;
    for (const std::vector<Stencil>& side : stencils)
      for (std::size_t k = all ? 0 : 1; k < side.size(); k += all ? 1 : 2) {
        const Explained e = explain(side[k]);
        for (int d = 0; d <= degree; ++d) {
          sum[d] += e.sum[d];
          count[d] += e.count[d];
        }
        noise += e.noise;
        truncation += e.truncation;
        noise_count += e.noise_count;
        truncation_count += e.truncation_count;
        tilt += e.tilt;
        tilt_count += e.tilt_count;
      }
    const auto ratio = [](double above, double below) { return below > 0 ? above / below : 0; };
    sizes.noise = std::max(ratio(noise, noise_count), least * least);
    sizes.truncation = std::max(ratio(truncation, truncation_count), 1e-6 * floor(degree + 1));
    for (int d = 2; d <= degree; ++d) sizes.term[d] = std::max(ratio(sum[d], count[d]), floor(d));
    sizes.term[2] = std::max(sizes.term[2], least_bend);
    sizes.tilt = std::max(ratio(tilt, tilt_count), 1e-4 * bend);
    const auto same = [](double a, double b) { return std::abs(a - b) <= settled * b; };
    bool done = same(sizes.noise, before.noise) && same(sizes.truncation, before.truncation);
    for (int d = 2; d <= degree; ++d) {
      const double unseen = 0.1 * sizes.noise / std::pow(radius, 2 * d);  // makes heights less than the noise
      done = done && same(sizes.term[d] + unseen, before.term[d] + unseen);
    }
    if (done && all) break;
    all = all || done || iteration >= most_iterations / 2;
  }
  return sizes;
}

/// One side before its corners are settled.
struct Draft {
  std::vector<int> vertex;  // local
  std::vector<double> t;
  double length = 0;          // of the chords, in scaled units
  std::vector<Vec3> tangent;  // unit, of the curve as it stands
  std::vector<Vec3> faces;    // unit normals: of the faces beside the rim,
  std::vector<Vec3> guess;    // and the best known so far
  std::vector<int> face;      // beside the edges
  std::vector<Vec3> normal;
  std::vector<Eigen::Matrix3d> second;  // second fundamental form, of tangent vectors
};

PiecewisePolynomial spline(const std::vector<double>& t, const std::vector<Vec3>& values) {
  std::vector<double> flat;
  for (const Vec3& p : values) flat.insert(flat.end(), p.data(), p.data() + 3);
  return PiecewisePolynomial::spline(t, flat, 3);
}

PiecewisePolynomial curve(const Patchwork& w, const Draft& side) {
  std::vector<Vec3> points;
  for (int v : side.vertex) points.push_back(w.position[v]);
  return spline(side.t, points);
}

/// x from 0 (nothing) to 1 (everything), smooth.
double fade(double x) {
  const double u = std::clamp(x, 0.0, 1.0);
  return u * u * (3 - 2 * u);
}

/// Second derivatives for a curve through values with first derivatives: those of the two cubic Hermite pieces at each parameter,
/// averaged, the shorter piece counting more.
std::vector<Vec3> second_derivatives(const std::vector<double>& t, const std::vector<Vec3>& value,
                                     const std::vector<Vec3>& first) {
  std::vector<Vec3> second(t.size(), Vec3::Zero());
  std::vector<double> weight(t.size(), 0);
  for (std::size_t k = 0; k + 1 < t.size(); ++k) {
    const double h = t[k + 1] - t[k];
    const Vec3 slope = (value[k + 1] - value[k]) / h;
    second[k] += (6 * slope - 4 * first[k] - 2 * first[k + 1]) / (h * h);
    second[k + 1] += (2 * first[k] + 4 * first[k + 1] - 6 * slope) / (h * h);
    weight[k] += 1 / h;
    weight[k + 1] += 1 / h;
  }
  for (std::size_t k = 0; k < t.size(); ++k) second[k] /= weight[k];
  return second;
}

/// C2 curve of degree 5 through values with first and second derivatives.
PiecewisePolynomial quintic(const std::vector<double>& t, const std::vector<Vec3>& value, const std::vector<Vec3>& first,
                            const std::vector<Vec3>& second) {
  std::vector<double> coefficients;
  for (std::size_t k = 0; k + 1 < t.size(); ++k) {
    // about the middle, u from -1 to 1: even and odd parts
    const double h = 0.5 * (t[k + 1] - t[k]);
    const Vec3 p0 = (value[k] + value[k + 1]) / 2, m0 = (value[k + 1] - value[k]) / 2;
    const Vec3 p1 = h * (first[k + 1] - first[k]) / 2, m1 = h * (first[k] + first[k + 1]) / 2;
    const Vec3 p2 = h * h * (second[k] + second[k + 1]) / 2, m2 = h * h * (second[k + 1] - second[k]) / 2;
    std::array<Vec3, 6> c;
    c[4] = (p2 - p1) / 8;
    c[2] = (p1 - 4 * c[4]) / 2;
    c[0] = p0 - c[2] - c[4];
    c[5] = (m2 - 3 * m1 + 3 * m0) / 8;
    c[3] = (m1 - m0 - 4 * c[5]) / 2;
    c[1] = m0 - c[3] - c[5];
    double power = 1;
    for (const Vec3& v : c) {
      for (int x = 0; x < 3; ++x) coefficients.push_back(v[x] / power);
      power *= h;
    }
  }
  return {t, 5, 3, coefficients};
}

/// v of the plane with normal `from` carried into the plane with normal `to` without turning (Levi-Civita's transport), by
/// Rodrigues' formula.
Vec3 carried(const Vec3& v, const Vec3& from, const Vec3& to) {
  const Vec3 axis = from.cross(to);
  return v + axis.cross(v) + axis.cross(axis.cross(v)) / std::max(1 + from.dot(to), 1e-12);
}

/// The cross derivative to be read at each vertex of a side with normals n and derivatives dc: one unit across, and along it as
/// much as the corners' own cross derivatives have, mixed, so that alpha and beta of the ribbons, which are linear, need not undo
/// along the side what r does there. Where the rim faces one way, `up`, mixed as they are and laid into the planes along it, as in
/// a graph's own chart (graph = 1); elsewhere carried along the side (graph = 0).
std::vector<Vec3> cross_derivatives(const std::vector<double>& t, const std::vector<Vec3>& n, const std::vector<Vec3>& dc,
                                    const Vec3& start, const Vec3& end, const Vec3& up, double graph) {
  const std::size_t last = n.size() - 1;
  const auto flat = [&](const Vec3& v, std::size_t k) { return Vec3(v - n[k] * n[k].dot(v)); };
  std::vector<Vec3> forth(n.size()), back(n.size()), r;
  forth[0] = flat(start, 0);
  back[last] = flat(end, last);
  for (std::size_t k = 1; k <= last; ++k) {
    forth[k] = flat(carried(forth[k - 1], n[k - 1], n[k]), k);
    back[last - k] = flat(carried(back[last - k + 1], n[last - k + 1], n[last - k]), last - k);
  }
  for (std::size_t k = 0; k <= last; ++k) {
    Vec3 wanted = (1 - t[k]) * forth[k] + t[k] * back[k];
    if (graph > 0) {
      const Vec3 mixed = (1 - t[k]) * start + t[k] * end, way = up + std::max(0.1 - up.dot(n[k]), 0.0) * n[k];
      wanted += graph * (mixed - way * (mixed.dot(n[k]) / way.dot(n[k])) - wanted);
    }
    const Vec3 across = dc[k].cross(n[k]).normalized(), along = dc[k].normalized();
    // where the rim hardly turns at the corners: no more than a slant of about 73 degrees
    const double out = wanted.dot(across), least = 0.3 * wanted.norm();
    r.push_back(across + wanted.dot(along) / (0.5 * (out + std::sqrt(out * out + 4 * least * least))) * along);
  }
  return r;
}

/// What a stencil has reached: the number of the stencil.
struct Marks {
  std::vector<int> vertex, face;
  int now = 0;
};

Stencil make_stencil(const Patchwork& w, const std::array<Draft, 3>& drafts, int i, int k, Marks& marks) {
  Stencil s;
  const Draft &side = drafts[i], &before = drafts[(i + 2) % 3], &after = drafts[(i + 1) % 3];
  const int edges = static_cast<int>(side.vertex.size()) - 1;
  const Vec3 p = w.position[side.vertex[k]];
  s.e1 = side.tangent[k];
  s.e3 = (side.guess[k] - s.e1 * s.e1.dot(side.guess[k])).normalized();
  s.e2 = s.e1.cross(s.e3);
  s.faces = -side.faces[k].dot(s.e2) / side.faces[k].dot(s.e3);

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
  const auto is_own = [&](int v) { return std::find(own.begin(), own.end(), v) != own.end(); };
  const auto in_front = [&](int v, bool between) {
    const Vec3 q = w.position[v];
    if ((nearest > 0 && farthest < edges) || is_own(v)) return 1.0;
    double share = 1;
    if (between && nearest == 0) share *= fade(((q - first).dot(side.tangent[0]) / h_first + 0.35) / 0.25);
    if (between && farthest == edges) share *= fade(((last - q).dot(side.tangent[edges]) / h_last + 0.35) / 0.25);
    if (share <= 0) return share;
    const double mine = distance(q, own), other = std::min(distance(q, first_other), distance(q, last_other));
    return share * fade((1.3 - mine / std::max(other, 1e-12 * mine)) / 0.25);
  };
  std::vector<std::pair<int, double>> used;
  std::vector<int> front, next, all;
  const auto reach = [&](int v) {
    if (marks.vertex[v] == marks.now) return;
    marks.vertex[v] = marks.now;
    next.push_back(v);
    if (w.on_chord[v]) return;
    all.push_back(v);
    const double share = in_front(v, true);
    if (share > 0) used.emplace_back(v, share);
  };
  const auto take = [&](int f) {
    marks.face[f] = marks.now;
    for (int c = w.offsets[f]; c < w.offsets[f + 1]; ++c) reach(w.corners[c]);
  };
  ++marks.now;
  reach(side.vertex[k]);
  front = {side.vertex[k]};
  next.clear();
  take(side.face[std::max(k - 1, 0)]);
  take(side.face[std::min(k, edges - 1)]);
  for (int ring = 0; ring < max_rings && static_cast<int>(used.size()) < enough_points && !front.empty(); ++ring) {
    for (int v : front) {
      // the faces of its fan that smooth edges connect with those taken already
      bool more = true;
      while (more) {
        more = false;
        for (int e = w.fan_offsets[v]; e < w.fan_offsets[v + 1]; ++e) {
          const int f = w.fan[e];
          if (marks.face[f] == marks.now || !(w.area[f].dot(s.e3) > same_sheet * w.area[f].norm())) continue;
          bool connected = false;
          for (int c = w.offsets[f]; c < w.offsets[f + 1] && !connected; ++c)
            connected = w.across[c] >= 0 && marks.face[w.across[c]] == marks.now;
          if (!connected) continue;
          take(f);
          more = true;
        }
      }
    }
    front = std::move(next);
    next.clear();
  }

  // Where the rows lean over the end of the side, next to nothing may be left: then what is nearer to this side, then all.
  for (int attempt = 0; attempt < 2; ++attempt) {
    const auto beyond_rim = std::count_if(used.begin(), used.end(), [&](const auto& u) { return !is_own(u.first); });
    if (beyond_rim >= 8 || used.size() == all.size()) break;
    used.clear();
    for (int v : all) {
      const double share = attempt == 0 ? in_front(v, false) : 1;
      if (share > 0) used.emplace_back(v, share);
    }
  }
  // Where the surface has turned far away, its height over this plane is no polynomial any more.
  for (auto& [v, share] : used) {
    Vec3 n = Vec3::Zero();
    for (int e = w.fan_offsets[v]; e < w.fan_offsets[v + 1]; ++e) n += w.area[w.fan[e]];
    if (n.norm() > 0) share *= std::max(fade((n.dot(s.e3) / n.norm() - steep) / 0.3), 1e-6);
  }
  const Index size = static_cast<Index>(used.size());
  s.x.resize(size, Eigen::NoChange);
  s.y.resize(size, Eigen::NoChange);
  s.z.resize(size);
  s.share.resize(size);
  s.g.resize(size);
  for (Index j = 0; j < size; ++j) {
    const Vec3 d = w.position[used[j].first] - p;
    s.x(j, 1) = d.dot(s.e1);
    s.y(j, 1) = d.dot(s.e2);
    s.z[j] = d.dot(s.e3);
    s.share[j] = used[j].second;
    const double square = d.squaredNorm();
    s.g[j] = square * square * square * square * square * square;
  }
  for (Columns* m : {&s.x, &s.y}) {
    m->col(0).setOnes();
    for (int k = 2; k <= 2 * degree; ++k) m->col(k) = m->col(k - 1).cwiseProduct(m->col(1));
  }

  double depth = 0;  // of the faces beside the rim
  for (int e : {std::max(k - 1, 0), std::min(k, edges - 1)})
    depth += 0.5 * w.area[side.face[e]].norm() / (w.position[side.vertex[e + 1]] - w.position[side.vertex[e]]).norm();
  s.faces_noise = 1 / (depth * depth);

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
  Patchwork w = take_out(mesh, hole, replaced);
  find_neighbours(w);
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
      side.face.push_back(w.beside[(from + k - 1) % rim_size]);
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
      side.faces.push_back(side.guess.back());
    }
  }

  Marks marks = {std::vector<int>(w.vertex.size(), 0), std::vector<int>(w.area.size(), 0), 0};
  std::array<std::vector<Stencil>, 3> samples;
  double radius = 0, points = 0;
  for (int i = 0; i < 3; ++i) {
    const int n = static_cast<int>(drafts[i].vertex.size()), step = std::max(1, n / samples_a_side);
    for (int k = 0; k < n; k += step) samples[i].push_back(make_stencil(w, drafts, i, k, marks));
  }
  for (const std::vector<Stencil>& side : samples)
    for (const Stencil& s : side) {
      radius += s.g.array().pow(1.0 / (2 * degree + 2)).sum();
      points += static_cast<double>(s.g.size());
    }
  // the squared curvature that the faces beside the rim show, to start with
  double bend = 0;
  for (int k = 0; k < rim_size; ++k) {
    const Vec3 a = w.area[w.beside[k]].normalized(), b = w.area[w.beside[(k + 1) % rim_size]].normalized();
    bend += (a - b).squaredNorm() / rim_size;
  }
  const Sizes sizes = estimate_sizes(samples, radius / points, bend);

  MeshSides result;
  struct End {
    Vec3 normal;
    Eigen::Matrix3d information;  // of the normal
  };
  std::array<std::array<End, 2>, 3> ends;
  std::array<double, 3> bend_variance = {};  // of the second derivative across, mean over the side
  const auto fit_side = [&](int i) {         // sum of the variances
    Draft& side = drafts[i];
    Marks reached = {std::vector<int>(w.vertex.size(), 0), std::vector<int>(w.area.size(), 0), 0};
    double variances = 0;
    const int edges = static_cast<int>(side.vertex.size()) - 1;
    double tilt = 0;  // of the plane found last against the faces beside the rim: most likely that of the next one too
    for (int k = 0; k <= edges; ++k) {
      const bool end = k == 0 || k == edges;
      const Vec3 faces = side.guess[k], outward = side.tangent[k].cross(faces);
      side.guess[k] -= tilt * outward;
      Stencil s = make_stencil(w, drafts, i, k, reached);
      Solution fit = solve(s, sizes);
      if (std::abs(fit.mean[2]) > flat_enough) {  // once more over the plane just found
        side.guess[k] = s.e3 - fit.mean[2] * s.e2;
        s = make_stencil(w, drafts, i, k, reached);
        fit = solve(s, sizes);
      }
      const double fx = fit.mean[1], fy = fit.mean[2];
      side.normal.push_back((s.e3 - fx * s.e1 - fy * s.e2).normalized());
      tilt = std::clamp(-side.normal.back().dot(outward) / side.normal.back().dot(faces), -0.2, 0.2);
      Eigen::Matrix<double, 3, 2> frame;
      frame << s.e1, s.e2;
      Eigen::Matrix2d hessian;
      hessian << fit.mean[3], fit.mean[4], fit.mean[4], fit.mean[5];
      side.second.push_back(frame * (hessian / std::sqrt(1 + fx * fx + fy * fy)) * frame.transpose());
      Eigen::Matrix<double, terms, 3> columns;  // of the covariance: the two slopes, the second derivative across
      columns << Column::Unit(1), Column::Unit(2), Column::Unit(5);
      fit.factor.solveInPlace(columns);
      const Eigen::Matrix2d covariance = columns.block<2, 2>(1, 0);
      variances += covariance.trace();
      bend_variance[i] += columns(5, 2) / (edges + 1);
      if (end) {
        const Eigen::Matrix2d information = covariance.inverse();
        ends[i][k == 0 ? 0 : 1] = {side.normal.back(), frame * information * frame.transpose()};
      }
    }
    return variances;
  };
  std::array<double, 3> known;  // of the slopes
  parallel_for(0, 3, rim_size < 60 ? 3 : 1, [&](Index from, Index to) {
    for (Index i = from; i < to; ++i) known[i] = fit_side(static_cast<int>(i));
  });
  const double variance = (known[0] + known[1] + known[2]) / (rim_size + 3);
  result.surroundings_error = std::atan(std::sqrt(variance)) * 180 / M_PI;

  // Corners: one plane, the average weighted by information, unless the two are further apart than 5 degrees and than what
  // they know of themselves (a cube).
  for (int corner = 0; corner < 3; ++corner) {
    const int in = (corner + 1) % 3, out = (corner + 2) % 3;
    const End &a = ends[in][1], &b = ends[out][0];
    const double degrees = std::atan2(a.normal.cross(b.normal).norm(), a.normal.dot(b.normal)) * 180 / M_PI;
    if (degrees > 60) continue;
    const Vec3 mean = (a.normal + b.normal).normalized();
    Eigen::Matrix<double, 3, 2> across;
    across.col(0) = mean.unitOrthogonal();
    across.col(1) = mean.cross(across.col(0));
    const Eigen::Matrix2d ia = across.transpose() * a.information * across, ib = across.transpose() * b.information * across;
    const Eigen::Vector2d x = across.transpose() * a.normal, y = across.transpose() * b.normal, d = x - y;
    const Eigen::Matrix2d weight = (ia + ib).inverse();
    const double deviations = std::sqrt(d.dot(ia * weight * ib * d));  // of x - y, whose variance is ia^-1 + ib^-1
    if (degrees > 5 && deviations > 5) continue;
    const Vec3 n = (mean + across * (weight * (ia * x + ib * y))).normalized();
    drafts[in].normal.back() = n;
    drafts[out].normal.front() = n;
  }

  // The spline's derivatives, laid into the planes.
  std::array<std::vector<Vec3>, 3> tangents;
  Vec3 up = Vec3::Zero();
  for (const Draft& side : drafts)
    for (const Vec3& n : side.normal) up += n;
  up.normalize();
  double graph = 1;  // from nothing where a normal of the rim is at a right angle to their mean, to all at 84 degrees
  for (const Draft& side : drafts)
    for (const Vec3& n : side.normal) graph = std::min(graph, fade(n.dot(up) / 0.1));
  for (int i = 0; i < 3; ++i) {
    const Draft& side = drafts[i];
    const int edges = static_cast<int>(side.vertex.size()) - 1;
    const PiecewisePolynomial draft = curve(w, side);
    for (int k = 0; k <= edges; ++k) {
      const Vec3 along = draft.derivative_at(side.t[k]);
      Vec3 flat = along - side.normal[k] * side.normal[k].dot(along);
      // one edge: the length that makes a circular arc of two equal angles, |chord| / cos^2(angle / 2)
      const double cosine = flat.norm() / along.norm();
      flat *= (edges == 1 ? 2 / (1 + cosine) : 1) / cosine;
      tangents[i].push_back(flat);
    }
  }

  for (int i = 0; i < 3; ++i) {
    const Draft& side = drafts[i];
    const int edges = static_cast<int>(side.vertex.size()) - 1;
    std::vector<Vec3> dc = tangents[i];
    const Vec3 start = tangents[(i + 2) % 3].back() + 0.5 * dc.front(), end = -tangents[(i + 1) % 3].front() - 0.5 * dc.back();
    std::vector<Vec3> c, dr, q, r = cross_derivatives(side.t, side.normal, dc, start, end, up, graph);
    for (int k = 0; k <= edges; ++k) {
      r[k] *= side.length;
      c.push_back(w.position[side.vertex[k]]);
      q.push_back(r[k].dot(side.second[k] * r[k]) * side.normal[k]);
    }
    const PiecewisePolynomial draft_r = spline(side.t, r);
    std::vector<Vec3> ddc = second_derivatives(side.t, c, dc);
    for (int k = 0; k <= edges; ++k) {
      const Vec3& n = side.normal[k];
      // Along the normal the curve bends as the surface does, unless the difference is no more than the noise of the vertices
      // makes: then by twice as much the other way, which wiggles least between points that must be met.
      const double h = std::min(k > 0 ? side.t[k] - side.t[k - 1] : 1, k < edges ? side.t[k + 1] - side.t[k] : 1);
      const double wanted = dc[k].dot(side.second[k] * dc[k]), differs = n.dot(ddc[k]) - wanted;
      const double noisy = sizes.noise * std::pow(15 / (h * h), 2);
      ddc[k] += n * (differs * (1.9 * noisy / (noisy + differs * differs) - 1));
      const Vec3 v = draft_r.derivative_at(side.t[k]);
      dr.push_back(v + n * (r[k].dot(side.second[k] * dc[k]) - n.dot(v)));
    }
    for (int k = 0; k <= edges; ++k) {
      c[k] = mesh.vertices.row(w.vertex[side.vertex[k]]);
      dc[k] *= w.scale;
      ddc[k] *= w.scale;
    }
    result.sides[i].c = quintic(side.t, c, dc, ddc);
    result.sides[i].r = w.scale * quintic(side.t, r, dr, second_derivatives(side.t, r, dr));
    result.sides[i].q = w.scale * spline(side.t, q);
    result.sides[i].curvature_error = std::sqrt(bend_variance[i]) / w.scale;
    result.parameters[i] = result.sides[i].rim = side.t;
  }
  return result;
}

}  // namespace tripatch
