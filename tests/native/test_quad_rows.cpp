// Rows of quads that continue across a hole: which holes are blocks of such rows, what is put into them, and the surface through it.
#include <catch2/catch.hpp>
#include <numbers>

#include "test_refusals.h"
#include "test_surfaces.h"
#include "tripatch/fill.h"
#include "tripatch/fill/rows_fill.h"
#include "tripatch/grid/continued_rows.h"
#include "tripatch/grid/quad_rows.h"
#include "tripatch/grid/rows_surface.h"
#include "tripatch/math/linear.h"
#include "tripatch/spline/plane_patch.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

using At = std::function<Vec3(double, double)>;

/// A grid of quads, places (i, j) from -beyond on, with a block of n x m quads from (0, 0) on taken out.
struct Grid {
  Index n, m, beyond, columns, rows;
  Points vertices;
  Faces faces;
  std::vector<Index> rim;

  Grid(Index block_n, Index block_m, Index rows_beyond, const At& at)
      : n(block_n), m(block_m), beyond(rows_beyond), columns(n + 2 * beyond + 1), rows(m + 2 * beyond + 1) {
    vertices.resize(columns * rows, 3);
    for (Index i = 0; i < columns; ++i)
      for (Index j = 0; j < rows; ++j)
        vertices.row(i * rows + j) = at(static_cast<double>(i - beyond), static_cast<double>(j - beyond)).transpose();
    for (Index i = 0; i + 1 < columns; ++i)
      for (Index j = 0; j + 1 < rows; ++j) {
        const bool gone = i >= beyond && i < beyond + n && j >= beyond && j < beyond + m;
        const Index a = i * rows + j;
        if (!gone) faces.add(std::array{a, a + rows, a + rows + 1, a + 1});
      }
    for (Index i = 0; i < n; ++i) rim.push_back(vertex(i, 0));
    for (Index j = 0; j < m; ++j) rim.push_back(vertex(n, j));
    for (Index i = n; i > 0; --i) rim.push_back(vertex(i, m));
    for (Index j = m; j > 0; --j) rim.push_back(vertex(0, j));
  }
  Index vertex(Index i, Index j) const { return (i + beyond) * rows + j + beyond; }
  std::optional<QuadRows> known() const { return quad_rows(Connectivity(faces, vertices.rows()), rim); }
};

Vec3 flat(double i, double j) { return {i, j, 0}; }

/// The farthest that what is continued lies from where it was.
double off(const Grid& grid, const At& at) {
  const ContinuedRows made = continued_rows(grid.vertices, grid.known().value());
  double most = 0;
  for (Index i = 1; i < grid.n; ++i)
    for (Index j = 1; j < grid.m; ++j) {
      const Vec3 truth = at(static_cast<double>(i), static_cast<double>(j));
      most = std::max(most, (Vec3(made.inside.row((i - 1) * (grid.m - 1) + j - 1)) - truth).norm());
    }
  return most;
}
double off(Index n, Index m, Index beyond, const At& at) { return off(Grid(n, m, beyond, at), at); }

Vec3 on_ball(double i, double j, double step) {
  const double u = step * i, v = step * j - 0.4;
  return {std::cos(v) * std::cos(u), std::cos(v) * std::sin(u), std::sin(v)};
}

}  // namespace

TEST_CASE("a block of quads is found with the rows around it, wherever its rim begins") {
  const Grid grid(4, 3, 2, flat);
  for (std::size_t turn = 0; turn < grid.rim.size(); ++turn) {
    std::vector<Index> rim = grid.rim;
    std::rotate(rim.begin(), rim.begin() + static_cast<std::ptrdiff_t>(turn), rim.end());
    const std::optional<QuadRows> rows = quad_rows(Connectivity(grid.faces, grid.vertices.rows()), rim);
    REQUIRE(rows);
    CHECK(rows->n() * rows->m() == 12);
    CHECK(rows->beyond() == std::array<Index, 4>{2, 2, 2, 2});
    for (Index i = rows->first(0); i <= rows->last(0); ++i)  // neighbors in the rows are neighbors in the grid
      for (Index j = rows->first(1); j <= rows->last(1); ++j) {
        const bool inside = i > 0 && i < rows->n() && j > 0 && j < rows->m();
        CHECK((rows->at(i, j) < 0) == inside);
        if (!inside && i < rows->last(0) && rows->at(i + 1, j) >= 0)
          CHECK((grid.vertices.row(rows->at(i, j)) - grid.vertices.row(rows->at(i + 1, j))).norm() == Approx(1));
      }
  }
}

