#include <cstring>

#include "test_surfaces.h"
#include "tripatch/constructions/nielson_blend.h"
#include "tripatch/constructions/side_vertex.h"
#include "tripatch/fairing/curvature_variation.h"
#include "tripatch/fairing/fairing_space.h"
#include "tripatch/math/parallel.h"
#include "tripatch/math/triangular_grid.h"
#include "tripatch/patch/moved_surface.h"
#include "tripatch/patch/simd.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

/// Points all over the triangle, on its sides, next to its vertices and as near to two of them as to each other.
Points scattered(Index n) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  Points b(n, 3);
  for (Index k = 0; k < n; ++k) {
    const Index i = k % 3;
    const double near = k % 5 == 0 ? 1 - std::pow(10, -6 * unit(random)) : unit(random);
    const double along = k % 7 == 0 ? 0.5 : unit(random);
    b(k, i) = k % 11 == 0 ? 0 : near;
    b(k, (i + 1) % 3) = (1 - b(k, i)) * along;
    b(k, (i + 2) % 3) = 1 - b(k, i) - b(k, (i + 1) % 3);
  }
  return b;
}

/// The number of coefficients that are not the same bit for bit when points are evaluated one by one and together.
int differing(const Surface& surface, const Points& b, int order) {
  const Index row = 3 * jet_size(order);
  std::vector<double> together(b.rows() * row), alone(row);
  surface.evaluate(b.data(), b.rows(), order, together.data());
  int count = 0;
  for (Index k = 0; k < b.rows(); ++k) {
    surface.evaluate(b.data() + 3 * k, 1, order, alone.data());
    for (Index c = 0; c < row; ++c) count += alone[c] != together[k * row + c];
  }
  return count;
}

/// Sides of several pieces each.
Boundary pieces() {
  Sides sides = skewed_sides(unrelated_surfaces(3));
  for (Side& side : sides) side.c = side.c.refined({0.21, 0.5, 0.77}, 0);
  return make_boundary(sides);
}

}  // namespace

TEST_CASE("points that are evaluated together have the bits of points evaluated one by one") {
  const Boundary boundary = pieces();
  const std::array<PiecewisePolynomial, 3> slopes = {boundary.ribbons[0].d, boundary.ribbons[1].d, boundary.ribbons[2].d};
  const int degree = 5;
  const SurfacePtr added = correction(slopes, degree, 3, Points::Random(scalars(degree, 3), 3)),
                   less = correction(slopes, degree, 0, Points::Random(scalars(degree, 0), 3));
  const Index on_threads = 2001;
  for (const SurfacePtr& surface :
       {side_vertex(boundary), curved_side_vertex(boundary), added, less, sum(curved_side_vertex(boundary), added)})
    for (int order = 0; order <= 4; ++order) {
      CAPTURE(order);
      for (const Index n : {Index{4}, Index{5}, Index{203}, on_threads}) CHECK(differing(*surface, scattered(n), order) == 0);
      CHECK(differing(*surface, TriangularGrid{30}.barycentric(), order) == 0);  // neighbors in one piece of a side
    }
}

TEST_CASE("positions and first derivatives are those that jets of a higher order have") {
  const Boundary boundary = pieces();
  const std::array<PiecewisePolynomial, 3> slopes = {boundary.ribbons[0].d, boundary.ribbons[1].d, boundary.ribbons[2].d};
  const Points b = scattered(1003);
  for (const int degree : {0, 4, highest_interior}) {
    const SurfacePtr added = correction(slopes, degree, 3, Points::Random(scalars(degree, 3), 3)),
                     less = correction(slopes, degree, 0, Points::Random(scalars(degree, 0), 3));
    for (const SurfacePtr& surface : {side_vertex(boundary), curved_side_vertex(boundary), added, less}) {
      std::vector<double> places(3 * b.rows()), first(9 * b.rows()), more(18 * b.rows());
      surface->evaluate(b.data(), b.rows(), 0, places.data());
      surface->evaluate(b.data(), b.rows(), 1, first.data());
      surface->evaluate(b.data(), b.rows(), 2, more.data());
      double off = 0, off_slopes = 0;
      for (Index k = 0; k < b.rows(); ++k)
        for (int x = 0; x < 9; ++x) {
          const double jet = more[18 * k + x];
          if (x < 3) off = std::max({off, std::abs(first[9 * k + x] - jet), std::abs(places[3 * k + x] - jet)});
          const double rho = 1 - b.row(k).maxCoeff();  // the distance from a vertex, by which rounding grows
          if (x > 2 && rho > 1e-4) off_slopes = std::max(off_slopes, rho * std::abs(first[9 * k + x] - jet));
        }
      CHECK(off < 1e-13 * boundary.size);
      CHECK(off_slopes < 1e-12 * boundary.size);
    }
  }
}

