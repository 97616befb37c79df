#include "tripatch/fairing/fairing.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <tuple>
#include <utility>

#include "tripatch/fairing/center.h"
#include "tripatch/fairing/curvature.h"
#include "tripatch/fairing/energy.h"
#include "tripatch/fairing/fairing_space.h"
#include "tripatch/fairing/fold_removal.h"
#include "tripatch/math/linear.h"
#include "tripatch/math/parallel.h"

namespace tripatch {
namespace {

/// sum of squares |A x + r|^2 = x' normal x + 2 x' gradient + constant.
struct Quadratic {
  Eigen::MatrixXd normal;
  Eigen::VectorXd gradient;
  double constant = 0;
  double operator()(const Eigen::VectorXd& x) const { return std::max(0.0, x.dot(normal * x + 2 * gradient) + constant); }
  Quadratic& operator+=(const Quadratic& o) {
    normal += o.normal;
    gradient += o.gradient;
    constant += o.constant;
    return *this;
  }
};

/// What makes a field of any length as long as the hole; 0 where it vanishes.
double scale_to(double size, const PiecewisePolynomial& field) {
  double length = 0;
  for (int k = 0; k <= 16; ++k) length += field(k / 16.0).norm() / 17;
  return length > 0 ? size / length : 0;
}

/// How much of `added` side i's alpha can gain until it falls below a tenth of what it was.
double alpha_reach(const Boundary& boundary, int i, const PiecewisePolynomial& added) {
  double most = std::numeric_limits<double>::infinity();
  for (int k = 1; k < 32; ++k) {
    double before, change;
    boundary.ribbons[i].alpha.taylor(k / 32.0, 0, &before);
    added.taylor(k / 32.0, 0, &change);
    if (!(change >= 0)) most = std::min(most, -0.9 * before / change);
  }
  return most;
}

/// The unknowns of one hole: the interior coefficients, component by component, then alpha and beta of each side.
class Problem {
public:
  Problem(const Surface& base, const Sides& sides, const Boundary& boundary, const FairingOptions& options, int nodes)
      : shared_(fairing_space(options.degree, options.bends, options.slopes, nodes)),
        base_(cartesian_derivatives(base, shared_.quadrature.b)),
        size_(boundary.size),
        sides_(sides),
        boundary_(boundary),
        options_(options) {
    interior_ = shared_.normal[3].rows();
    for (int i = 0; i < 3; ++i) {
      first_[i] = slopes_;
      slopes_ += options.slopes * static_cast<Index>(take_directions(i));
    }
    follow_curvature(base);
    const Index n = static_cast<Index>(base_.size());
    basis_.setZero(27 * n, slopes_);
    for (Index k = 0; k < n; ++k) add_slopes(k);
  }

  Index unknowns() const { return 3 * interior_ + slopes_; }

  /// What the unknowns add to the middle of the patch, three rows; none where the middle is free.
  Eigen::MatrixXd held() const {
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(options_.center ? 3 : 0, unknowns());
    if (!options_.center) return rows;
    for (int x = 0; x < 3; ++x) rows.row(x).segment(x * interior_, interior_) = size_ * shared_.middle;
    for (int i = 0; i < 3; ++i)
      for (std::size_t f = 0; f < directions_[i].size(); ++f)
        rows.middleCols(3 * interior_ + first_[i] + f * options_.slopes, options_.slopes) =
            directions_[i][f](0.5) * shared_.middle_slope;
    return rows;
  }

  /// The same in the unknowns of this problem, for those of one whose interior term is of the same degree or lower.
  Eigen::VectorXd raised(const Problem& lower, const Eigen::VectorXd& x) const {
    if (lower.options_.degree == options_.degree) return x;
    Eigen::VectorXd out(unknowns());
    out.tail(slopes_) = x.tail(slopes_);
    const Points a = lower.shared_.combination * Eigen::Map<const Eigen::MatrixXd>(x.data(), lower.interior_, 3);
    BezierTriangle inside(a.topRows(BezierTriangle::net_size(lower.options_.degree)));
    while (inside.degree() < options_.degree) inside = inside.elevated();
    Eigen::MatrixXd all(interior_, 3);
    all << inside.net(), a.bottomRows(3 * options_.bends);
    Eigen::Map<Eigen::MatrixXd>(out.data(), interior_, 3) = shared_.combination.triangularView<Eigen::Upper>().solve(all);
    return out;
  }

  bool controlled() const { return options_.tension > 0 || options_.center; }

  bool follows_curvature() const { return !followed_.empty(); }
  bool follows_all_curvature() const { return followed_.size() == 3; }