TEST_CASE("rows end beside a triangle and at the border of the mesh, on that side alone") {
  Grid grid(3, 3, 2, flat);
  Faces faces;
  const Index at = grid.vertex(-1, 1);
  for (Index f = 0; f < grid.faces.size(); ++f) {
    const auto face = grid.faces[f];
    if (face[0] == at) {  // a quad next to the side at i = 0, cut in two
      faces.add(std::array{face[0], face[1], face[2]});
      faces.add(std::array{face[0], face[2], face[3]});
    } else {
      faces.add(face);
    }
  }
  const std::optional<QuadRows> rows = quad_rows(Connectivity(faces, grid.vertices.rows()), grid.rim);
  CHECK_FALSE(rows);  // the diagonal ends at the rim: five of its vertices have three faces
  grid = Grid(3, 3, 1, flat);
  REQUIRE(grid.known());
  CHECK(grid.known()->beyond() == std::array<Index, 4>{1, 1, 1, 1});
  faces = Faces();
  for (Index f = 0; f < grid.faces.size(); ++f) {
    const auto face = grid.faces[f];
    const bool corner = face[0] == grid.vertex(-1, -1);  // of the ring around: a triangle there ends two sides' rows
    if (corner)
      faces.add(std::array{face[1], face[2], face[3]});
    else
      faces.add(face);
  }
  const std::optional<QuadRows> three = quad_rows(Connectivity(faces, grid.vertices.rows()), grid.rim);
  REQUIRE(three);
  CHECK(std::ranges::count(three->beyond(), Index{1}) == 3);  // one of the two may still have a row, that ends at the corner
}

TEST_CASE("other rims are no blocks") {
  const Grid grid(3, 2, 2, flat);
  std::vector<Index> ring;  // an L: five corners turn one way, one the other
  Faces faces;
  for (Index f = 0; f < grid.faces.size(); ++f)
    if (grid.faces[f][0] != grid.vertex(-1, 0)) faces.add(grid.faces[f]);
  std::vector<Index> rim = grid.rim;
  rim.insert(rim.end() - 1, {grid.vertex(-1, 1), grid.vertex(-1, 0)});
  rim.erase(rim.end() - 1);
  rim.insert(rim.begin(), grid.vertex(0, 1));
  std::rotate(rim.begin(), rim.begin() + 1, rim.end());
  CHECK_FALSE(quad_rows(Connectivity(faces, grid.vertices.rows()), rim));
}

