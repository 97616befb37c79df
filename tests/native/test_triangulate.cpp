#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "tripatch/output/triangulate.h"

using namespace tripatch;

namespace {

using Parameters = std::array<std::vector<double>, 3>;

/// n edges, growing like t^power.
std::vector<double> graded(int n, double power = 1) {
  std::vector<double> t;
  for (int k = 0; k <= n; ++k) t.push_back(std::pow(static_cast<double>(k) / n, power));
  return t;
}

/// Positions are all that triangles are made by.
class Position final : public Surface {
public:
  explicit Position(std::function<Vec3(const Vec3&)> f) : f_(std::move(f)) {}
  void evaluate(const double* b, Index n, int, double* out) const override {
    for (Index k = 0; k < n; ++k) Eigen::Map<Vec3>(out + 3 * k) = f_(Eigen::Map<const Vec3>(b + 3 * k));
  }

private:
  std::function<Vec3(const Vec3&)> f_;
};

const Position octant([](const Vec3& b) { return b.normalized(); });
const Position flat([](const Vec3& b) { return Vec3(b[1] + 0.5 * b[2], std::sqrt(0.75) * b[2], 0); });
/// The long twisted hole: side 2 of length 4, side 1 of length 2.
const Position helicoid([](const Vec3& b) {
  const double u = 4 * b[1] + 1.2 * b[2], v = -0.5 * b[0] - 0.2 * b[1] + b[2];
  return Vec3(u, v * std::cos(1.2 * u), v * std::sin(1.2 * u));
});
/// A cap over a round rim: the rim goes straight on at the corners.
const Position cap([](const Vec3& b) {
  const Vec3 p(b[1] + 0.5 * b[2] - 0.5, std::sqrt(0.75) * (b[2] - 1.0 / 3), 0);
  const double r = 1 - 3 * b.minCoeff();
  return p.norm() > 0 ? Vec3(p.normalized() * r + Vec3(0, 0, 0.3 * (1 - r * r))) : Vec3(0, 0, 0.3);
});

double det(const Points& b, const std::array<Index, 3>& t) {
  Eigen::Matrix3d m;
  for (int k = 0; k < 3; ++k) m.row(k) = b.row(t[k]);
  return m.determinant();
}

/// Everything that must hold whatever the counts; empty when it does.
std::string flaw(const Parameters& parameters, const TriangleMesh& mesh) {
  Index row = 0;
  for (int side : {2, 0, 1})
    for (std::size_t k = 0; k + 1 < parameters[side].size(); ++k, ++row)
      if (mesh.barycentric(row, side) != 0 || mesh.barycentric(row, (side + 2) % 3) != parameters[side][k])
        return "rim row " + std::to_string(row);
  if (mesh.rim != row) return "rim count";
  const Index n = mesh.barycentric.rows();
  for (Index k = 0; k < n; ++k) {
    if (std::abs(mesh.barycentric.row(k).sum() - 1) > 1e-15) return "sum of row " + std::to_string(k);
    if (mesh.barycentric.row(k).minCoeff() < 0) return "outside";
    if (k >= mesh.rim && !(mesh.barycentric.row(k).minCoeff() > 0)) return "inner vertex on the rim";
  }
  std::map<std::pair<Index, Index>, int> directed;
  std::vector<char> used(n, 0);
  double area = 0;
  for (const auto& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      ++directed[{t[k], t[(k + 1) % 3]}];
      used[t[k]] = 1;
    }
    const double twice = det(mesh.barycentric, t);
    if (!(twice > 0)) return "a triangle turned over in the parameter triangle";
    area += twice;
  }
  if (std::abs(area - 1) > 1e-9) return "the parameter triangle is not covered once";
  Index border = 0, inner = 0;
  for (const auto& [edge, count] : directed) {
    if (count != 1) return "an edge twice in one direction";
    if (directed.count({edge.second, edge.first})) {
      ++inner;
      continue;
    }
    ++border;
    if (edge.first >= mesh.rim || edge.second != (edge.first + 1) % mesh.rim) return "a border edge that is not a rim edge";
  }
  if (border != mesh.rim) return "a rim edge without a triangle";
  for (char u : used)
    if (!u) return "a vertex without triangles";
  if (n - (border + inner / 2) + static_cast<Index>(mesh.triangles.size()) != 1) return "Euler characteristic";
  return "";
}