  /// The relative jumps of normal curvature along the sides followed, over what is tolerated, as rows whose squares sum to the mean
  /// square; their derivatives where `rows` is given. With alpha and beta free the surroundings' part is quadratic in them:
  /// n . P_dd = II(d, d), d = alpha r + beta c', and what a change (a, b) of alpha, beta adds to n . P_dd of a patch whose slopes are
  /// carried by slope_kernel is 2 (1/2 - t) n . (a r' + b c'').
  Eigen::VectorXd jumps(const Eigen::VectorXd& x, RowMajor* rows = nullptr) const {
    constexpr int points = FairingSpace::side_points;
    const int m = options_.slopes;
    Eigen::VectorXd value(points * static_cast<Index>(followed_.size()));
    if (rows) rows->setZero(value.size(), unknowns());
    for (std::size_t f = 0; f < followed_.size(); ++f) {
      const Followed& side = followed_[f];
      const int i = side.i;
      const Index alpha_at = 3 * interior_ + first_[i], beta_at = alpha_at + m;
      const Eigen::VectorXd da = scale_[i][0] * (shared_.side_slope * x.segment(alpha_at, m)),
                            db = scale_[i][1] * (shared_.side_slope * x.segment(beta_at, m));
      for (int k = 0; k < points; ++k) {
        const SideForm& form = side.form[k];
        const Index row = points * static_cast<Index>(f) + k;
        const double a = side.alpha[k] + da[k], b = side.beta[k] + db[k], skew = 2 * (0.5 - shared_.side_t[k]);
        double jump =
            side.base[k] + skew * (da[k] * form.rc + db[k] * form.cc) - (a * a * form.rr + 2 * a * b * form.rc + b * b * form.cc);
        for (int c = 0; c < 3; ++c)
          jump += size_ * form.n[c] * shared_.side_second[i].row(k).dot(x.segment(c * interior_, interior_));
        value[row] = side.weight[k] * jump;
        if (!rows) continue;
        for (int c = 0; c < 3; ++c)
          rows->row(row).segment(c * interior_, interior_) = side.weight[k] * size_ * form.n[c] * shared_.side_second[i].row(k);
        rows->row(row).segment(alpha_at, m) =
            side.weight[k] * scale_[i][0] * (skew * form.rc - 2 * a * form.rr - 2 * b * form.rc) * shared_.side_slope.row(k);
        rows->row(row).segment(beta_at, m) =
            side.weight[k] * scale_[i][1] * (skew * form.cc - 2 * a * form.rc - 2 * b * form.cc) * shared_.side_slope.row(k);
      }
    }
    return value;
  }
  Index interior() const { return 3 * interior_; }

  /// Of the patch, at the nodes [from, to).
  std::vector<Derivatives> derivatives(Index from, Index to, const Eigen::VectorXd& x) const {
    std::vector<Derivatives> d(base_.begin() + from, base_.begin() + to);
    const Index n = to - from;
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>> rows(d[0].data(), 9 * n, 3);
    Eigen::Map<Eigen::VectorXd> all(d[0].data(), 27 * n);
    rows.noalias() +=
        size_ * shared_.interior.middleRows(9 * from, 9 * n) * Eigen::Map<const Eigen::MatrixXd>(x.data(), interior_, 3);
    all.noalias() += basis_.middleRows(27 * from, 27 * n) * x.tail(slopes_);
    return d;
  }

  /// The integral of w |D^order P|^2 over the size squared: thin_plate (2), third_derivative (3), tension (1).
  Quadratic quadratic(int order) const {
    const int rows = order + 1, first = FairingSpace::first_of(order);
    const Index n = static_cast<Index>(base_.size());
    const Eigen::MatrixXd &inner = shared_.rows[order], &inner_normal = shared_.normal[order];
    Quadratic q;
    q.normal.setZero(unknowns(), unknowns());
    q.gradient.setZero(unknowns());
    Eigen::MatrixXd slope(rows * n, slopes_);
    Eigen::VectorXd value(rows * n);
    for (int c = 0; c < 3; ++c) {
      for (Index k = 0; k < n; ++k) {
        const double w = std::sqrt(shared_.quadrature.weights[k]) / size_;
        for (int d = 0; d < rows; ++d) {
          const double f = w * FairingSpace::factor(order, d);
          slope.row(rows * k + d) = f * basis_.row(27 * k + 3 * (first + d) + c);
          value[rows * k + d] = f * base_[k](first + d, c);
        }
      }
      const Index at = c * interior_;
      q.normal.block(at, at, interior_, interior_) = inner_normal;
      q.normal.block(at, 3 * interior_, interior_, slopes_).noalias() = inner.transpose() * slope;
      q.normal.bottomRightCorner(slopes_, slopes_).noalias() += slope.transpose() * slope;
      q.gradient.segment(at, interior_).noalias() = inner.transpose() * value;
      q.gradient.tail(slopes_).noalias() += slope.transpose() * value;
      q.constant += value.squaredNorm();
    }
    q.normal.bottomLeftCorner(slopes_, 3 * interior_) = q.normal.topRightCorner(3 * interior_, slopes_).transpose();
    return q;
  }

  /// minimum_variation and quadric_variation at x.
  std::pair<double, double> variation(const Eigen::VectorXd& x) const {
    double variation = 0, quadric = 0;
    const std::vector<Derivatives> d = derivatives(0, static_cast<Index>(base_.size()), x);
    for (std::size_t k = 0; k < d.size(); ++k) {
      const CurvatureVariation v = curvature_variation(d[k], flat_curvature(size_));
      const double w = shared_.quadrature.weights[k] * size_ * size_ * v.area;
      variation += w * v.variation.squaredNorm();
      quadric += w * v.quadric.squaredNorm();
    }
    return {variation, quadric};
  }

