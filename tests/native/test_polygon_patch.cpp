// Patches of four sides and more: what they promise along their sides, and what they make of surfaces that are known.
#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <numbers>

#include "test_curvature_jumps.h"
#include "test_refusals.h"
#include "test_surfaces.h"
#include "tripatch/output/polygon_cover.h"
#include "tripatch/polygon/joined.h"
#include "tripatch/polygon/patch.h"
#include "tripatch/polygon/space.h"
#include "tripatch/quads/quad_smoothing.h"

using namespace tripatch;
using tripatch::testing::curvature_jump;
using tripatch::testing::degrees_between;

namespace {

/// A surface over a plane of its own from one formula on jets.
template <int N>
using Formula = JetPoint<N> (*)(const Jet<N>&, const Jet<N>&);
struct Known {
  Formula<2> at;
  double (*distance)(const Vec3&);
};

template <int N>
JetPoint<N> sphere_at(const Jet<N>& x, const Jet<N>& y) {
  const Jet<N> d = reciprocal(1.0 + (x * x + y * y));
  JetPoint<N> p;
  p.x = {2.0 * (x * d), 2.0 * (y * d), (1.0 - (x * x + y * y)) * d};
  return p;
}
const Known sphere = {sphere_at<2>, [](const Vec3& p) { return std::abs(p.norm() - 1); }};

template <int N>
JetPoint<N> saddle_at(const Jet<N>& x, const Jet<N>& y) {
  JetPoint<N> p;
  p.x = {x, y, 0.5 * (x * x - y * y)};
  return p;
}
const Known saddle = {saddle_at<2>, [](const Vec3& p) { return std::abs(p[2] - 0.5 * (p[0] * p[0] - p[1] * p[1])); }};

template <int N>
JetPoint<N> plane_at(const Jet<N>& x, const Jet<N>& y) {
  JetPoint<N> p;
  p.x = {x + 0.2 * (y * y), y, Jet<N>(0.0)};
  return p;
}
const Known plane = {plane_at<2>, [](const Vec3& p) { return std::abs(p[2]); }};

/// A torus of radius 1 and a tube of radius 1 / Tenth by the tangents of half the angles round the axis and the tube.
template <int N, int Tenth>
JetPoint<N> torus_at(const Jet<N>& x, const Jet<N>& y) {
  const Jet<N> round = reciprocal(1.0 + x * x), over = reciprocal(1.0 + y * y);
  const Jet<N> radius = 1.0 + (1.0 / Tenth) * ((1.0 - y * y) * over);
  JetPoint<N> p;
  p.x = {radius * ((1.0 - x * x) * round), radius * (2.0 * (x * round)), (2.0 / Tenth) * (y * over)};
  return p;
}
template <int Tenth>
const Known torus = {torus_at<2, Tenth>,
                     [](const Vec3& p) { return std::abs(std::hypot(std::hypot(p[0], p[1]) - 1, p[2]) - 1.0 / Tenth); }};

/// The corners of a strip of it: so many degrees round the axis and the tube.
std::vector<Vec2> strip_of_torus(double round, double over) {
  const double x = std::tan(round * std::numbers::pi / 720), y = std::tan(over * std::numbers::pi / 360);
  return {Vec2(-x, 0), Vec2(x, 0), Vec2(x, y), Vec2(-x, y)};
}

/// A side of a known surface along a parabola between two places of its plane, so high to the right of the line between them, its
/// surroundings as they are.
Side side_between(const Known& known, const Vec2& from, const Vec2& to, double high = 0) {
  const Vec2 line = to - from, right(line[1], -line[0]);
  const auto jets = [=](double t) {
    const Vec2 p = from + t * line + 4 * high * t * (1 - t) * right, along = line + 4 * high * (1 - 2 * t) * right;
    return known.at(Jet<2>::linear(p[0], along[0], along[1]), Jet<2>::linear(p[1], along[1], -along[0]));
  };
  const auto field = [&](int which, double factor) {
    return PiecewisePolynomial::fit(
        [&](std::span<const double> t, std::span<double> values) {
          for (std::size_t k = 0; k < t.size(); ++k) {
            const JetPoint<2> p = jets(t[k]);
            for (int x = 0; x < 3; ++x) values[3 * k + x] = factor * p.x[x].c[which];
          }
        },
        3);
  };
  return {field(0, 1), field(2, 1), field(jet_index(0, 2), 2)};
}

SideList sides_between(const Known& known, const std::vector<Vec2>& corners) {
  SideList sides;
  for (std::size_t i = 0; i < corners.size(); ++i)
    sides.push_back(side_between(known, corners[i], corners[(i + 1) % corners.size()]));
  return sides;
}

/// Of a lens: so high, of its length, below and above.
SideList lens_between(const Known& known, double below, double above) {
  const Vec2 left(-0.3, 0.1), right(0.5, 0.2);
  return {side_between(known, left, right, below), side_between(known, right, left, above)};
}

/// n corners about a place, a little uneven.
std::vector<Vec2> ring(int n, double radius = 0.4, double uneven = 0.1, const Vec2& middle = {0.1, 0.15}) {
  std::vector<Vec2> corners;
  for (int k = 0; k < n; ++k) {
    const double angle = 2 * std::numbers::pi * (k + uneven * std::sin(3.0 * k + 1)) / n,
                 r = radius * (1 + uneven * std::cos(5.0 * k));
    corners.emplace_back(middle + r * Vec2(std::cos(angle), std::sin(angle)));
  }
  return corners;
}

double largest_distance(const PolygonPatch& made, const Known& known) {
  const Points p = made.patch->positions(polygon_grid(made.domain, 8));
  double most = 0;
  for (Index k = 0; k < p.rows(); ++k) most = std::max(most, known.distance(p.row(k)));
  return most;
}

/// Largest distance from the sides' curves.
double curve_error(const PolygonPatch& made) {
  double most = 0;
  for (int i = 0; i < made.domain.sides(); ++i)
    for (int k = 0; k <= 40; ++k) {
      const Vec2 p = made.domain.on_side(i, k / 40.0);
      const std::array<double, 3> row = {p[0], p[1], 0};
      most = std::max(
          most,
          (Vec3(made.patch->positions(Eigen::Map<const Points>(row.data(), 1, 3)).row(0)) - made.sides[i].c(k / 40.0)).norm());
    }
  return most;
}

double seam(const PolygonPatch& made) { return *std::max_element(made.seam_angle_max.begin(), made.seam_angle_max.end()); }

Points middle_of(const PolygonPatch& made) {
  Points row = Points::Zero(1, 3);
  row.row(0).head<2>() = made.domain.center();
  return row;
}

const PolygonPatchOptions plain = [] {
  PolygonPatchOptions options;
  options.fairing.reset();
  return options;
}();

}  // namespace