struct Angles {
  double smallest = 180, largest = 0;
  double fold = 0;  ///< largest angle between neighboring triangles
  int under_20 = 0;
};

Angles angles(const TriangleMesh& mesh, const Position& position) {
  const Points x = position.positions(mesh.barycentric);
  auto degrees = [](const Vec3& u, const Vec3& v) { return std::atan2(u.cross(v).norm(), u.dot(v)) * 180 / std::numbers::pi; };
  Angles a;
  std::map<std::pair<Index, Index>, Vec3> normal;
  for (const auto& t : mesh.triangles) {
    double least = 180;
    for (int k = 0; k < 3; ++k) {
      const Vec3 p = x.row(t[k]), u = x.row(t[(k + 1) % 3]), v = x.row(t[(k + 2) % 3]);
      const double angle = degrees(u - p, v - p);
      least = std::min(least, angle);
      a.largest = std::max(a.largest, angle);
      normal[{t[k], t[(k + 1) % 3]}] = (u - p).cross(v - p);
    }
    a.smallest = std::min(a.smallest, least);
    a.under_20 += least < 20;
  }
  for (const auto& [edge, n] : normal)
    if (const auto other = normal.find({edge.second, edge.first}); other != normal.end())
      a.fold = std::max(a.fold, degrees(n, other->second));
  return a;
}

}  // namespace

TEST_CASE("equal counts give the regular grid of n^2 triangles") {
  for (int n : {1, 2, 3, 8, 100}) {
    const Parameters p = {graded(n), graded(n), graded(n)};
    for (const Position& position : {flat, octant}) {
      const TriangleMesh mesh = triangulate(p, {}, position);
      CHECK(flaw(p, mesh) == "");
      CHECK(static_cast<int>(mesh.triangles.size()) == n * n);
      CHECK(angles(mesh, position).smallest > 44);  // the octant's corners are right angles
    }
    CHECK(angles(triangulate(p, {}, flat), flat).largest < 60 + 1e-9);
  }
}

TEST_CASE("the regular grid follows uneven parameters") {
  const Parameters p = {graded(20, 1.3), graded(20, 0.8), graded(20)};
  const TriangleMesh mesh = triangulate(p, {}, flat);
  CHECK(flaw(p, mesh) == "");
  CHECK(mesh.triangles.size() == 400);
  CHECK(angles(mesh, flat).smallest > 20);
}

TEST_CASE("rows come rim first and the corners are exact") {
  const Parameters p = {graded(3), graded(5), graded(4)};
  const TriangleMesh mesh = triangulate(p, {}, flat);
  CHECK(mesh.rim == 12);
  CHECK(mesh.barycentric.row(0) == Eigen::RowVector3d(1, 0, 0));
  CHECK(mesh.barycentric.row(4) == Eigen::RowVector3d(0, 1, 0));
  CHECK(mesh.barycentric.row(7) == Eigen::RowVector3d(0, 0, 1));
}

TEST_CASE("any counts give a watertight, manifold, oriented triangulation") {
  std::mt19937 random(20260);
  auto count = [&] {
    const int magnitude = static_cast<int>(random() % 4);
    return 1 + static_cast<int>(random() % (magnitude == 0 ? 3 : magnitude == 1 ? 10 : magnitude == 2 ? 40 : 150));
  };
  const std::array<Position, 4> positions = {flat, octant, helicoid, cap};
  for (int trial = 0; trial < 100; ++trial) {
    Parameters p;
    for (auto& side : p) {
      const int n = count();
      side = {0};
      for (int k = 0; k < n; ++k) side.push_back(side.back() + std::exp(3.0 * static_cast<double>(random() % 1000) / 1000));
      for (double& t : side) t /= side.back();
      side.back() = 1;
    }
    std::optional<int> resolution;
    if (random() % 3 == 0) resolution = 1 + static_cast<int>(random() % 40);
    INFO(p[0].size() - 1 << " / " << p[1].size() - 1 << " / " << p[2].size() - 1 << ", resolution " << resolution.value_or(0)
                         << ", position " << trial % 4);
    CHECK(flaw(p, triangulate(p, resolution, positions[trial % 4])) == "");
  }
}