  /// Gauss-Newton's model about x of minimum_variation (which = 0) or quadric_variation (1), those asked for.
  void linearise(const Eigen::VectorXd& x, const std::array<bool, 2>& wanted, std::array<Quadratic, 2>& model) const {
    // in blocks of nodes, always the same, so that sums do not depend on the number of cores
    constexpr Index block = 96;
    const Index n = static_cast<Index>(base_.size()), blocks = (n + block - 1) / block;
    std::vector<std::array<Quadratic, 2>> parts(blocks);
    parallel_for(0, blocks, 2, [&](Index from, Index to) {
      for (Index at = from; at < to; ++at) parts[at] = linearise(x, wanted, at * block, std::min(n, (at + 1) * block));
    });
    model = std::move(parts[0]);
    for (Index at = 1; at < blocks; ++at)
      for (int which = 0; which < 2; ++which)
        if (wanted[which]) model[which] += parts[at][which];
  }

  Quadratic linearised_jumps(const Eigen::VectorXd& x) const {
    RowMajor rows;
    const Eigen::VectorXd value = jumps(x, &rows);
    RowMajor normal = RowMajor::Zero(unknowns(), unknowns());
    add_gram(rows, normal);
    return {normal.selfadjointView<Eigen::Lower>(), rows.transpose() * value, value.squaredNorm()};
  }

  /// How much of x can be added until alpha falls below a tenth of what it was.
  double reach(const Eigen::VectorXd& x) const {
    double most = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 3; ++i) {
      if (scale_[i][0] == 0) continue;
      most = std::min(most, alpha_reach(boundary_, i, scale_[i][0] * combination(x, i, 0)));
    }
    return most;
  }
  bool open(const Eigen::VectorXd& x) const { return reach(x) >= 1; }

  SurfacePtr correction(const Eigen::VectorXd& x, const Sides& sides) const {
    std::array<PiecewisePolynomial, 3> slopes;
    for (int i = 0; i < 3; ++i) {
      const std::array<double, 3> none = {0, 0, 0};
      slopes[i] = PiecewisePolynomial::constant(none);
      const std::vector<PiecewisePolynomial> directions = directions_of(sides[i], i);
      for (std::size_t f = 0; f < directions.size(); ++f) slopes[i] = slopes[i] + combination(x, i, f) * directions[f];
    }
    Points a(interior_, 3);
    for (int c = 0; c < 3; ++c) a.col(c) = size_ * (shared_.combination * x.segment(c * interior_, interior_));
    return tripatch::correction(std::move(slopes), options_.degree, options_.bends, a);
  }

private:
  /// The derivatives, at a node, of what the free slopes add.
  void add_slopes(Index node) {
    for (int i = 0; i < 3; ++i)
      for (std::size_t f = 0; f < directions_[i].size(); ++f) {
        const FairingSpace::Slope& slope = shared_.slope[node][i];
        Eigen::Matrix<double, 4, 3, Eigen::RowMajor> series;  // of the direction
        directions_[i][f].taylor(slope.t, 3, series.data());
        for (int m = 0; m < options_.slopes; ++m) {
          const Derivatives d = slope.rows.middleRows<9>(9 * m).lazyProduct(series);
          basis_.block<27, 1>(27 * node, first_[i] + f * options_.slopes + m) =
              Eigen::Map<const Eigen::Matrix<double, 27, 1>>(d.data());
        }
      }
  }

  /// A side whose curvature the patch is to follow, at the points of FairingSpace::side_t.
  struct Followed {
    int i;
    std::array<SideForm, FairingSpace::side_points> form;
    std::array<double, FairingSpace::side_points> alpha, beta;
    std::array<double, FairingSpace::side_points> base;  // n . P_dd of the base
    std::array<double, FairingSpace::side_points> weight;
  };