TEST_CASE("polygon patch: sides and tangent planes are met, plain and fair") {
  for (const Known& known : {sphere, saddle})
    for (int n : {4, 5, 6, 8, 12})
      for (const PolygonPatchOptions& options : {plain, PolygonPatchOptions()}) {
        const PolygonPatch made = polygon_patch(sides_between(known, ring(n)), options);
        CAPTURE(n, made.fairing);
        CHECK(curve_error(made) < 1e-12);
        CHECK(seam(made) < 1e-5);
      }
}

TEST_CASE("polygon patch: between two sides planes and curvature are met, plain and fair, bent either way") {
  for (const Known& known : {sphere, saddle})
    for (const auto& [below, above] : {std::array{0.3, 0.3}, {0.15, 0.4}, {0.5, -0.2}})
      for (SideContinuity continuity : {SideContinuity::g1, SideContinuity::g2}) {
        PolygonPatchOptions options = below < 0.2 ? plain : PolygonPatchOptions();
        options.continuity = {continuity};
        const PolygonPatch made = polygon_patch(lens_between(known, below, above), options);
        CAPTURE(below, above);
        CHECK(curve_error(made) < 1e-12);
        CHECK(seam(made) < 1e-5);
        if (continuity == SideContinuity::g2)
          CHECK(curvature_jump(*made.patch, made.domain, made.sides) < 1e-5);
        else
          CHECK(largest_distance(made, known) < (options.fairing ? 1e-3 : 3e-2));
      }
}