TEST_CASE("extreme counts and spacings stay valid") {
  const std::vector<Parameters> cases = {
      {graded(1), graded(1), graded(30)},
      {graded(500), graded(3), graded(3)},
      {graded(1), graded(2), graded(3)},
      {graded(40, 6), graded(40), graded(40)},  // shortest edge 2.4e-10
      {graded(40, 3), graded(40, 3), graded(40, 3)},
      {graded(4000), graded(1), graded(1)},
  };
  for (const Parameters& p : cases)
    for (const Position& position : {flat, helicoid}) CHECK(flaw(p, triangulate(p, {}, position)) == "");
}

TEST_CASE("triangles are well shaped in space") {
  struct Case {
    Parameters p;
    Position position;
    double smallest, largest, fold;
    int under_20;
  };
  const std::vector<Case> cases = {
      {{graded(33), graded(32), graded(32)}, octant, 28, 110, 10, 0},
      {{graded(16), graded(15), graded(16)}, cap, 24, 112, 15, 0},
      {{graded(16), graded(16), graded(16)}, cap, 24, 112, 15, 0},
      {{graded(2), graded(3), graded(2)}, octant, 25, 110, 60, 0},
      {{graded(10), graded(5), graded(40)}, flat, 8, 145, 1, 6},
      // edges of 0.01 and 0.4 meet at one corner: a few needles there cannot be avoided
      {{graded(10), graded(5, 0.7), graded(40, 1.6)}, helicoid, 2, 160, 40, 6},
      {{graded(20), graded(10, 0.7), graded(80, 1.6)}, helicoid, 1, 165, 25, 8},
  };
  for (const Case& c : cases) {
    const TriangleMesh mesh = triangulate(c.p, {}, c.position);
    REQUIRE(flaw(c.p, mesh) == "");
    const Angles a = angles(mesh, c.position);
    CHECK(a.smallest > c.smallest);
    CHECK(a.largest < c.largest);
    CHECK(a.fold < c.fold);
    CHECK(a.under_20 <= c.under_20);
  }
}

TEST_CASE("resolution sets how many triangles there are inside") {
  const Parameters p = {graded(16), graded(16), graded(16)};
  const TriangleMesh fine = triangulate(p, 64, octant), same = triangulate(p, 16, octant), coarse = triangulate(p, 4, octant),
                     none = triangulate(p, 1, octant);
  for (const auto* mesh : {&fine, &same, &coarse, &none}) CHECK(flaw(p, *mesh) == "");
  CHECK(same.triangles.size() == 256);
  CHECK(fine.triangles.size() > 2500);
  CHECK(fine.triangles.size() < 5500);
  CHECK(coarse.triangles.size() < 160);
  CHECK(none.barycentric.rows() == none.rim);
  CHECK(angles(fine, octant).smallest > 10);
  CHECK(angles(coarse, octant).smallest > 20);
  const Parameters three = {graded(1), graded(1), graded(1)};
  CHECK(triangulate(three, {}, octant).triangles.size() == 1);
  CHECK(triangulate(three, 16, octant).triangles.size() > 20);
}

/// Of the inner vertices, the share that lies amid two of its neighbors in the domain, as those of a lattice do.
double lattice_share(const TriangleMesh& mesh) {
  const Index n = mesh.barycentric.rows();
  std::vector<std::vector<Index>> next(n);
  for (const auto& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) next[t[k]].push_back(t[(k + 1) % 3]);
  Index found = 0;
  for (Index v = mesh.rim; v < n; ++v) {
    bool amid = false;
    for (Index a : next[v])
      for (Index b : next[v])
        amid |= ((mesh.barycentric.row(a) + mesh.barycentric.row(b)) / 2 - mesh.barycentric.row(v)).cwiseAbs().maxCoeff() < 1e-12;
    found += amid;
  }
  return static_cast<double>(found) / static_cast<double>(n - mesh.rim);
}