  /// The same of some of the nodes.
  std::array<Quadratic, 2> linearise(const Eigen::VectorXd& x, const std::array<bool, 2>& wanted, Index from, Index to) const {
    constexpr Index block = 12;  // nodes: their rows stay in the cache
    std::array<Quadratic, 2> model;
    std::array<RowMajor, 2> jacobian, normal;
    std::array<Eigen::VectorXd, 2> value;
    for (int which = 0; which < 2; ++which) {
      if (!wanted[which]) continue;
      normal[which].setZero(unknowns(), unknowns());
      model[which].gradient.setZero(unknowns());
    }
    for (Index start = from; start < to; start += block) {
      const Index n = std::min(block, to - start);
      for (int which = 0; which < 2; ++which) {
        if (!wanted[which]) continue;
        jacobian[which].resize(4 * n, unknowns());
        value[which].resize(4 * n);
      }
      const std::vector<Derivatives> d = derivatives(start, start + n, x);
      for (Index k = start; k < start + n; ++k) {
        const CurvatureVariationRows v = curvature_variation_rows(d[k - start], flat_curvature(size_));
        const double w = std::sqrt(shared_.quadrature.weights[k]) * size_;
        const Index row = 4 * (k - start);
        for (int which = 0; which < 2; ++which) {
          if (!wanted[which]) continue;
          value[which].segment<4>(row) = w * v.value.segment<4>(4 * which);
          const Eigen::Matrix<double, 4, 27, Eigen::RowMajor> rows = w * v.derivative.middleRows<4>(4 * which);
          double* const out = jacobian[which].row(row).data();
          for (int c = 0; c < 3; ++c) {
            Eigen::Matrix<double, 4, 9, Eigen::RowMajor> part;
            for (int d = 0; d < 9; ++d) part.col(d) = size_ * rows.col(3 * d + c);
            multiply_four(part.data(), 9, shared_.interior.row(9 * k).data(), interior_, out + c * interior_, unknowns());
          }
          multiply_four(rows.data(), 27, basis_.row(27 * k).data(), slopes_, out + 3 * interior_, unknowns());
        }
      }
      for (int which = 0; which < 2; ++which) {
        if (!wanted[which]) continue;
        add_gram(jacobian[which], normal[which]);
        model[which].gradient.noalias() += jacobian[which].transpose() * value[which];
        model[which].constant += value[which].squaredNorm();
      }
    }
    for (int which = 0; which < 2; ++which)
      if (wanted[which]) model[which].normal = normal[which].selfadjointView<Eigen::Lower>();
    return model;
  }

  void follow_curvature(const Surface& base) {
    constexpr int points = FairingSpace::side_points;
    double curvature = 0;  // mean square of the sides'
    for (int i = 0; i < 3; ++i) {
      if (!options_.curvature[i] || sides_[i].q.empty() || scale_[i][0] == 0) continue;
      Followed side;
      side.i = i;
      const std::vector<Across> across = derivatives_across(base, i, shared_.side_t);
      for (int k = 0; k < points; ++k) {
        const double t = shared_.side_t[k];
        const SideForm form = side_form(sides_[i], t);
        side.form[k] = form;
        boundary_.ribbons[i].alpha.taylor(t, 0, &side.alpha[k]);
        boundary_.ribbons[i].beta.taylor(t, 0, &side.beta[k]);
        side.base[k] = form.n.dot(across[k].second);
        side.weight[k] = 1 / form.across(side.alpha[k] * form.r);
        curvature += form.squared_norm() / points / 3;
      }
      followed_.push_back(side);
    }
    const double tolerated = options_.curvature_jump * std::sqrt(curvature + flat_curvature(size_));
    for (Followed& side : followed_) {
      const double unit = std::hypot(tolerated, 3 * sides_[side.i].curvature_error);
      for (int k = 0; k < points; ++k)
        side.weight[k] *=
            std::sqrt((0.05 + std::sin(M_PI * shared_.side_t[k])) / (3 * (0.05 * points + shared_.side_sum))) / unit;
    }
  }

  /// What the derivative across side i may gain, each times the functions of t: r and c', or, where the side asks for its position
  /// only, any direction; nothing where it is held.
  std::vector<PiecewisePolynomial> directions_of(const Side& side, int i) const {
    std::vector<PiecewisePolynomial> directions;
    if (options_.position_only[i]) {
      for (int x = 0; x < 3; ++x) {
        const Vec3 unit = size_ * Vec3::Unit(x);
        directions.push_back(PiecewisePolynomial::constant({unit.data(), 3}));
      }
    } else if (scale_[i][0] > 0) {
      directions = {scale_[i][0] * side.r, scale_[i][1] * side.c.derivative()};
    }
    return directions;
  }

  std::size_t take_directions(int i) {
    if (options_.slopes_free[i] && !options_.position_only[i] && !sides_[i].r.empty())
      scale_[i] = {scale_to(size_, sides_[i].r), scale_to(size_, sides_[i].c.derivative())};
    directions_[i] = directions_of(sides_[i], i);
    return directions_[i].size();
  }

  PiecewisePolynomial combination(const Eigen::VectorXd& x, int i, std::size_t direction) const {
    const std::size_t m = options_.slopes;
    return slope_function({&x[3 * interior_ + first_[i] + static_cast<Index>(direction * m)], m});
  }