TEST_CASE("polygon patch: a lens is as smooth at its corners as its sides agree there") {
  const PolygonPatch made = polygon_patch(lens_between(saddle, 0.2, 0.3), plain);
  for (int corner : {0, 1}) {
    std::vector<Vec3> normals;
    for (double w : {-0.9, 0.0, 0.9}) {  // three ways to the corner
      const double x = 1e-4, hill = 4 * made.domain.height() * x * (1 - x) * w;
      Points at = Points::Zero(1, 3);
      at.row(0).head<2>() = made.domain.corner(corner) * (1 - 2 * x) + hill * Vec2::UnitY();
      normals.emplace_back(made.patch->normals(at).row(0));
    }
    CHECK(degrees_between(normals[0], normals[1]) < 0.05);
    CHECK(degrees_between(normals[2], normals[1]) < 0.05);
    CHECK(degrees_between(normals[1], made.sides[corner].normal(0)) < 0.05);
  }
}

TEST_CASE("polygon patch: points inside a lens are met, and its middle") {
  PolygonPatchOptions options;
  const SideList sides = lens_between(saddle, 0.3, 0.3);
  options.center = Vec3(0.1, 0.15, 0.06);
  const PolygonPatch made = polygon_patch(sides, options);
  CHECK((Vec3(made.patch->positions(middle_of(made)).row(0)) - *options.center).norm() < 1e-12);
  CHECK(seam(made) < 1e-5);
}

TEST_CASE("polygon patch: a side in pieces is the side") {
  const std::vector<Vec2> corners = ring(4);
  SideList whole = sides_between(saddle, corners), cut = whole;
  cut[1] = joined({piece_of(whole[1], 0, 0.3), piece_of(whole[1], 0.3, 0.75), piece_of(whole[1], 0.75, 1)}).side;
  const PolygonPatch made = polygon_patch(cut);
  CHECK(seam(made) < 1e-5);
  CHECK(largest_distance(made, saddle) < 2 * largest_distance(polygon_patch(whole), saddle) + 1e-6);
  for (int k = 0; k <= 50; ++k) {
    // the curve is the same, its speed even, and nothing shows where pieces meet
    const double t = k / 50.0;
    CHECK(cut[1].c.derivative_at(t).norm() == Approx(arc_length(whole[1].c)).epsilon(1e-3));
    CHECK(std::abs(saddle.distance(cut[1].c(t))) < 1e-12);
  }
  CHECK(refusal_code([&] { joined({whole[0], whole[1]}); }) == "pieces_meet_at_angle");
  CHECK(refusal_code([&] { joined({whole[0], whole[2]}); }) == "pieces_apart");
}

TEST_CASE("polygon patch: a plane hole is filled with its plane") {
  CHECK(largest_distance(polygon_patch(lens_between(plane, 0.2, 0.5)), plane) < 1e-13);
  for (int n : {4, 7}) CHECK(largest_distance(polygon_patch(sides_between(plane, ring(n))), plane) < 1e-13);
}

TEST_CASE("polygon patch: a fair patch in a sphere is the sphere's") {
  for (int n : {4, 5, 6, 8}) {
    CAPTURE(n);
    CHECK(largest_distance(polygon_patch(sides_between(sphere, ring(n))), sphere) < 1e-4);
  }
}