TEST_CASE("a resolution far above the edges of the rim is met by lattices inside and as good triangles") {
  for (int edges : {32, 3}) {
    CAPTURE(edges);
    const Parameters p = {graded(edges), graded(edges), graded(edges)};
    const TriangleMesh without = triangulate(p, 110, octant), with = triangulate(p, 220, octant);
    REQUIRE(flaw(p, with) == "");
    CHECK(lattice_share(without) < 0.05);
    CHECK(lattice_share(with) > 0.4);
    CHECK(static_cast<double>(with.triangles.size()) > 3 * static_cast<double>(without.triangles.size()));
    CHECK(static_cast<double>(with.triangles.size()) < 5 * static_cast<double>(without.triangles.size()));
    const Angles before = angles(without, octant), after = angles(with, octant);
    CHECK(after.smallest > std::min(before.smallest, 10.0) / 2);
    CHECK(after.under_20 < 0.01 * static_cast<double>(with.triangles.size()));
  }
}

TEST_CASE("sizes grow from a fine side to a coarse one") {
  const Parameters p = {graded(60), graded(6), graded(6)};
  const TriangleMesh mesh = triangulate(p, {}, flat);
  REQUIRE(flaw(p, mesh) == "");
  double near = 0, far = 0;  // mean area next to side 0 and at corner 0
  int near_count = 0, far_count = 0;
  for (const auto& t : mesh.triangles) {
    const double b0 = (mesh.barycentric(t[0], 0) + mesh.barycentric(t[1], 0) + mesh.barycentric(t[2], 0)) / 3;
    if (b0 < 0.05) near += det(mesh.barycentric, t), ++near_count;
    if (b0 > 0.6) far += det(mesh.barycentric, t), ++far_count;
  }
  CHECK(far / far_count > 20 * near / near_count);
}