TEST_CASE("the last rows around a tube are a block: its rows meet themselves") {
  const Index around = 6, along = 6;
  Points vertices(around * (along + 1), 3);
  Faces faces;
  for (Index k = 0; k < vertices.rows(); ++k) {
    const double turn = 2 * std::numbers::pi * static_cast<double>(k % around) / around;
    const Index row = k / around;
    vertices.row(k) << std::cos(turn), std::sin(turn), static_cast<double>(row);
  }
  const auto at = [&](Index i, Index j) { return j * around + (i % around); };
  for (Index j = 0; j < along; ++j)
    for (Index i = 0; i < around; ++i)
      if (!(i < 4 && j > 1 && j < 4)) faces.add(std::array{at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
  std::vector<Index> rim;
  for (Index i = 0; i < 4; ++i) rim.push_back(at(i, 2));
  for (Index j = 2; j < 4; ++j) rim.push_back(at(4, j));
  for (Index i = 4; i > 0; --i) rim.push_back(at(i, 4));
  for (Index j = 4; j > 2; --j) rim.push_back(at(0, j));
  const std::optional<QuadRows> rows = quad_rows(Connectivity(faces, vertices.rows()), rim);
  REQUIRE(rows);
  CHECK(rows->beyond() == std::array<Index, 4>{2, 2, 2, 2});
  const ContinuedRows made = continued_rows(vertices, *rows);
  for (Index k = 0; k < made.inside.rows(); ++k) CHECK(made.inside.row(k).head<2>().norm() == Approx(1).margin(0.02));
}

TEST_CASE("what runs along rows and what runs across them is continued exactly, creases too") {
  const At bevels = [](double i, double j) {  // a bevel across the rows, a step and a wave across the columns
    return Vec3(i, j + (j > 2 ? 0.5 : 0), std::min(std::abs(i - 1.5), 1.0) + (j > 3 ? 1 : 0) + 0.3 * std::sin(j));
  };
  CHECK(off(5, 6, 2, bevels) < 1e-12);
  CHECK(off(5, 6, 1, bevels) < 1e-12);
}

TEST_CASE("cubics along rows are continued exactly, whatever they are from row to row") {
  const At cubic = [](double i, double j) {
    const double wild = std::sin(7 * j * j);
    return Vec3(i + 0.1 * j, j + 0.01 * i * i * wild, 0.02 * i * i * i * wild + std::cos(j));
  };
  const Grid grid(6, 5, 3, cubic);
  const QuadRows rows = grid.known().value();
  CHECK(continued_rows(grid.vertices, rows).order >= 2);
  CHECK(off(grid, cubic) < 1e-10);
}

TEST_CASE("on a ball, what is continued comes nearer with the fourth power of the rows' distance and more") {
  double last = 0;
  for (const double step : {0.2, 0.1, 0.05}) {
    const double now = off(6, 4, 3, [&](double i, double j) { return on_ball(i, j, step); });
    if (last > 0) CHECK(now < last / 16);
    last = now;
  }
  CHECK(last < 1e-7);
}

TEST_CASE("rows are continued alike in a mirror, turned, moved and as large as one likes") {
  const At at = [](double i, double j) { return Vec3(i + 0.2 * std::sin(j), j, 0.3 * std::sin(0.8 * i) * std::cos(j)); };
  const Grid grid(5, 4, 2, at);
  const Points plain = continued_rows(grid.vertices, grid.known().value()).inside;
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  for (const double size : {1e-6, 1.0, 1e6}) {
    const auto moved = [&](const Points& p) {
      return Points((size * p * turn.transpose()).rowwise() + size * Eigen::RowVector3d(3, -2, 5));
    };
    const Points other = continued_rows(moved(grid.vertices), grid.known().value()).inside;
    CHECK((other - moved(plain)).norm() < 1e-11 * size);
  }
  Grid mirrored(5, 4, 2, [&](double i, double j) { return at(5 - i, j); });
  const Points back = continued_rows(mirrored.vertices, mirrored.known().value()).inside;
  for (Index i = 1; i < 5; ++i)
    for (Index j = 1; j < 4; ++j) CHECK((back.row((i - 1) * 3 + j - 1) - plain.row((4 - i) * 3 + j - 1)).norm() < 1e-12);
}

TEST_CASE("a bevel beside one side says nothing of the block") {
  const At at = [](double i, double j) { return Vec3(i, j, i < 0 ? 2 * i : 0.05 * i * i * std::cos(0.5 * j)); };
  const Grid grid(4, 4, 3, at);
  const ContinuedRows made = continued_rows(grid.vertices, grid.known().value());
  CHECK(made.missed < 0.05);  // the side at i = 0 is missed by some 2
}

TEST_CASE("the surface through rows meets them, is twice differentiable and cubic") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> some(-1, 1);
  const std::vector<double> u = {-1, 0, 0.7, 2, 3.5}, v = {-2, -1, 0, 0.5, 1.5, 2};
  Points points(30, 3);
  for (Index k = 0; k < 30; ++k) points.row(k) << some(random), some(random), some(random);
  const RowsSurface surface(u, v, points);
  const auto jets = [&](double x, double y) {
    std::array<double, 45> out{};
    const std::array<double, 3> place = {x, y, 0};
    surface.evaluate(place.data(), 1, 4, out.data());
    return out;
  };
  for (std::size_t i = 0; i < u.size(); ++i)
    for (std::size_t j = 0; j < v.size(); ++j)
      CHECK((Vec3::Map(jets(u[i], v[j]).data()) - points.row(static_cast<Index>(i * v.size() + j)).transpose()).norm() < 1e-12);
  for (double knot : {0.7, 2.0}) {  // values, slopes and curvatures on both sides
    const auto before = jets(knot - 1e-12, 0.3), after = jets(knot + 1e-12, 0.3);
    for (std::size_t k = 0; k < 18; ++k) CHECK(before[k] == Approx(after[k]).margin(1e-9));
  }
  const double h = 1e-5;
  const auto here = jets(1.1, 0.2), right = jets(1.1 + h, 0.2), left = jets(1.1 - h, 0.2), up = jets(1.1, 0.2 + h),
             down = jets(1.1, 0.2 - h);
  for (int order = 0; order < 4; ++order)
    for (int j = 0; j <= order; ++j)
      for (int x = 0; x < 3; ++x) {
        const int i = order - j;
        const auto at = [&](const auto& jet, int a, int b) {
          return jet[3 * static_cast<std::size_t>(jet_index(a, b)) + static_cast<std::size_t>(x)];
        };
        CHECK((i + 1) * at(here, i + 1, j) == Approx((at(right, i, j) - at(left, i, j)) / (2 * h)).margin(1e-5));
        CHECK((j + 1) * at(here, i, j + 1) == Approx((at(up, i, j) - at(down, i, j)) / (2 * h)).margin(1e-5));
      }
}

TEST_CASE("a fill of rows is quads with the rim's own vertices, on a surface with its normals, facing as the mesh does") {
  const At at = [](double i, double j) { return on_ball(i, j, 0.1); };
  const Grid grid(5, 3, 3, at);
  FillOptions options;
  options.rim = grid.rim;
  const Mesh mesh{grid.vertices, grid.faces};
  const FillContext ground(mesh, options.rim, options);
  const std::optional<Fill> fill = fill_with_rows(ground, grid.rim, Output::quads);
  REQUIRE(fill);
  CHECK(fill->faces.size() == 15);
  CHECK(fill->vertices.rows() == 8);
  CHECK(fill->report.triangles_folded == 0);
  const Points on = fill->patch->positions(as_rows(fill->uv));
  CHECK((on - fill->vertices).norm() < 1e-12);
  for (Index k = 0; k < fill->vertices.rows(); ++k)
    CHECK(testing::degrees_between(Vec3(fill->normals.row(k)), Vec3(fill->vertices.row(k))) < 0.02);
  for (Index k = 0; k < fill->rim_normals.rows(); ++k)
    CHECK(testing::degrees_between(Vec3(fill->rim_normals.row(k)),
                                   Vec3(grid.vertices.row(fill->rim[static_cast<std::size_t>(k)]))) < 0.02);
  const std::optional<Fill> halves = fill_with_rows(ground, grid.rim, Output::triangles);
  CHECK(halves->faces.size() == 30);
  CHECK((halves->vertices - fill->vertices).norm() == 0);
}

namespace {

/// The middles of a fill's faces, sorted.
std::vector<std::array<double, 3>> middles(const Grid& grid, const Fill& fill) {
  const Points all = stacked(grid.vertices, fill.vertices);
  std::vector<std::array<double, 3>> found;
  for (Index f = 0; f < fill.faces.size(); ++f) {
    Vec3 middle = Vec3::Zero();
    for (const Index v : fill.faces[f]) middle += all.row(v).transpose() / static_cast<double>(fill.faces[f].size());
    found.push_back({middle[0], middle[1], middle[2]});
  }
  std::sort(found.begin(), found.end());
  return found;
}

double farthest(const std::vector<std::array<double, 3>>& some, const std::vector<std::array<double, 3>>& others) {
  if (some.size() != others.size()) return INFINITY;
  double most = 0;
  for (std::size_t k = 0; k < some.size(); ++k)
    most = std::max(most, (Vec3::Map(some[k].data()) - Vec3::Map(others[k].data())).norm());
  return most;
}

}  // namespace

TEST_CASE("the points of a cage without corners are those of the rows, whatever block it is and wherever its rim begins") {
  const At at = [](double i, double j) { return Vec3(i + 0.01 * j, j + 0.02 * i, 0.03 * i * i - 0.02 * j * j + 0.01 * i * j); };
  for (const std::array<Index, 2> size : {std::array<Index, 2>{2, 2}, {2, 5}, {5, 2}, {3, 4}, {4, 3}, {6, 5}}) {
    const Grid grid(size[0], size[1], 3, at);
    const Mesh mesh{grid.vertices, grid.faces};
    for (const std::size_t turn : {std::size_t{0}, std::size_t{1}, grid.rim.size() / 2}) {
      FillOptions options;
      options.rim = grid.rim;
      std::rotate(options.rim->begin(), options.rim->begin() + static_cast<std::ptrdiff_t>(turn), options.rim->end());
      const std::optional<Fill> rows = fill_with_rows(FillContext(mesh, options.rim, options), *options.rim, Output::quads);
      REQUIRE(rows);
      options.output = Output::cage;
      const Fill cage = fill(mesh, options);
      CHECK(cage.report.cage_in_rows);
      CHECK(cage.report.poles.empty());
      CHECK(farthest(middles(grid, cage), middles(grid, *rows)) < 1e-12);
    }
  }
}

TEST_CASE("cages far apart are made together as each by itself, and a rim that is refused leaves the others") {
  constexpr Index n = 26, m = 10;
  const auto at = [](Index i, Index j) { return i * (m + 1) + j; };
  Points vertices((n + 1) * (m + 1), 3);
  Faces faces;
  for (Index i = 0; i <= n; ++i)
    for (Index j = 0; j <= m; ++j) {
      const double x = static_cast<double>(i), y = static_cast<double>(j);
      vertices.row(at(i, j)) << x, y, 0.2 * std::sin(0.5 * x) * std::cos(0.4 * y);
      const bool gone = j >= 4 && j < 6 && ((i >= 4 && i < 7) || (i >= 19 && i < 22));
      if (i < n && j < m && !gone) faces.add(std::array{at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  const auto rim = [&](Index first) {
    std::vector<Index> loop;
    for (Index i = 0; i < 3; ++i) loop.push_back(at(first + i, 4));
    for (Index j = 4; j < 6; ++j) loop.push_back(at(first + 3, j));
    for (Index i = 3; i > 0; --i) loop.push_back(at(first + i, 6));
    for (Index j = 6; j > 4; --j) loop.push_back(at(first, j));
    return loop;
  };
  const Mesh mesh{vertices, faces};
  FillOptions options;
  options.output = Output::cage;
  std::size_t told = 0;
  const auto results = fill_all(mesh, {rim(4), rim(11), rim(19)}, options, {}, [&](std::size_t done) { told = done; });
  CHECK(told == 3);
  REQUIRE(results.size() == 3);
  CHECK(std::holds_alternative<Refused>(results[1]));
  for (const std::size_t k : {0, 2}) {
    options.rim = rim(k == 0 ? 4 : 19);
    const Fill alone = fill(mesh, options);
    REQUIRE(std::holds_alternative<Fill>(results[k]));
    CHECK((std::get<Fill>(results[k]).vertices - alone.vertices).norm() < 1e-12);
  }
}

TEST_CASE("cages of other than a smooth rim, of triangles, with rows or corners that are given are not put into rows") {
  const Grid grid(4, 3, 3, [](double i, double j) { return Vec3(i, j, 0.1 * std::sin(i) * std::cos(j)); });
  const Mesh mesh{grid.vertices, grid.faces};
  FillOptions plain;
  plain.rim = grid.rim;
  plain.output = Output::cage;
  const auto in_rows = [&](const FillOptions& options) { return fill(mesh, options).report.cage_in_rows; };
  CHECK(in_rows(plain));
  FillOptions exact = plain, free = plain, more = plain, given = plain, tense = plain, raised = plain, centered = plain,
              full = plain;
  exact.cage_rim = CageRim::exact;
  free.cage_rim = CageRim::move;
  more.resolution = 1;
  given.corners = {grid.vertex(0, 0), grid.vertex(4, 0), grid.vertex(4, 3), grid.vertex(0, 3)};
  tense.tension = 0.2;
  raised.center_offset = 0.1;
  centered.center = Vec3(2, 1.5, 0.5);
  full.bulge = each_side(1.2);
  for (const FillOptions& other : {exact, free, more, given, tense, raised, centered, full}) CHECK_FALSE(in_rows(other));
  plain.resolution = 0;
  CHECK(in_rows(plain));
}

TEST_CASE("what rows say of their surroundings is the angle that what is missed has over an edge of the rim") {
  const Grid grid(4, 3, 2, [](double i, double j) { return Vec3(2 * i, j, 0.2 * std::sin(i) * std::cos(j)); });
  FillOptions options;
  options.rim = grid.rim;
  const Mesh mesh{grid.vertices, grid.faces};
  const Fill made = fill_with_rows(FillContext(mesh, options.rim, options), grid.rim, Output::quads).value();
  double edges = 0;
  for (std::size_t k = 0; k < grid.rim.size(); ++k)
    edges += (grid.vertices.row(grid.rim[k]) - grid.vertices.row(grid.rim[(k + 1) % grid.rim.size()])).norm();
  REQUIRE(made.deviation[0] > 1e-3);
  const double angle = std::atan2(made.deviation[0], edges / static_cast<double>(grid.rim.size())) * 180 / std::numbers::pi;
  CHECK(made.report.surroundings_error == Approx(angle));
  CHECK(made.report.deviation_max.value() == made.deviation[0]);
}

TEST_CASE("a single row is no fill where the mesh joins what it would join") {
  const Grid grid(4, 1, 1, flat);
  FillOptions options;
  options.rim = grid.rim;
  const Mesh mesh{grid.vertices, grid.faces};
  CHECK(fill_with_rows(FillContext(mesh, options.rim, options), grid.rim, Output::quads)->faces.size() == 4);
  Faces more = grid.faces;  // a further face at the edge that the new quads would share
  Points vertices = stacked(grid.vertices, Points(Points::Constant(1, 3, 2)));
  more.add(std::array{grid.vertex(2, 0), vertices.rows() - 1, grid.vertex(2, 1)});
  const Mesh joined{vertices, more};
  const FillContext ground(joined, options.rim, options);
  CHECK_FALSE(fill_with_rows(ground, grid.rim, Output::quads));
}

TEST_CASE("what is missed is said as of the middle, alike in small blocks and in large ones") {
  const At waves = [](double i, double j) { return Vec3(i, j, std::sin(0.25 * i + 0.4) * std::cos(0.25 * j)); };
  std::vector<double> ratios;
  for (const Index n : {3, 6, 12}) {
    const Grid grid(n, n, 3, waves);
    ratios.push_back(continued_rows(grid.vertices, grid.known().value()).missed / off(grid, waves));
  }
  const auto [least, most] = std::ranges::minmax(ratios);
  CHECK(most < 4 * least);  // to the power of 1 or 3 of the edges across it is more than 4 or 8 times
  CHECK(least > 0.3);
  CHECK(most < 5);
}

TEST_CASE("rows that are asked for take the corners that they have, in any order, and refuse others by the rim") {
  const Grid grid(3, 4, 3, [](double i, double j) { return Vec3(i, j, 0.05 * i * j); });
  const Mesh mesh{grid.vertices, grid.faces};
  FillOptions options;
  options.rim = grid.rim;
  options.method = rows_method;
  options.output = Output::quads;
  const std::vector<Index> own = {grid.vertex(0, 0), grid.vertex(3, 0), grid.vertex(3, 4), grid.vertex(0, 4)};
  options.corners = {own[2], own[3], own[0], own[1]};
  CHECK(fill(mesh, options).report.method == rows_method);
  for (const std::vector<Index>& others : {std::vector<Index>{own[0], own[1], own[2]},
                                           {own[0], own[1], own[2], grid.vertex(0, 3)},
                                           {own[0], grid.vertex(1, 0), own[1], own[2], own[3]}}) {
    options.corners = others;
    CHECK(refusal_code([&] { fill(mesh, options); }) == "no_rows_of_quads");
  }
}