TEST_CASE("polygon patch: a fillet, a strip of a torus, is made round") {
  // the energy of quadrics has a deep valley next to that of round sections: conics of revolution as far off as 3e-4
  CHECK(largest_distance(polygon_patch(sides_between(torus<10>, strip_of_torus(45, 60))), torus<10>) < 5e-6);
  CHECK(largest_distance(polygon_patch(sides_between(torus<10>, strip_of_torus(90, 60))), torus<10>) < 5e-6);
  CHECK(largest_distance(polygon_patch(sides_between(torus<20>, strip_of_torus(90, 90))), torus<20>) < 1e-5);
  // so long and narrow that fewer nodes see waves between them
  const PolygonPatch narrow = polygon_patch(sides_between(torus<50>, strip_of_torus(200, 90)));
  CHECK_FALSE(narrow.gave_up);
  CHECK(largest_distance(narrow, torus<50>) < 2e-6);
}

TEST_CASE("polygon patch: plain patches come nearer with the fourth power of the hole's size") {
  for (const Known& known : {sphere, saddle})
    for (int n : {4, 5, 6}) {
      CAPTURE(n);
      const double whole = largest_distance(polygon_patch(sides_between(known, ring(n, 0.2)), plain), known),
                   half = largest_distance(polygon_patch(sides_between(known, ring(n, 0.1)), plain), known);
      CHECK(half < whole / 3.5);
    }
}

TEST_CASE("polygon patch: the result does not depend on which corner is the first") {
  const SideList sides = sides_between(sphere, ring(5));
  SideList turned(sides.begin() + 2, sides.end());
  turned.insert(turned.end(), sides.begin(), sides.begin() + 2);
  const PolygonPatch a = polygon_patch(sides), b = polygon_patch(turned);
  CHECK((a.patch->positions(middle_of(a)) - b.patch->positions(middle_of(b))).norm() < 1e-7);
}

TEST_CASE("polygon patch: rigid motions and scales move it with its sides") {
  const SideList sides = sides_between(saddle, ring(6));
  const PolygonPatch still = polygon_patch(sides);
  const Points grid = polygon_grid(still.domain, 4);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  for (double scale : {1e-6, 1.0, 1e6}) {
    const Eigen::Matrix3d linear = scale * turn;
    const Vec3 shift = scale * Vec3(3, -2, 5);
    const auto moved = [&](const PiecewisePolynomial& f, const Vec3& by) {
      return PiecewisePolynomial::fit(
          [&](std::span<const double> t, std::span<double> out) {
            for (std::size_t k = 0; k < t.size(); ++k) Vec3::Map(&out[3 * k]) = linear * f(t[k]) + by;
          },
          3);
    };
    SideList there;
    for (const Side& side : sides)
      there.push_back({moved(side.c, shift), moved(side.r, Vec3::Zero()), moved(side.q, Vec3::Zero())});
    const PolygonPatch made = polygon_patch(there);
    const Points p = still.patch->positions(grid), q = made.patch->positions(grid);
    double most = 0;
    for (Index k = 0; k < p.rows(); ++k) most = std::max(most, (linear * Vec3(p.row(k)) + shift - Vec3(q.row(k))).norm() / scale);
    CAPTURE(scale);
    CHECK(most < 1e-6);
  }
}

TEST_CASE("polygon patch: sides whose planes or twists disagree at the corners are met beside them") {
  SideList sides = sides_between(sphere, ring(5));
  for (std::size_t i = 0; i < sides.size();
       ++i) {  // each plane turned about its side: by 9 degrees, and by as much more along it
    const Side side = sides[i];
    sides[i].r = PiecewisePolynomial::fit(
        [&](std::span<const double> t, std::span<double> out) {
          for (std::size_t k = 0; k < t.size(); ++k)
            Vec3::Map(&out[3 * k]) = side.r(t[k]) + 0.15 * (1 + t[k]) * side.r(t[k]).norm() * side.normal(t[k]);
        },
        3);
    sides[i].q = {};
  }
  const PolygonPatch made = polygon_patch(sides);
  CHECK(curve_error(made) < 1e-12);
  CHECK(seam(made) < 1e-5);
  const Points beside = (Points(2, 3) << made.domain.corner(0)[0], made.domain.corner(0)[1], 0,
                         made.domain.corner(2)[0] * (1 - 1e-7), made.domain.corner(2)[1] * (1 - 1e-7), 0)
                            .finished();
  std::vector<double> jets(2 * 30);
  made.patch->evaluate(beside.data(), 2, 3, jets.data());
  for (double x : jets) CHECK(std::isfinite(x));
}