  const FairingSpace& shared_;
  std::vector<Derivatives> base_;
  double size_;
  const Sides& sides_;
  const Boundary& boundary_;
  FairingOptions options_;
  Index interior_, slopes_ = 0;
  std::array<Index, 3> first_ = {};  // of each side's slopes among all
  std::array<std::vector<PiecewisePolynomial>, 3> directions_;
  std::vector<Followed> followed_;
  std::array<std::array<double, 2>, 3> scale_ = {};  // of r and c'; 0: alpha and beta are held
  RowMajor basis_;                                   // derivatives of what the slopes add, 27 rows a node
};

/// The minimum of a quadratic energy, slopes free; with the scalar functions alone where alpha would leave its bound, or, where tension
/// or the middle is a person's to change (which shall not jump), most of the way from there to the bound. Curvature that is to be
/// followed weighs a tenth of the energy at the start for each jump tolerated; two passes, because slopes enter it squared.
Eigen::VectorXd minimum(const Problem& problem, const Quadratic& q) {
  const Eigen::MatrixXd held = problem.held();
  const auto among = [&](Index m) {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(problem.unknowns());
    for (int pass = 0; pass < (problem.follows_curvature() ? 2 : 1); ++pass) {
      Eigen::MatrixXd normal = q.normal.topLeftCorner(m, m);
      Eigen::VectorXd gradient = q.normal.topRows(m) * x + q.gradient.head(m);
      if (problem.follows_curvature()) {
        const Quadratic jumps = problem.linearised_jumps(x);
        normal += 0.1 * q.constant * jumps.normal.topLeftCorner(m, m);
        gradient += 0.1 * q.constant * jumps.gradient.head(m);
      }
      normal.diagonal().array() += 1e-12 * normal.trace() / m;
      x.head(m) += least_quadratic(normal, gradient, held.leftCols(m));
    }
    return x;
  };
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(problem.unknowns());
  const Eigen::VectorXd all = among(problem.unknowns());
  if (all.allFinite() && problem.open(all)) return all;
  const Eigen::VectorXd scalars = among(problem.interior());
  if (!scalars.allFinite()) return zero;
  if (!all.allFinite() || !problem.controlled()) return scalars;
  const double share = 0.9 * problem.reach(all);
  return share > 0 ? scalars + std::min(share, 1.0) * (all - scalars) : scalars;
}

/// A geometric energy as the logarithm of its value, so that "auto" weighs its two parts without units, plus the jumps of curvature.
class Merit {
public:
  /// tension: added to the energy; without unknowns: none.
  Merit(const Problem& problem, const Quadratic& third, Quadratic tension, const std::string& energy)
      : problem_(problem),
        third_(third),
        tension_(std::move(tension)),
        held_(problem.held()),
        quadric_(energy != "minimum_variation"),
        whole_(energy != "quadric_variation") {}

  struct Value {
    double log = std::numeric_limits<double>::infinity();
    double variation = 0, quadric = 0, third = 0;
    double energy = 0;
  };

  Value operator()(const Eigen::VectorXd& x) const {
    Value v;
    if (!x.allFinite() || !problem_.open(x)) return v;
    std::tie(v.variation, v.quadric) = problem_.variation(x);
    v.third = third_(x);
    v.energy = energy(v.variation, v.quadric) + tension(x);
    if (std::isfinite(v.energy)) {
      v.log = std::log(std::max(v.energy, 1e-300)) + parameterisation * std::log(std::max(v.third, 1e-300));
      if (problem_.follows_curvature()) v.log += problem_.jumps(x).squaredNorm();
    }
    return v;
  }

  /// Gauss-Newton's models of all parts about x.
  struct Model {
    std::array<Quadratic, 2> variation;
    Quadratic jumps;
    std::array<bool, 2> used;
  };

  Model linearise(const Eigen::VectorXd& x, const Value& v) const {
    Model m;
    const double share = quadric_share(v.variation, v.quadric);
    m.used = {share < 0.95, share > 0.05};  // half the work, and a step counts only if it goes down anyway
    problem_.linearise(x, m.used, m.variation);
    if (problem_.follows_curvature()) m.jumps = problem_.linearised_jumps(x);
    return m;
  }

  /// The step that makes the model of the logarithm least, by repeated weighting: a logarithm's weight is one over its value where the
  /// step leads, not where it starts. `damping` is the weight of `metric`, relative to the model's.
  Eigen::VectorXd step(const Model& m, const Eigen::VectorXd& x, const Value& v, const Eigen::MatrixXd& metric,
                       double damping) const {
    constexpr int rounds = 4;
    constexpr double near = 0.1;  // where another round changes so little (relative), it is the last
    Eigen::VectorXd y = Eigen::VectorXd::Zero(x.size());
    const Eigen::VectorXd third_gradient = third_.normal * x + third_.gradient;
    Eigen::MatrixXd normal;
    Eigen::VectorXd gradient;
    for (int round = 0; round < rounds; ++round) {
      const auto value = [&](int which, double now) { return m.used[which] ? std::max(m.variation[which](y), 1e-3 * now) : now; };
      const double variation = value(0, v.variation), quadric = value(1, v.quadric), third = std::max(third_(x + y), 1e-300);
      double share = quadric_share(variation, quadric);
      if (!m.used[0]) share = 1;
      if (!m.used[1]) share = 0;
      normal = parameterisation / third * third_.normal;
      gradient = parameterisation / third * third_gradient;
      double part = 1;  // of the logarithm's derivative that is not tension's
      if (tense()) {
        const double bent = energy(variation, quadric), all = std::max(bent + tension(x + y), 1e-300);
        part = bent / all;
        normal += tension_.normal / all;
        gradient += (tension_.normal * x + tension_.gradient) / all;
      }
      if (m.used[0]) {
        normal += part * (1 - share) / variation * m.variation[0].normal;
        gradient += part * (1 - share) / variation * m.variation[0].gradient;
      }
      if (m.used[1]) {
        normal += part * share / quadric * m.variation[1].normal;
        gradient += part * share / quadric * m.variation[1].gradient;
      }
      if (problem_.follows_curvature()) {
        normal += m.jumps.normal;
        gradient += m.jumps.gradient;
      }
      normal += damping * (normal.trace() / metric.trace()) * metric;
      normal.diagonal().array() += 1e-14 * normal.trace();  // held slopes have empty rows
      const Eigen::VectorXd last = std::exchange(y, least_quadratic(normal, gradient, held_));
      if ((y - last).norm() < near * y.norm()) break;
    }
    return y;
  }

private:
  bool tense() const { return tension_.normal.size() > 0; }
  double tension(const Eigen::VectorXd& x) const { return tense() ? tension_(x) : 0; }
  double energy(double variation, double quadric) const {
    return !quadric_ ? variation : !whole_ ? quadric : softly_smaller(variation, quadric);
  }
  /// Of the quadric energy in the logarithm's derivative.
  double quadric_share(double variation, double quadric) const {
    if (!quadric_ || !whole_) return quadric_ ? 1 : 0;
    return 1 - 1 / (1 + std::pow(quadric_ratio * variation / quadric, 4));
  }

