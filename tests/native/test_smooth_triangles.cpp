#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "test_refusals.h"
#include "tripatch/constructions/side_vertex.h"
#include "tripatch/mesh/vertex_normals.h"
#include "tripatch/smooth_triangles.h"

using namespace tripatch;

namespace {

double degrees_between(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / std::numbers::pi; }

struct TriangleSoup {
  Points vertices;
  Faces faces;
  Mesh mesh() const { return {vertices, faces}; }
};

/// 20 * 4^level faces on the unit sphere.
TriangleSoup icosphere(int level) {
  const double g = (1 + std::sqrt(5.0)) / 2;
  std::vector<Vec3> v = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                         {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  for (Vec3& p : v) p.normalize();
  std::vector<std::array<Index, 3>> f = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                                         {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                                         {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (; level > 0; --level) {
    std::map<std::pair<Index, Index>, Index> middle;
    const auto mid = [&](Index a, Index b) {
      const auto [place, is_new] = middle.try_emplace(std::minmax(a, b), static_cast<Index>(v.size()));
      if (is_new) v.push_back((v[a] + v[b]).normalized());
      return place->second;
    };
    std::vector<std::array<Index, 3>> finer;
    for (const auto& t : f) {
      const Index a = mid(t[0], t[1]), b = mid(t[1], t[2]), c = mid(t[2], t[0]);
      for (const auto& s : {std::array<Index, 3>{t[0], a, c}, {a, t[1], b}, {c, b, t[2]}, {a, b, c}}) finer.push_back(s);
    }
    f = finer;
  }
  TriangleSoup out;
  out.vertices.resize(static_cast<Index>(v.size()), 3);
  for (std::size_t k = 0; k < v.size(); ++k) out.vertices.row(k) = v[k];
  for (const auto& t : f) out.faces.add(t);
  return out;
}

/// A wavy sheet: a mesh with a border.
TriangleSoup sheet(int m) {
  TriangleSoup out;
  out.vertices.resize((m + 1) * (m + 1), 3);
  for (int i = 0; i <= m; ++i)
    for (int j = 0; j <= m; ++j)
      out.vertices.row(i * (m + 1) + j) << i, j + 0.2 * std::sin(i), std::sin(1.3 * i) * std::cos(0.9 * j);
  for (int i = 0; i < m; ++i)
    for (int j = 0; j < m; ++j) {
      const Index a = i * (m + 1) + j;
      out.faces.add(std::array<Index, 3>{a, a + m + 1, a + m + 2});
      out.faces.add(std::array<Index, 3>{a, a + m + 2, a + 1});
    }
  return out;
}

/// Root mean square, weighted by area, of |x| - 1 over the triangles' corners.
double distance_to_sphere(const SmoothMesh& smooth) {
  double sum = 0, area = 0;
  for (const auto& t : smooth.faces) {
    const Vec3 a = smooth.vertices.row(t[0]), b = smooth.vertices.row(t[1]), c = smooth.vertices.row(t[2]);
    const double w = (b - a).cross(c - a).norm() / 3;
    for (const Vec3& p : {a, b, c}) sum += w * (p.norm() - 1) * (p.norm() - 1);
    area += 3 * w;
  }
  return std::sqrt(sum / area);
}

/// Largest angle, over points of every interior edge, between the normals of the patches on its two sides, from their own
/// derivatives; and the largest distance between the two.
std::pair<double, double> seams(const TriangleSoup& soup, const Points& normals, NormalCurve curve) {
  std::map<std::pair<Index, Index>, std::vector<std::pair<SurfacePtr, int>>> patches;  // by edge: patch and its corner k
  for (Index f = 0; f < soup.faces.size(); ++f) {
    std::array<Vec3, 3> p, n;
    for (int k = 0; k < 3; ++k) {
      p[k] = soup.vertices.row(soup.faces[f][k]);
      n[k] = normals.row(soup.faces[f][k]);
    }
    const SurfacePtr patch = side_vertex(make_boundary(sides_from_normals(p, n, curve)));
    for (int k = 0; k < 3; ++k) patches[std::minmax(soup.faces[f][k], soup.faces[f][(k + 1) % 3])].emplace_back(patch, k);
  }
  double angle = 0, gap = 0;
  for (const auto& [edge, both] : patches) {
    if (both.size() != 2) continue;
    for (int s = 1; s < 10; ++s) {
      std::array<Points, 2> b = {Points::Zero(1, 3), Points::Zero(1, 3)};
      for (int side = 0; side < 2; ++side) {
        const double t = side == 0 ? s / 10.0 : 1 - s / 10.0;  // the neighbor runs along the edge the other way
        b[side](0, both[side].second) = 1 - t;
        b[side](0, (both[side].second + 1) % 3) = t;
      }
      angle = std::max(angle, degrees_between(both[0].first->normals(b[0]).row(0), both[1].first->normals(b[1]).row(0)));
      gap = std::max(gap, (both[0].first->positions(b[0]) - both[1].first->positions(b[1])).norm());
    }
  }
  return {angle, gap};
}

}  // namespace

TEST_CASE("icospheres come near to the sphere, with order 4") {
  const std::map<NormalCurve, std::array<double, 3>> bounds = {{NormalCurve::smits, {2.4e-2, 2.5e-3, 1.6e-4}},
                                                               {NormalCurve::hermite, {4e-3, 4e-4, 2.0e-5}}};
  for (const auto& [curve, bound] : bounds) {
    std::array<double, 4> error;
    for (int level = 0; level < 4; ++level) {
      const TriangleSoup soup = icosphere(level);
      error[level] = distance_to_sphere(smooth_triangles(soup.mesh(), soup.vertices, 10, curve));
      INFO("level " << level << ": " << error[level]);
      if (level < 3) CHECK(error[level] < bound[level]);
    }
    CHECK(std::log2(error[1] / error[2]) > 3.8);
    CHECK(std::log2(error[2] / error[3]) > 3.9);
  }
}

TEST_CASE("patches on both sides of every interior edge have one normal and one position") {
  for (NormalCurve curve : {NormalCurve::hermite, NormalCurve::smits}) {
    for (int level : {0, 1, 2}) {
      const TriangleSoup soup = icosphere(level);
      const auto [angle, gap] = seams(soup, soup.vertices, curve);
      CHECK(angle < 1e-6);
      CHECK(gap < 1e-14);
    }
    const TriangleSoup soup = sheet(5);
    const auto [angle, gap] = seams(soup, vertex_normals(soup.mesh()), curve);
    CHECK(angle < 1e-6);
    CHECK(gap < 1e-13);
  }
}

TEST_CASE("what comes out are the patches, with their normals, joined without a crack") {
  const TriangleSoup soup = sheet(3);
  const Points normals = vertex_normals(soup.mesh());
  const int n = 7;
  const SmoothMesh smooth = smooth_triangles(soup.mesh(), {}, n);
  CHECK(smooth.faces.size() == std::size_t(soup.faces.size() * n * n));
  CHECK(smooth.vertices.topRows(soup.vertices.rows()) == soup.vertices);
  const Index inside = (n - 1) * (n - 2) / 2;
  CHECK(smooth.vertices.rows() == soup.vertices.rows() + Index(smooth.edges.size()) * (n - 1) + soup.faces.size() * inside);

  // every directed edge once: the orientation is kept and no vertex is doubled
  std::set<std::pair<Index, Index>> directed;
  for (const auto& t : smooth.faces)
    for (int k = 0; k < 3; ++k) CHECK(directed.emplace(t[k], t[(k + 1) % 3]).second);
  Index border = 0;
  for (const auto& [a, b] : directed) border += !directed.contains({b, a});
  CHECK(border == 4 * 3 * n);

  // each small triangle's corners lie on the patch of its face, at its lattice point, with its normal
  double worst_position = 0, worst_angle = 0;
  for (Index f = 0; f < soup.faces.size(); ++f) {
    std::array<Vec3, 3> p, m;
    for (int k = 0; k < 3; ++k) {
      p[k] = soup.vertices.row(soup.faces[f][k]);
      m[k] = normals.row(soup.faces[f][k]);
    }
    const SurfacePtr patch = side_vertex(make_boundary(sides_from_normals(p, m)));
    Index row = f * n * n;
    for (int j = 0; j < n; ++j)
      for (int k = 0; j + k < n; ++k) {
        const Index v = smooth.faces[row][0];
        row += j + k + 1 < n ? 2 : 1;
        Points b(1, 3);
        b << n - j - k, j, k;
        b /= n;
        worst_position = std::max(worst_position, (patch->positions(b) - smooth.vertices.row(v)).norm());
        worst_angle = std::max(worst_angle, degrees_between(patch->normals(b).row(0), smooth.normals.row(v)));
      }
  }
  CHECK(worst_position < 1e-14);
  CHECK(worst_angle < 1e-5);  // at the vertices the patch's derivatives are those next to them
}

TEST_CASE("points of an edge are found by its number") {
  const TriangleSoup soup = icosphere(0);
  const int n = 5;
  const SmoothMesh smooth = smooth_triangles(soup.mesh(), soup.vertices, n);
  REQUIRE(smooth.edges.size() == 30);
  for (std::size_t e = 0; e < smooth.edges.size(); ++e) {
    const auto [a, b] = smooth.edges[e];
    CHECK(a < b);
    const Side side = side_from_normals(soup.vertices.row(a), soup.vertices.row(a), soup.vertices.row(b), soup.vertices.row(b),
                                        NormalCurve::hermite);
    for (int k = 1; k < n; ++k) {
      const Index v = soup.vertices.rows() + Index(e) * (n - 1) + k - 1;
      CHECK(smooth.vertices.row(v).transpose() == side.c(k / double(n)));
      CHECK(smooth.normals.row(v).transpose() == side.normal(k / double(n)));
    }
  }
}

TEST_CASE("a plane stays plane and normals need no length") {
  TriangleSoup soup = sheet(3);
  soup.vertices.col(2).setConstant(0.25);
  const SmoothMesh smooth = smooth_triangles(soup.mesh());
  CHECK((smooth.vertices.col(2).array() - 0.25).abs().maxCoeff() < 1e-15);
  CHECK((smooth.normals.rowwise() - Eigen::RowVector3d(0, 0, 1)).cwiseAbs().maxCoeff() < 1e-14);

  const TriangleSoup sphere = icosphere(1);
  const SmoothMesh longer = smooth_triangles(sphere.mesh(), Points(3 * sphere.vertices), 4);
  const SmoothMesh unit = smooth_triangles(sphere.mesh(), sphere.vertices, 4);
  CHECK((longer.vertices - unit.vertices).norm() < 1e-13);
}

TEST_CASE("inner normals and turned faces give the same surface") {
  const TriangleSoup soup = icosphere(1);
  const SmoothMesh outer = smooth_triangles(soup.mesh(), soup.vertices, 6);
  const SmoothMesh inner = smooth_triangles(soup.mesh(), Points(-soup.vertices), 6);
  CHECK((outer.vertices - inner.vertices).norm() < 1e-12);
  CHECK((outer.normals + inner.normals).norm() < 1e-12);
  TriangleSoup turned = soup;
  for (Index f = 0; f < soup.faces.size(); f += 3) std::swap(turned.faces.corners[3 * f + 1], turned.faces.corners[3 * f + 2]);
  const SmoothMesh mixed = smooth_triangles(turned.mesh(), soup.vertices, 6);
  CHECK(distance_to_sphere(mixed) == Approx(distance_to_sphere(outer)).epsilon(1e-9));
  for (Index v = 0; v < mixed.vertices.rows(); ++v) CHECK(mixed.normals.row(v).dot(mixed.vertices.row(v)) > 0.99);
}

TEST_CASE("estimated normals of a sphere point outwards") {
  const TriangleSoup soup = icosphere(2);
  const Points normals = vertex_normals(soup.mesh());
  for (Index v = 0; v < soup.vertices.rows(); ++v) CHECK(degrees_between(normals.row(v), soup.vertices.row(v)) < 1.0);
  CHECK(distance_to_sphere(smooth_triangles(soup.mesh(), {}, 6)) < 2e-3);
}

TEST_CASE("every resolution from 1 on") {
  const TriangleSoup soup = icosphere(0);
  const SmoothMesh same = smooth_triangles(soup.mesh(), soup.vertices, 1);
  CHECK(same.vertices == soup.vertices);
  REQUIRE(same.faces.size() == 20);
  for (Index f = 0; f < 20; ++f) CHECK(std::equal(same.faces[f].begin(), same.faces[f].end(), soup.faces[f].begin()));
  for (int n : {2, 3, 4}) {
    const SmoothMesh smooth = smooth_triangles(soup.mesh(), soup.vertices, n);
    CHECK(smooth.vertices.rows() == 10 * n * n + 2);
    CHECK(smooth.vertices.allFinite());
    for (const auto& t : smooth.faces) {
      const Vec3 a = smooth.vertices.row(t[0]), b = smooth.vertices.row(t[1]), c = smooth.vertices.row(t[2]);
      CHECK((b - a).cross(c - a).dot(a + b + c) > 0);
    }
  }
}

TEST_CASE("the smooth surface follows rigid motions and scales") {
  const TriangleSoup soup = sheet(3);
  const Points normals = vertex_normals(soup.mesh());
  const Points expected = smooth_triangles(soup.mesh(), normals, 5).vertices;
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Vec3(1, -1, 2).normalized()).toRotationMatrix();
  for (double scale : {1e-6, 1.0, 1e6}) {
    TriangleSoup moved = soup;
    const Eigen::RowVector3d shift = scale * Eigen::RowVector3d(3, -1, 2);
    moved.vertices = (scale * soup.vertices * turn.transpose()).rowwise() + shift;
    const SmoothMesh smooth = smooth_triangles(moved.mesh(), Points(normals * turn.transpose()), 5);
    const Points wanted = (scale * expected * turn.transpose()).rowwise() + shift;
    CHECK((smooth.vertices - wanted).cwiseAbs().maxCoeff() < 1e-12 * scale);
  }
}

TEST_CASE("what cannot be smoothed is refused by name") {
  const auto message = [](const TriangleSoup& soup, const std::optional<Points>& normals = {}) {
    try {
      smooth_triangles(soup.mesh(), normals);
    } catch (const CodedRefusal& refusal) {
      CHECK_FALSE(refusal.where().empty());
      return code_of(refusal.message());
    }
    return std::string();
  };
  TriangleSoup soup = icosphere(0);
  soup.faces.add(std::array<Index, 4>{0, 1, 2, 3});
  CHECK(message(soup) == "face_is_no_triangle");
  soup = icosphere(0);
  soup.faces.add(std::array<Index, 3>{0, 1, 1});
  CHECK(message(soup) == "face_without_area");
  soup = icosphere(0);
  soup.vertices(7, 2) = std::nan("");
  CHECK(message(soup) == "position_not_finite");
  soup = sheet(3);
  soup.vertices.col(2).setConstant(std::numeric_limits<double>::max());  // finite, but no longer as a sum
  CHECK(message(soup) == "coordinates_too_large");
  soup = icosphere(0);
  Points normals = soup.vertices;
  normals.row(4).setZero();
  CHECK(message(soup, normals) == "normal_zero");
  normals(4, 0) = std::numeric_limits<double>::infinity();
  CHECK(message(soup, normals) == "normal_not_finite");
  normals = soup.vertices;
  normals.row(4) = soup.vertices.row(9) - soup.vertices.row(4);
  CHECK(message(soup, normals) == "normal_along_edge");
  // two faces back to back: their normals cancel
  TriangleSoup flat;
  flat.vertices.resize(3, 3);
  flat.vertices << 0, 0, 0, 1, 0, 0, 0, 1, 0;
  flat.faces.add(std::array<Index, 3>{0, 1, 2});
  flat.faces.add(std::array<Index, 3>{0, 2, 1});
  CHECK(message(flat) == "normals_cancel");

  soup = icosphere(0);
  CHECK_THROWS_AS(smooth_triangles(soup.mesh(), Points(soup.vertices.topRows(5))), InvalidArgument);
  CHECK_THROWS_AS(smooth_triangles(soup.mesh(), {}, 0), InvalidArgument);
  CHECK_THROWS_AS(smooth_triangles(soup.mesh(), {}, max_smooth_resolution + 1), InvalidArgument);
  soup.faces.add(std::array<Index, 3>{0, 1, 12});
  CHECK_THROWS_WITH(smooth_triangles(soup.mesh()), Catch::Contains("vertex 12"));
  // a vertex that no face uses may be anything
  soup = icosphere(0);
  soup.vertices.conservativeResize(13, 3);
  soup.vertices.row(12).setConstant(std::nan(""));
  CHECK(smooth_triangles(soup.mesh()).vertices.bottomRows(10).allFinite());
}

TEST_CASE("normals of vertices that are not there are not looked for in other memory") {
  const Points points = Points::Random(3, 3);
  for (const Index wrong : {Index{-1}, Index{3}, Index{1} << 40}) {
    Faces faces;
    faces.add(std::array<Index, 3>{0, 1, wrong});
    CHECK_THROWS_AS(vertex_normals({points, faces}), InvalidArgument);
  }
}