TEST_CASE("polygon patch: derivatives are those of differences") {
  const PolygonPatch made = polygon_patch(sides_between(saddle, ring(7)));
  const Vec2 at(0.21, -0.13);
  const double h = 1e-5;
  const std::array<double, 15> rows = {at[0], at[1], 0,         at[0] + h, at[1], 0,         at[0] - h, at[1],
                                       0,     at[0], at[1] + h, 0,         at[0], at[1] - h, 0};
  std::vector<double> jets(5 * 30);
  made.patch->evaluate(rows.data(), 5, 3, jets.data());
  const auto get = [&](int point, int which) { return Vec3(Vec3::Map(&jets[30 * point + 3 * which])); };
  const std::array<double, 6> factor = {1, 1, 1, 2, 1, 2};
  for (int i = 0; i <= 2; ++i)
    for (int j = 0; i + j <= 2; ++j) {
      const Vec3 u = (get(1, jet_index(i, j)) - get(2, jet_index(i, j))) / (2 * h) / (i + 1),
                 v = (get(3, jet_index(i, j)) - get(4, jet_index(i, j))) / (2 * h) / (j + 1);
      CHECK((u - get(0, jet_index(i + 1, j))).norm() < 1e-6 * factor[5]);
      CHECK((v - get(0, jet_index(i, j + 1))).norm() < 1e-6 * factor[5]);
    }
}

TEST_CASE("polygon patch: points and normals inside are met exactly, with the sides") {
  const SideList sides = sides_between(saddle, ring(5));
  const PolygonPatch without = polygon_patch(sides);
  const Vec3 up = without.patch->normals(middle_of(without)).row(0);
  PolygonPatchOptions options;
  options.through = {{Vec3(without.patch->positions(middle_of(without)).row(0)) + 0.05 * up, {}},
                     {Vec3(0.25, 0.2, 0.03), Vec3(0.1, -0.2, 1).normalized()}};
  const PolygonPatch made = polygon_patch(sides, options);
  for (const Through& t : options.through) {
    double nearest = 1, off = 90;
    const Points grid = polygon_grid(made.domain, 40);
    Points place(1, 3);
    Index best = 0;
    (made.patch->positions(grid).rowwise() - t.point.transpose()).rowwise().norm().minCoeff(&best);
    place.row(0) = grid.row(best);
    for (int step = 0; step < 20; ++step) {  // Gauss-Newton
      std::array<double, 9> jets;
      made.patch->evaluate(place.data(), 1, 1, jets.data());
      Eigen::Matrix<double, 3, 2> d;
      d << Vec3::Map(&jets[3]), Vec3::Map(&jets[6]);
      const Vec3 rest = t.point - Vec3::Map(jets.data());
      nearest = rest.norm();
      if (t.normal) off = degrees_between(d.col(0).cross(d.col(1)), *t.normal);
      const Vec2 move = (d.transpose() * d).inverse() * (d.transpose() * rest);
      place(0, 0) += move[0];
      place(0, 1) += move[1];
    }
    CHECK(nearest < 1e-12);
    if (t.normal) CHECK(off < 1e-8);
  }
  CHECK(seam(made) < 1e-5);
}

TEST_CASE("polygon patch: G2 meets the curvature too") {
  PolygonPatchOptions options;
  options.continuity = {SideContinuity::g2};
  const PolygonPatch made = polygon_patch(sides_between(saddle, ring(6)), options);
  CHECK(curvature_jump(*made.patch, made.domain, made.sides) < 1e-5);
  CHECK(seam(made) < 1e-5);
}

TEST_CASE("polygon patch: the middle goes where it is asked") {
  const SideList sides = sides_between(sphere, ring(4));
  PolygonPatchOptions options;
  options.center_offset = 0.1;
  const PolygonPatch without = polygon_patch(sides), made = polygon_patch(sides, options);
  CHECK((made.patch->positions(middle_of(made)) - without.patch->positions(middle_of(without))).norm() ==
        Approx(0.1).epsilon(1e-9));
  CHECK(seam(made) < 1e-5);
}