  /// The parameterisation is free in these energies. A little of the third-derivative energy settles it: a step may gain on it a
  /// tenth (relative) of what it loses. Less than 0.05 and the minimiser depends on rounding.
  static constexpr double parameterisation = 0.1;
  const Problem& problem_;
  const Quadratic& third_;
  Quadratic tension_;
  Eigen::MatrixXd held_;
  bool quadric_, whole_;
};

/// Levenberg and Marquardt, damped in `metric` so that what the energy leaves open stays put: every step goes down. Stops when a step
/// gains less than `enough` (relative) or the energy is next to none. Returns the steps taken.
int descend(const Merit& merit, const Eigen::MatrixXd& metric, Eigen::VectorXd& x, Merit::Value& value, int iterations) {
  constexpr double enough = 1e-2, none = 1e-4;
  double damping = 1e-4;
  for (int step = 0; step < iterations; ++step) {
    const Merit::Model model = merit.linearise(x, value);
    double gain = 0;
    for (int attempt = 0; attempt < 6 && gain == 0; ++attempt) {
      const Eigen::VectorXd y = x + merit.step(model, x, value, metric, damping);
      const Merit::Value next = merit(y);
      if (next.log < value.log) {
        gain = value.log - next.log;
        x = y;
        value = next;
        damping = std::max(damping / 10, 1e-10);
      } else {
        damping *= 10;
      }
    }
    if (gain < enough || value.energy < none) return step + (gain > 0 ? 1 : 0);
  }
  return iterations;
}

/// A geometric energy that stays above this is that of waves of an eighth of the hole, shorter than what the unknowns and the quadrature
/// can follow (it grows with the fourth power); what is least then is not near to anything. Of 407 holes in Suzanne's limit surface,
/// corners anywhere, 317 were so: their fairest patches were 1.4 times as far from the truth as plain ones, of the others half as far.
constexpr double hopeless = 5e3;
constexpr double hopeless_even_so = 2e4;  // where the curvature along all sides is known well enough to be followed

constexpr Index few_folds = 100;  // of a grid's 2145 points: where more fold, a little of the interior term cannot help

}  // namespace

