#include "tripatch/polygon/problem.h"

#include <Eigen/Dense>
#include <algorithm>
#include <limits>

#include "tripatch/fairing/fairing_problem.h"
#include "tripatch/patch/side_weights.h"

namespace tripatch {
namespace {

bool is(const std::vector<bool>& flags, int i, bool otherwise) { return flags.empty() ? otherwise : static_cast<bool>(flags[i]); }

/// As it is known; where it is not, without slopes, which the problem has yet to make.
std::shared_ptr<const PolygonAtNodes> at_nodes(const PolygonBase& base, const PolygonSpace& space, int nodes) {
  if (base.lift)
    if (auto known = base.known->find(nodes)) return known;
  return std::make_shared<const PolygonAtNodes>(PolygonAtNodes{plane_derivatives(*base.blend, space.uv), {}});
}

/// Derivatives of the patch: always of its two parts, so that they do not depend on what was known.
std::vector<Derivatives> whole_at(const PolygonBase& base, const Points& uv, std::vector<Derivatives> blend) {
  if (!base.lift) return blend;
  const std::vector<Derivatives> lift = plane_derivatives(*base.lift, uv);
  for (std::size_t k = 0; k < blend.size(); ++k) blend[k] += lift[k];
  return blend;
}

}  // namespace

/// phi_i F(t_i) with F = -(a r + b c') has 2 F' dt/dnu as second derivative along nu.
CurvatureFollowing PolygonProblem::followed(const PolygonBase& base) const {
  const PolygonDomain& d = base.boundary.domain;
  const SideBasis& along = space_->along;
  std::vector<FollowedSide> all;
  for (int i = 0; i < d.sides(); ++i) {
    if (!is(base.curvature, i, false) || base.sides[i].q.empty() || slopes_.scale[i][0] == 0) continue;
    const PolygonRibbon& ribbon = base.boundary.ribbons[i];
    FollowedSide side =
        followed_side(base.sides[i], i, ribbon.alpha, ribbon.beta, along.t, derivatives_across(*base.patch(), d, i, along.t));
    const Vec2 nu = d.inward(i);
    for (int k = 0; k < SideBasis::points; ++k) {
      const Vec2 p = d.on_side(i, along.t[k]);
      side.skew[k] = -2 * d.place(Jet<1>::linear(p[0], nu[0], 0), Jet<1>::linear(p[1], nu[1], 0)).t[i].c[1];
    }
    side.first = scalars() + slopes_.first[i];
    side.scale = slopes_.scale[i];
    all.push_back(side);
  }
  return {along, std::move(all), d.sides(), size_, options_.curvature_jump};
}

PolygonProblem::PolygonProblem(const PolygonBase& base, const FairingOptions& options, int nodes)
    : PolygonProblem(base, options, nodes,
                     polygon_space(base.boundary.domain, options.degree, options.second_cross, options.slopes, nodes)) {}

PolygonProblem::PolygonProblem(const PolygonBase& base, const FairingOptions& options, int nodes,
                               const std::shared_ptr<const PolygonSpace>& space)
    : PolygonProblem(base, options, nodes, space, at_nodes(base, *space, nodes)) {}

PolygonProblem::PolygonProblem(const PolygonBase& base, const FairingOptions& options, int nodes,
                               std::shared_ptr<const PolygonSpace> space, const std::shared_ptr<const PolygonAtNodes>& known)
    : EnergyProblem(*space, whole_at(base, space->uv, known->blend), options, base.boundary.size, space->combination.cols()),
      space_(std::move(space)),
      of_(base) {
  const int n = base.boundary.domain.sides();
  std::vector<std::vector<PiecewisePolynomial>> directions(n);
  for (int i = 0; i < n; ++i) {
    slopes_.scale.push_back({0, 0});
    if (is(base.slopes_free, i, true) && !is(base.position_only, i, false) && !base.sides[i].r.empty())
      slopes_.scale[i] = {scale_to(size_, base.sides[i].r), scale_to(size_, base.sides[i].c.derivative())};
    directions[i] = directions_of(base.sides, i);
    slopes_.first.push_back(fields_);
    fields_ += options.slopes * static_cast<Index>(directions[i].size());
  }
  if (known->slopes.size() > 0) {
    basis_ = known->slopes;
  } else {
    basis_.setZero(27 * space_->uv.rows(), fields_);
    for (int i = 0; i < n; ++i) add_slopes(i, directions[i]);
    if (base.lift) base.known->add(nodes, std::make_shared<const PolygonAtNodes>(PolygonAtNodes{known->blend, basis_}));
  }
  following_.emplace(followed(base));
  hold_points();
}

std::vector<PiecewisePolynomial> PolygonProblem::directions_of(const SideList& sides, int i) const {
  const auto& [r, c] = slopes_.scale[i];
  return slope_directions(sides[i], {-r, -c}, is(of_.position_only, i, false), size_);
}

/// The derivatives, at all nodes, of what the free slopes of side i add.
void PolygonProblem::add_slopes(int i, const std::vector<PiecewisePolynomial>& directions) {
  if (directions.empty()) return;
  const int n = of_.boundary.domain.sides();
  for (Index k = 0; k < space_->uv.rows(); ++k) {
    const PolygonSpace::Slope& slope = space_->slopes[static_cast<std::size_t>(k * n + i)];
    for (std::size_t f = 0; f < directions.size(); ++f) {
      const JetPoint<3> field = slope.kernel * compose(directions[f], slope.t);
      for (int m = 0; m < options_.slopes; ++m) {
        Derivatives all;
        for (int x = 0; x < 3; ++x) all.col(x) = derivatives_of(slope.functions[m] * field.x[x]);
        basis_.block<27, 1>(27 * k, slopes_.first[i] + static_cast<Index>(f) * options_.slopes + m) =
            Eigen::Map<const Eigen::Matrix<double, 27, 1>>(all.data());
      }
    }
  }
}

/// What the unknowns change at the inner points: three rows each, two more where a normal is held.
void PolygonProblem::hold_points() {
  Index count_rows = 0;
  for (const InnerPoint& p : of_.through) count_rows += p.normal ? 5 : 3;
  held_.setZero(count_rows, count());
  Index row = 0;
  const PolygonDomain& d = of_.boundary.domain;
  for (const InnerPoint& inner : of_.through) {
    const Jet<1> u = Jet<1>::linear(inner.uv[0], 1, 0), v = Jet<1>::linear(inner.uv[1], 0, 1);
    const Place<1> place = d.place(u, v);
    const std::vector<Jet<1>> basis = polygon_basis<1>(d, place, u, v, options_.degree, options_.second_cross);
    Eigen::MatrixXd scalar(3, static_cast<Index>(basis.size()));
    for (std::size_t c = 0; c < basis.size(); ++c)
      for (int k = 0; k < 3; ++k) scalar(k, static_cast<Index>(c)) = basis[c].c[k];
    scalar = (size_ * scalar * space_->combination).eval();
    Eigen::MatrixXd field = Eigen::MatrixXd::Zero(9, fields_);  // rows: value, d/du, d/dv, each x, y, z
    for (int i = 0; i < d.sides(); ++i) {
      const std::vector<PiecewisePolynomial> directions = directions_of(of_.sides, i);
      for (std::size_t f = 0; f < directions.size(); ++f) {
        const JetPoint<1> whole = (place.phi[i] * place.side[i]) * compose(directions[f], place.t[i]);
        for (int m = 0; m < options_.slopes; ++m) {
          std::array<double, 2> series;
          space_->slope_functions[m].taylor(place.t[i].value(), 1, series.data());
          const Jet<1> function = compose<1>(series.data(), 1, place.t[i]);
          for (int x = 0; x < 3; ++x) {
            const Jet<1> value = function * whole.x[x];
            for (int k = 0; k < 3; ++k)
              field(3 * k + x, slopes_.first[i] + static_cast<Index>(f) * options_.slopes + m) = value.c[k];
          }
        }
      }
    }
    const auto add = [&](int derivative, const Vec3& along) {
      for (int x = 0; x < 3; ++x) {
        held_.row(row).segment(x * interior_, interior_) += along[x] * scalar.row(derivative);
        held_.row(row).tail(fields_) += along[x] * field.row(3 * derivative + x);
      }
      ++row;
    };
    for (int x = 0; x < 3; ++x) add(0, Vec3::Unit(x));
    if (inner.normal)
      for (int k = 1; k <= 2; ++k) add(k, *inner.normal);
  }
}

PiecewisePolynomial PolygonProblem::combination(const Eigen::VectorXd& x, int i, std::size_t direction) const {
  const std::size_t m = options_.slopes;
  return slope_function({&x[scalars() + slopes_.first[i] + static_cast<Index>(direction * m)], m});
}

double PolygonProblem::reach(const Eigen::VectorXd& x) const {
  double most = std::numeric_limits<double>::infinity();
  for (int i = 0; i < of_.boundary.domain.sides(); ++i) {
    if (slopes_.scale[i][0] == 0) continue;
    most = std::min(most, alpha_reach(of_.boundary.ribbons[i].alpha, slopes_.scale[i][0] * combination(x, i, 0)));
  }
  return most;
}

bool PolygonProblem::meets_planes() const {
  return std::find(of_.position_only.begin(), of_.position_only.end(), true) == of_.position_only.end();
}

SurfacePtr PolygonProblem::correction(const Eigen::VectorXd& x, const SideList& sides) const {
  const int n = of_.boundary.domain.sides();
  std::vector<PiecewisePolynomial> slopes(n);
  for (int i = 0; i < n; ++i) {
    const std::vector<PiecewisePolynomial> directions = directions_of(sides, i);
    for (std::size_t f = 0; f < directions.size(); ++f) {
      const PiecewisePolynomial term = combination(x, i, f) * directions[f];
      slopes[i] = f == 0 ? term : slopes[i] + term;
    }
  }
  Points a(interior_, 3);
  for (int c = 0; c < 3; ++c) a.col(c) = size_ * (space_->combination * x.segment(c * interior_, interior_));
  return polygon_correction(of_.boundary.domain, std::move(slopes), options_.degree, options_.second_cross, a);
}

}  // namespace tripatch