TEST_CASE("polygon patch: what does not meet is refused with the corner and the gap") {
  SideList sides = sides_between(sphere, ring(5));
  sides[3] = moved_ends(sides[3], Vec3(0, 0, 0.01), Vec3::Zero());
  CHECK_THROWS_WITH(polygon_patch(sides), Catch::Contains("Sides 2 and 3 do not meet at corner 3: the gap is 0.01"));
  CHECK_THROWS_AS(polygon_patch(SideList(13, sides[0])), InvalidArgument);
}

TEST_CASE("polygon domain: it follows angles and lengths, and stays convex") {
  const double right = std::numbers::pi / 2;
  const PolygonDomain rectangle = polygon_like({right, right, right, right}, {2, 1, 2, 1});
  CHECK(rectangle.along(0, 0).norm() == Approx(2 * rectangle.along(1, 0).norm()));
  for (const std::vector<double>& turns : {std::vector<double>{3, 0, 0, -1, 2}, {0, 0, 0, 0}, {2.5, 2.5, 0.1, 0.1, 0.1, 0.1}}) {
    const PolygonDomain d = polygon_like(turns, std::vector<double>(turns.size(), 1.0));
    for (int i = 0; i < d.sides(); ++i)
      for (int k = 0; k < d.sides(); ++k)
        if (k != i && k != d.wrap(i + 1)) CHECK(d.inward(i).dot(d.corner(k) - d.corner(i)) > 0);
  }
}

TEST_CASE("polygon patch: a derivative across that fades to rounding at a corner is none, not a hundred billion times the hole") {
  SideList sides;
  const std::array<Vec2, 4> corner = {Vec2(0, 0), Vec2(1, 0), Vec2(1, 1), Vec2(0, 1)};
  for (int i = 0; i < 4; ++i) sides.push_back(side_between(plane, corner[i], corner[(i + 1) % 4]));
  sides[1].r = PiecewisePolynomial::linear(1 + 1e-15, 1e-15) * sides[1].r;
  sides[1].q = {};
  const PolygonPatch made = polygon_patch(sides, {});
  for (double u : {0.1, 0.5, 0.9}) {
    Points places = Points::Zero(1, 3);
    places.row(0).head<2>() = (1 - u) * made.domain.center() + u * made.domain.corner(2);
    CHECK(made.patch->positions(places).cwiseAbs().maxCoeff() < 2);
  }
}

TEST_CASE("polygon patch: what is kept for a domain is that of its own numbers") {
  const std::vector<Vec2> square = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}, wider = {{-1.5, -1}, {1.5, -1}, {1, 1}, {-1, 1}};
  const PolygonDomain first(square), second(wider), flat = PolygonDomain::lens(2, 0.3), high = PolygonDomain::lens(2, 0.6);
  const auto space = polygon_space(first, 4, 4, 3, 5);
  CHECK(polygon_space(PolygonDomain(square), 4, 4, 3, 5) == space);
  CHECK(polygon_space(second, 4, 4, 3, 5) != space);
  CHECK(polygon_space(flat, 4, 4, 3, 5) != polygon_space(high, 4, 4, 3, 5));
  CHECK(polygon_space(first, 5, 4, 3, 5) != space);
  CHECK(polygon_space(first, 4, 5, 3, 5) != space);
  CHECK(polygon_space(first, 4, 4, 4, 5) != space);
  CHECK(polygon_space(first, 4, 4, 3, 6) != space);
  const auto anew = polygon_space(first, 4, 4, 3, 5);
  CHECK(anew != space);  // only the last few are kept
  CHECK(anew->uv == space->uv);
  CHECK(anew->combination == space->combination);
}