FairResult fair(const FairingBase& base, const FairingBase& measured, const FairingOptions& options, const FoldCounter* folds) {
  const std::array<std::string, 5> names = {"thin_plate", "third_derivative", "minimum_variation", "quadric_variation", "auto"};
  const auto name = std::find(names.begin(), names.end(), options.energy);
  if (name == names.end())
    throw InvalidArgument("No energy is called '" + options.energy +
                          "'; there are: thin_plate, third_derivative, minimum_variation, quadric_variation, auto");
  const bool quadratic = name < names.begin() + 2;

  FairResult result;
  result.energy = options.energy;
  const SurfacePtr start = options.center ? with_center(base.patch, *options.center) : base.patch;
  result.patch = start;
  const Sides& even = measured.sides;
  const Boundary& even_boundary = measured.boundary;
  const SurfacePtr even_base = options.center ? with_center(measured.patch, *options.center) : measured.patch;
  FairingOptions own = options;
  if (options.automatic[0] || options.automatic[1] || options.automatic[2]) {
    const std::array<bool, 3> agree = curvature_agrees(even);
    for (int i = 0; i < 3; ++i) own.curvature[i] = options.curvature[i] || (options.automatic[i] && agree[i]);
  }
  const double size = base.boundary.size, unit = size * size;
  const auto tension_of = [&](const Problem& p) {
    Quadratic tension;
    if (!(options.tension > 0)) return tension;
    tension = p.quadratic(1);
    const double wave = 2 * M_PI, weight = options.tension * std::pow(wave, options.energy == "thin_plate" ? 2 : 4);
    tension.normal *= weight;
    tension.gradient *= weight;
    tension.constant *= weight;
    return tension;
  };
  using Candidate = std::pair<Eigen::VectorXd, double>;  // and its energy
  std::vector<Candidate> tried;                          // best first
  std::optional<Problem> problem;                        // whose unknowns they are
  bool beyond = false;                                   // what an energy can tell
  if (quadratic) {
    problem.emplace(*even_base, even, even_boundary, own, options.nodes);
    Quadratic q = problem->quadratic(options.energy == "thin_plate" ? 2 : 3);
    if (options.tension > 0) q += tension_of(*problem);
    result.before = unit * q.constant;
    const Eigen::VectorXd x = minimum(*problem, q);
    tried.emplace_back(x, unit * q(x));
  } else {
    const auto merit_of = [&](const Problem& p, const Quadratic& third) {
      Quadratic tension = tension_of(p);
      if (options.tension > 0) tension.constant -= tension(least_quadratic(tension.normal, tension.gradient, p.held()));
      return Merit(p, third, std::move(tension), options.energy);
    };
    struct Descent {
      Eigen::VectorXd first, x;  // the third-derivative solution, and what became of it
      Merit::Value value;
    };
    const auto descent = [&](const Problem& p, const Quadratic& third) {
      const Merit m = merit_of(p, third);
      const Eigen::VectorXd none = Eigen::VectorXd::Zero(p.unknowns());
      Descent d;
      d.first = minimum(p, third);
      d.x = d.first;
      d.value = m(d.x);
      if (const Merit::Value unchanged = m(none); !(d.value.log < unchanged.log)) d.x = none, d.value = unchanged;
      result.iterations += descend(m, third.normal, d.x, d.value, options.iterations);
      return d;
    };
    // with few nodes and unknowns first: the last steps are those of the exact energy
    const Problem rough(*even_base, even, even_boundary, own, options.rough_nodes);
    Quadratic third = rough.quadratic(3);
    Descent d = descent(rough, third);
    const FairingOptions low = own;
    if (d.value.energy > options.rich) own.degree = std::max(options.degree, options.high_degree);
    problem.emplace(*even_base, even, even_boundary, own, options.nodes);
    if (own.degree > low.degree) third = problem->quadratic(3);
    const Merit merit = merit_of(*problem, third);
    Eigen::VectorXd x = problem->raised(rough, d.x);
    Merit::Value value = merit(x);
    if (value.energy > std::max(options.rich, 1.25 * d.value.energy)) {  // it oscillates between the few nodes
      const Problem all(*even_base, even, even_boundary, low, options.nodes);
      d = descent(all, all.quadratic(3));
      x = problem->raised(rough, d.x);
      value = merit(x);
    }
    const Eigen::VectorXd first = problem->raised(rough, d.first);
    const Merit::Value before = merit(Eigen::VectorXd::Zero(problem->unknowns()));
    result.before = before.energy;
    const auto take = [&](const Eigen::VectorXd& candidate, const Merit::Value& v) {
      if (v.log < before.log) tried.emplace_back(candidate, v.energy);
    };
    const Eigen::VectorXd early = x;
    const Merit::Value early_value = value;
    const int last = descend(merit, third.normal, x, value, own.degree > low.degree ? 2 : 1);
    result.iterations += last;
    take(x, value);
    if (last > 0) take(early, early_value);
    take(first, merit(first));
    const double least = tried.empty() ? before.energy : tried[0].second;
    const std::array<bool, 3>& free = options.position_only;
    const double bound = problem->follows_all_curvature() ? hopeless_even_so : hopeless;
    beyond = least > bound && !problem->controlled() && !free[0] && !free[1] && !free[2];
  }

  const auto best_of = [&](std::span<const Candidate> candidates) {
    FairResult best = result;
    best.after = best.before;
    SurfacePtr even_patch = even_base;  // the result, on smoothed sides: what energies are measured on
    if (folds && candidates.empty()) best.folds = (*folds)(*start);
    // takes the folds out of best.patch, unless there are too many
    const auto unfold = [&] {
      const Index found = best.folds.value_or(0);
      if (found == 0 || found > few_folds || options.center) return false;  // a given middle stays where it is
      const SurfacePtr correction = fold_removal(best.patch, base.sides, size, *folds);
      if (!correction) return false;
      best.patch = sum(best.patch, correction);
      best.folds = 0;
      if (options.tension == 0) best.after = energy(*sum(even_patch, correction), options.energy, size, options.nodes);
      return true;
    };
    for (const auto& [x, e] : candidates) {
      if (!(e <= best.before)) continue;
      const SurfacePtr correction = problem->correction(x, base.sides);
      FairResult now = best;
      now.patch = sum(base.patch, correction);
      if (options.center) now.patch = with_center(now.patch, *options.center);  // last: `even` and `sides` differ a little
      now.after = e;
      if (folds) now.folds = (*folds)(*now.patch);
      even_patch = sum(even_base, correction);
      std::swap(best, now);
      if (best.folds.value_or(0) == 0) return best;
      if (!now.folds) now.folds = (*folds)(*start);  // counted only when needed
      if (unfold() ? best.after <= best.before : *best.folds <= *now.folds) return best;
      best = std::move(now);
      even_patch = even_base;
      best.warnings = {"The fairest patch would fold over itself; a less fair one is used"};
    }
    unfold();
    return best;
  };
  FairResult fairest;
  if (!beyond) {
    fairest = best_of(tried);
    if (fairest.folds.value_or(0) <= few_folds) return fairest;
  }
  FairResult plain = best_of({});
  plain.gave_up = true;
  plain.warnings = {
      "The surroundings vary too rapidly over the length of the hole to be continued fairly; the plain patch is used"};
  if (plain.folds.value_or(0) == 0) return plain;
  if (beyond) fairest = best_of(tried);
  return fairest.folds == Index{0} ? fairest : plain;
}