TEST_CASE("a rim so dense that its own density would be huge is decimated inwards") {
  const Parameters p = {graded(1500), graded(900), graded(600)};
  const TriangleMesh mesh = triangulate(p, {}, octant);
  CHECK(flaw(p, mesh) == "");
  CHECK(mesh.triangles.size() < 200'000);
  CHECK(angles(mesh, octant).smallest > 15);
}

TEST_CASE("where the surface is torn or folds the number of triangles stays bounded") {
  // Along a side of a gap and in a fold edges stay too long however often they are split.
  const auto shifted = [](std::function<double(double)> how_far) {
    return Position([how_far = std::move(how_far)](const Vec3& b) {
      const double s = 1 - b[0];
      return Vec3(b[1] + 0.5 * b[2], std::sqrt(0.75) * b[2] - 1.2 * s * s * (3 - 2 * s) * b[0] * how_far(s > 0 ? b[2] / s : 0),
                  0);
    });
  };
  const Position torn = shifted([](double t) { return t < 0.25 ? 0 : t < 0.6 ? 1 : 0.4; });
  const Position folded = shifted([](double t) { return std::sin(9 * t); });
  const Parameters p = {graded(16), graded(15), graded(16)};
  for (const Position& position : {torn, folded}) {
    const TriangleMesh mesh = triangulate(p, {}, position);
    CHECK(flaw(p, mesh) == "");
    CHECK(mesh.triangles.size() < 5000);  // 230 where it lies flat
  }
}

TEST_CASE("no surface, however crumpled, gets more triangles than its rim or the resolution ask for") {
  const Position crumpled([](const Vec3& b) {
    const double bubble = 27 * b[0] * b[1] * b[2];
    return Vec3(b[1] + 0.5 * b[2], std::sqrt(0.75) * b[2], 30 * bubble * std::sin(60 * b[1]) * std::cos(60 * b[2]));
  });
  const Parameters p = {graded(5, 6), graded(5), graded(6)};  // one side's edges differ 8,000 times in length
  const TriangleMesh by_rim = triangulate(p, {}, crumpled), by_resolution = triangulate(p, 5, crumpled);
  CHECK(flaw(p, by_rim) == "");
  CHECK(by_rim.triangles.size() <= 5 * 16 * 16);
  CHECK(flaw(p, by_resolution) == "");
  CHECK(by_resolution.triangles.size() <= 20 * (2 * 5 * 5 + 16));
}

TEST_CASE("rounding does not choose among triangulations") {
  const Position box([](const Vec3& b) {  // folded at a right angle, where the sides' vertices lie mirrored
    const double u = b[1] + 0.5 * b[2] - 0.5;
    return Vec3(std::max(u, 0.0), std::max(-u, 0.0), std::sqrt(0.75) * b[2]);
  });
  for (const Position* patch : {&flat, &octant, &box})
    for (const auto& [a, b, c] : {std::array{3, 2, 1}, {1, 3, 3}, {5, 1, 1}, {6, 4, 3}, {2, 2, 2}}) {
      const Parameters parameters = {graded(a), graded(b), graded(c)};
      const TriangleMesh mesh = triangulate(parameters, {}, *patch);
      std::mt19937 random(5);
      int same = 0;
      for (int k = 0; k < 20; ++k) {
        Parameters other = parameters;
        for (std::vector<double>& t : other)
          for (double& x : t)
            if (x > 0 && x < 1) x *= 1 + 1e-15 * (static_cast<double>(random() % 3) - 1);
        const Eigen::Matrix3d turn =
            Eigen::AngleAxisd(0.3 * k, Vec3(std::sin(k), 1, std::cos(k)).normalized()).toRotationMatrix();
        const Position turned([&](const Vec3& at) {
          Points one(1, 3);
          one << at.transpose();
          return Vec3(turn * Vec3(patch->positions(one).row(0)));
        });
        const TriangleMesh there = triangulate(other, {}, turned);
        same += there.triangles == mesh.triangles && (there.barycentric - mesh.barycentric).cwiseAbs().maxCoeff() < 1e-9;
      }
      INFO(a << " " << b << " " << c);
      CHECK(same == 20);
    }
}

TEST_CASE("triangulation is deterministic and needs increasing parameters") {
  const Parameters p = {graded(10), graded(5), graded(40)};
  const TriangleMesh a = triangulate(p, {}, helicoid), b = triangulate(p, {}, helicoid);
  CHECK(a.barycentric == b.barycentric);
  CHECK(a.triangles == b.triangles);
  CHECK_THROWS_AS(triangulate({graded(10), graded(5), {0, 0.5, 0.5, 1}}, {}, flat), InvalidArgument);
  CHECK_THROWS_AS(triangulate({graded(10), graded(5), {0, 0.5, 0.9}}, {}, flat), InvalidArgument);
  CHECK_THROWS_AS(triangulate(p, 0, flat), InvalidArgument);
}

TEST_CASE("sizes inside are those of the ends of sides that are near") {
  // fine at corner 0, coarse at the other two
  Parameters p = {graded(4), {}, graded(16, 2)};
  for (double t : p[2]) p[1].insert(p[1].begin(), 1 - t);
  const TriangleMesh mesh = triangulate(p, {}, flat);
  const Points x = flat.positions(mesh.barycentric);
  double sum = 0, count = 0;
  for (const std::array<Index, 3>& t : mesh.triangles) {
    const double area = Vec3(x.row(t[1]) - x.row(t[0])).cross(Vec3(x.row(t[2]) - x.row(t[0]))).norm() / 2;
    const double b = (mesh.barycentric(t[0], 0) + mesh.barycentric(t[1], 0) + mesh.barycentric(t[2], 0)) / 3;
    if (b > 0.4 && b < 0.7) ++count, sum += area;
  }
  const double edge = 2 * std::sqrt(0.45) / 16;  // of the two sides there
  CHECK(sum / count < std::sqrt(3.0) / 4 * edge * edge);
  CHECK(sum / count > std::sqrt(3.0) / 8 * edge * edge);
}