TEST_CASE("polygon patch: one that is kept is taken where nothing has changed, and nowhere else") {
  const SideList known = sides_between(saddle, ring(4));
  const auto patch_of = [](const SideList& sides, const PolygonPatchOptions& options) {
    const PolygonPatch made = polygon_patch(sides, options);
    return made.patch->positions(polygon_grid(made.domain, 6));
  };
  const auto forget = [&] {
    for (double tension : {0.11, 0.12, 0.13, 0.14, 0.15}) {
      PolygonPatchOptions other;
      other.tension = tension;
      patch_of(known, other);
    }
  };
  std::vector<std::pair<SideList, PolygonPatchOptions>> variants(1, {known, {}});
  const auto vary = [&](auto&& change) {
    variants.push_back(variants[0]);
    change(variants.back().first, variants.back().second);
  };
  vary([](SideList& s, auto&) { s[0].q = {}; });
  vary([](SideList& s, auto&) { s[1].r = 1.25 * s[1].r; });
  vary([](SideList& s, auto&) { s[0].q = 2 * s[0].q; });
  vary([](auto&, PolygonPatchOptions& o) { o.continuity = {SideContinuity::g0}; });
  vary([](auto&, PolygonPatchOptions& o) { o.continuity = {SideContinuity::free}; });
  vary([](auto&, PolygonPatchOptions& o) { o.continuity = {SideContinuity::g2}; });
  vary([](auto&, PolygonPatchOptions& o) { o.bulge = {1, 1, 1.25, 1}; });
  vary([](auto&, PolygonPatchOptions& o) { o.fairing.reset(); });
  vary([](auto&, PolygonPatchOptions& o) { o.fairing = Fairing::thin_plate; });
  vary([](auto&, PolygonPatchOptions& o) { o.tension = 0.5; });
  vary([](auto&, PolygonPatchOptions& o) { o.center = Vec3(0.01, 0, 0.02); });
  vary([](auto&, PolygonPatchOptions& o) { o.center_offset = 0.0625; });
  vary([](auto&, PolygonPatchOptions& o) { o.through = {{Vec3(0.2, 0.1, 0.02), {}}}; });
  vary([](auto&, PolygonPatchOptions& o) { o.through = {{Vec3(0.2, 0.1, 0.02), Vec3(0.1, 0, 1)}}; });
  vary([&](auto&, PolygonPatchOptions& o) {
    std::vector<Vec2> corners = ring(4);
    corners[0] *= 1.25;
    o.domain = PolygonDomain(corners);
  });
  for (std::size_t k = 0; k < variants.size(); ++k) {
    CAPTURE(k);
    const auto& [sides, options] = variants[k];
    forget();
    const Points fresh = patch_of(sides, options);
    forget();
    const Points first = patch_of(known, {}), after = patch_of(sides, options);
    CHECK(after == fresh);
    CHECK(patch_of(sides, options) == fresh);
    if (k > 1) CHECK(first != fresh);  // the first is itself; without q curvature is not followed
  }
}

TEST_CASE("polygon patch: the middle at one place after the other is as at each alone") {
  for (int n : {4, 6})
    for (const Known& known : {saddle, sphere})
      for (const auto& fairing : {Fairing::automatic, Fairing::thin_plate, Fairing::quadric_variation}) {
        CAPTURE(n, static_cast<int>(fairing));
        const SideList sides = sides_between(known, ring(n));
        const auto at = [&](double offset, double tension = 0) {
          PolygonPatchOptions options;
          options.fairing = fairing;
          options.center_offset = offset;
          options.tension = tension;
          const PolygonPatch made = polygon_patch(sides, options);
          return made.patch->positions(polygon_grid(made.domain, 6));
        };
        const Points last = at(0.07);
        for (double tension : {0.11, 0.12, 0.13, 0.14, 0.15}) at(0, tension);  // only the last few are kept
        at(0.03);
        CHECK(at(-0.02) != last);
        CHECK(at(0.07) == last);
      }
}