SurfacePtr follow(const FairingBase& base, SurfacePoints points, const FairingOptions& options) {
  const auto& [sides, boundary, plain] = base;
  const int slopes = options.slopes;
  const Index inner = scalars(options.degree, options.bends), n = points.points.rows();
  std::vector<PiecewisePolynomial> functions;
  for (int m = 0; m < slopes; ++m) functions.push_back(slope_function(slopes, m));
  // r and c' are of any length; a hole is as long as its size
  std::array<std::array<PiecewisePolynomial, 2>, 3> directions;
  std::array<std::array<double, 2>, 3> scale = {};
  for (int i = 0; i < 3; ++i) {
    if (!options.slopes_free[i] || sides[i].r.empty()) continue;
    directions[i] = {sides[i].r, sides[i].c.derivative()};
    for (int d = 0; d < 2; ++d) scale[i][d] = scale_to(boundary.size, directions[i][d]);
  }
  const auto added = [&](const Eigen::VectorXd& x, int i, int d) {
    return scale[i][d] * slope_function({&x[3 * inner + (2 * i + d) * slopes], static_cast<std::size_t>(slopes)});
  };
  const auto keeps_alpha = [&](const Eigen::VectorXd& x) {
    for (int i = 0; i < 3; ++i)
      if (scale[i][0] > 0 && !(alpha_reach(boundary, i, added(x, i, 0)) >= 1)) return false;
    return x.allFinite();
  };

  SurfacePtr patch = plain;
  for (int round = 0; round < 2; ++round) {
    Points b = (points.barycentric.array() + 1e-9).matrix();  // at a vertex the terms are 0/0
    for (Index k = 0; k < n; ++k) b.row(k) /= b.row(k).sum();
    const Points missing = points.points - plain->positions(b);
    const Index unknowns = 3 * inner + 6 * slopes;
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(3 * n, unknowns);
    Eigen::VectorXd right(3 * n);
    for (Index k = 0; k < n; ++k) {
      const Barycentric<0> at(b.row(k).data());
      const std::vector<Jet<0>> basis = scalar_basis(at, options.degree, options.bends);
      const std::array<Jet<0>, 3> weights = side_weights(at);
      const Vec3 normal = points.normals.row(k);
      const Eigen::Matrix3d across = 0.1 * Eigen::Matrix3d::Identity() + 0.9 * normal * normal.transpose();
      for (Index s = 0; s < inner; ++s) rows.block<3, 3>(3 * k, 3 * s) = boundary.size * basis[s].value() * across;
      for (int i = 0; i < 3; ++i) {
        const Jet<0> t = ray_parameter(at, i);
        const double kernel = slope_kernel(at, weights, i).value();
        for (int d = 0; d < 2; ++d) {
          if (scale[i][d] == 0) continue;
          const Vec3 direction = (kernel * scale[i][d]) * (across * directions[i][d](t.value()));
          for (int m = 0; m < slopes; ++m) {
            double f;
            functions[m].taylor(t.value(), 0, &f);
            rows.block<3, 1>(3 * k, 3 * inner + (2 * i + d) * slopes + m) = f * direction;
          }
        }
      }
      right.segment<3>(3 * k) = across * missing.row(k).transpose();
    }
    Eigen::VectorXd x = Eigen::VectorXd::Zero(unknowns);
    for (const Index m : {unknowns, 3 * inner}) {
      Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(m, m);
      normal.selfadjointView<Eigen::Lower>().rankUpdate(rows.leftCols(m).transpose());
      normal.diagonal().array() += 1e-6 * normal.trace() / static_cast<double>(m);
      x.setZero();
      x.head(m) = least_quadratic(normal, -rows.leftCols(m).transpose() * right, Eigen::MatrixXd(0, m));
      if (keeps_alpha(x)) break;
    }
    if (!x.allFinite()) return patch;
    std::array<PiecewisePolynomial, 3> changes;
    const std::array<double, 3> none = {0, 0, 0};
    for (int i = 0; i < 3; ++i)
      changes[i] = scale[i][0] == 0 && scale[i][1] == 0 ? PiecewisePolynomial::constant(none)
                                                        : added(x, i, 0) * directions[i][0] + added(x, i, 1) * directions[i][1];
    const Points coefficients = boundary.size * Eigen::Map<const Points>(x.data(), inner, 3);
    patch = sum(plain, tripatch::correction(std::move(changes), options.degree, options.bends, coefficients));
    if (round == 0) nearest(*patch, points.points, points.barycentric);
  }
  return patch;
}

}  // namespace tripatch