TEST_CASE("positions and normals of many points are those that their derivatives have") {
  const Boundary boundary = pieces();
  const std::array<PiecewisePolynomial, 3> slopes = {boundary.ribbons[0].d, boundary.ribbons[1].d, boundary.ribbons[2].d};
  const double small = 0.02 * boundary.size;
  const auto added = [&](int degree, int second_cross) {
    return correction(slopes, degree, second_cross, small * Points::Random(scalars(degree, second_cross), 3));
  };
  const SurfacePtr plain = side_vertex(boundary), faired = sum(plain, added(4, 4));
  const SerialScope serial;
  for (const SurfacePtr& surface :
       {plain, faired, sum(faired, added(9, 0)), sum(plain, added(6, 3)), moved(faired, Vec3(1, 2, 3)),
        curved_side_vertex(boundary), sum(curved_side_vertex(boundary), added(4, 4)),
        sum(sum(curved_side_vertex(boundary), added(4, 4)), added(9, 0))})
    for (const Points& b : {scattered(2003), TriangularGrid{60}.barycentric()}) {
      std::vector<double> jets(9 * b.rows());
      surface->evaluate(b.data(), b.rows(), 1, jets.data());
      const auto [positions, normals] = surface->positions_and_normals(b);
      double off = 0, off_normals = 0;
      for (Index k = 0; k < b.rows(); ++k) {
        off = std::max(off, (positions.row(k).transpose() - Vec3::Map(&jets[9 * k])).norm());
        const Vec3 normal = Vec3::Map(&jets[9 * k + 3]).cross(Vec3::Map(&jets[9 * k + 6])).normalized();
        const double rho = 1 - b.row(k).maxCoeff();  // the distance from a vertex, by which rounding grows
        off_normals = std::max(off_normals, std::min(1.0, std::max(rho, 1e-8)) * (normals.row(k).transpose() - normal).norm());
      }
      CHECK(off < 1e-13 * boundary.size);
      CHECK(off_normals < 1e-12);
      CHECK(normals == surface->normals(b));
    }
}

TEST_CASE("many points have the bits that they have among others") {
  const SurfacePtr surface = side_vertex(pieces());
  const Index fewer = 1501;
  for (const Points& b : {scattered(3000), TriangularGrid{75}.barycentric()}) {
    const auto [positions, normals] = surface->positions_and_normals(b);
    const auto [last_positions, last_normals] = surface->positions_and_normals(Points(b.bottomRows(fewer)));
    CHECK(last_positions == positions.bottomRows(fewer));
    CHECK(last_normals == normals.bottomRows(fewer));
  }
}

namespace {

template <class P>
void check_field(const PiecewisePolynomial& c) {
  const PackedField packed(c);
  for (const std::array<double, 4>& t :
       {std::array{0.0, 0.21, 0.5, 1.0}, {0.3, 0.31, 0.32, 0.33}, {-0.1, 1.1, 0.77, 0.769}, {0.6, 0.61, 0.62, 0.63}}) {
    P at;
    std::memcpy(&at, t.data(), sizeof at);
    P out[3][3];
    packed.taylor<2>(packed.places(at), out);
    for (int lane = 0; lane < width_of<P>; ++lane) {
      std::array<double, 9> one;
      c.taylor(t[lane], 2, one.data());
      for (int k = 0; k < 9; ++k) CHECK(number(out[k / 3][k % 3], lane) == one[k]);
    }
  }
}

}  // namespace

TEST_CASE("a packed field has the pieces of the field it is made of") {
  const PiecewisePolynomial c = pieces().ribbons[0].c;
  REQUIRE(c.pieces() > 3);
  check_field<double>(c);
#ifdef TRIPATCH_PACKS
  if (has_packs()) check_field<Pack>(c);
#endif
}

TEST_CASE("curvature varies to the last bit the same at many points as at each") {
  std::vector<Derivatives> d;
  for (int k = 0; k < 7; ++k) d.emplace_back(Derivatives::Random());
  d[2].row(0).setZero();  // neither number nor frame
  const double flat = 1e-3;
  std::vector<CurvatureVariation> all(d.size());
  std::vector<CurvatureVariationRows> rows(d.size());
  curvature_variations(d, flat, all.data());
  curvature_variation_rows(d, flat, rows.data());
  const auto same = [](const auto& a, const auto& b) { return (a.array() == b.array()).all(); };
  for (std::size_t k = 0; k < d.size(); ++k) {
    CAPTURE(k);
    const CurvatureVariation one = curvature_variation(d[k], flat);
    const CurvatureVariationRows one_rows = curvature_variation_rows(d[k], flat);
    CHECK(std::isfinite(one.quadric.sum()) == (k != 2));
    if (k == 2) continue;
    CHECK(all[k].area == one.area);
    CHECK(same(all[k].variation, one.variation));
    CHECK(same(all[k].quadric, one.quadric));
    CHECK(same(rows[k].value, one_rows.value));
    CHECK(same(rows[k].derivative, one_rows.derivative));
  }
}