TEST_CASE("polygon patch: vertices of quads go to places inside as long as no quad turns over") {
  const PolygonPatch made = polygon_patch(sides_between(plane, ring(4)), plain);
  constexpr int edges = 6;
  PlanePoints rim(4 * edges, 2);
  std::vector<RimCorner> corners;
  for (int i = 0; i < 4; ++i) {
    corners.push_back({i * edges, 1});
    for (int k = 0; k < edges; ++k) rim.row(i * edges + k) = made.domain.on_side(i, static_cast<double>(k) / edges);
  }
  Points uv = Points::Zero(rim.rows(), 3);
  uv.leftCols(2) = rim;
  const Points border = made.patch->positions(uv);
  LayoutOptions options;
  options.rows = 0;
  const Vec2 out = (made.domain.on_side(0, 0.5) - made.domain.center()) / 3, middle = made.domain.center();
  double least = 1;
  bool refused = false;
  for (double share = 0.8; share > 0; share -= 0.01) {  // of an edge, between two places
    const PlaneCover cover = cover_polygon_with_quads(rim, border, corners, *made.patch, options, {middle, middle + share * out});
    const bool met = cover.warnings.empty();
    for (const Vec2& place : {middle, Vec2(middle + share * out)})
      CHECK((!met || ((cover.uv.rowwise() - place.transpose()).rowwise().norm().array() < 1e-15).any()));
    refused = refused || !met;
    if (!met) continue;
    Points at = Points::Zero(cover.uv.rows(), 3);
    at.leftCols(2) = cover.uv;
    at = made.patch->positions(at);
    least = std::min(least, quad_quality(at, cover.faces).least);
  }
  CHECK(refused);
  CHECK(least > 0.25);
}

TEST_CASE("polygon patch: a normal that is given after another one at the same point is the one that is met") {
  const SideList sides = sides_between(saddle, ring(5));
  const PolygonPatch without = polygon_patch(sides);
  const Points place = middle_of(without);
  PolygonPatchOptions options;
  for (const Vec3& normal : {Vec3(0.1, -0.2, 1), Vec3(-0.3, 0.1, 1), Vec3(0.1, -0.2, 1)}) {
    options.center = Vec3(without.patch->positions(place).row(0));
    options.through = {{Vec3(0.25, 0.2, 0.03), normal.normalized()}};
    const PolygonPatch made = polygon_patch(sides, options);
    double nearest = 1, off = 90;
    const Points grid = polygon_grid(made.domain, 60);
    const Points p = made.patch->positions(grid), n = made.patch->normals(grid);
    Index best = 0;
    nearest = (p.rowwise() - options.through[0].point.transpose()).rowwise().norm().minCoeff(&best);
    off = degrees_between(n.row(best), normal);
    CHECK(nearest < 0.03);
    CHECK(off < 5);
  }
}

TEST_CASE("polygon patch: where a corner hardly turns the energy is gone down from several places") {
  // from the third-derivative solution alone it ends at 640, 5e-3 off
  const PolygonPatch made = polygon_patch(sides_between(saddle, ring(8, 0.4, 0.25)));
  CHECK(made.energy_after < 200);
  CHECK(largest_distance(made, saddle) < 3e-3);
}

TEST_CASE("polygon patch: corners that hardly turn are told, for without them it comes nearer") {
  const std::vector<Vec2> corners = ring(8, 0.4, 0.25);  // of which one turns by 4 degrees
  SideList sides = sides_between(saddle, corners);
  const PolygonPatch made = polygon_patch(sides);
  REQUIRE(made.warnings.size() == 1);
  CHECK(made.warnings[0].code == Code::straight_corner);
  CHECK(polygon_patch(sides_between(saddle, ring(8))).warnings.empty());
  const std::size_t corner = static_cast<std::size_t>(std::get<Index>(made.warnings[0].parameters[0].value));
  REQUIRE(corner > 0);
  const Side whole = joined({sides[corner - 1], sides[corner]}).side;
  sides.erase(sides.begin() + static_cast<std::ptrdiff_t>(corner));
  sides[corner - 1] = whole;
  const PolygonPatch without = polygon_patch(sides);
  CHECK(without.warnings.empty());
  CHECK(largest_distance(without, saddle) < 0.6 * largest_distance(made, saddle));
}
