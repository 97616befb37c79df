#include "tripatch/patch/fairing.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <tuple>

#include "tripatch/patch/curvature.h"
#include "tripatch/patch/energy.h"
#include "tripatch/patch/middle.h"
#include "tripatch/patch/rim_normals.h"
#include "tripatch/shares.h"

namespace tripatch {
namespace {

double choose(int n, int k) {
  double r = 1;
  for (int i = 1; i <= k; ++i) r = r * (n - k + i) / i;
  return r;
}

/// What a fairing adds to a patch.
class Correction final : public JetSurface<Correction> {
public:
  /// slopes: on each side, what is added to the derivative across it; coefficients: of scalar_basis, one a row.
  Correction(std::array<PiecewisePolynomial, 3> slopes, int degree, int bends, Points coefficients)
      : slopes_(std::move(slopes)), degree_(degree), bends_(bends), coefficients_(std::move(coefficients)) {}

  Vec3 corner(int) const { return Vec3::Zero(); }

  template <int N>
  JetPoint<N> at(const Barycentric<N>& b) const {
    JetPoint<N> p;
    const std::array<Jet<N>, 3> w = side_weights(b);
    for (int i = 0; i < 3; ++i) p += slope_kernel(b, w, i) * compose(slopes_[i], ray_parameter(b, i));
    const std::vector<Jet<N>> basis = scalar_basis(b, degree_, bends_);
    for (std::size_t k = 0; k < basis.size(); ++k)
      for (int x = 0; x < 3; ++x) p.x[x] += basis[k] * coefficients_(k, x);
    return p;
  }

  /// The part of a side-vertex patch that multiplies the derivative across side i.
  template <int N>
  static Jet<N> slope_kernel(const Barycentric<N>& b, const std::array<Jet<N>, 3>& w, int i) {
    const Jet<N> s = b[(i + 1) % 3] + b[(i + 2) % 3];
    return -(w[i] * (square(s) * b[i]));
  }

  static int scalars(int degree, int bends) { return (degree + 1) * (degree + 2) / 2 + 3 * bends; }

  /// The interior functions (27 b0 b1 b2)^2 B_K(b), then those that bend the patch across side i: 1/2 b_i^2, times the cubic side
  /// weight, times the Bernstein polynomials of t of degree bends - 1. These reach to the corners, where the interior is too flat.
  template <int N>
  static std::vector<Jet<N>> scalar_basis(const Barycentric<N>& b, int degree, int bends) {
    std::array<std::vector<Jet<N>>, 3> power;
    for (int i = 0; i < 3; ++i) {
      power[i].assign(degree + 1, Jet<N>(1.0));
      for (int k = 1; k <= degree; ++k) power[i][k] = power[i][k - 1] * b[i];
    }
    const Jet<N> bubble = square(27.0 * (b[0] * b[1] * b[2]));
    std::vector<Jet<N>> basis;
    basis.reserve(scalars(degree, bends));
    for (int i = degree; i >= 0; --i) {
      const Jet<N> first = bubble * power[0][i];
      for (int j = degree - i; j >= 0; --j)
        basis.push_back((choose(degree, i) * choose(degree - i, j)) * (first * (power[1][j] * power[2][degree - i - j])));
    }
    if (bends == 0) return basis;
    const std::array<Jet<N>, 3> weight = cubic_side_weights(b);
    for (int i = 0; i < 3; ++i) {
      const Jet<N> kernel = 0.5 * (square(b[i]) * weight[i]), t = ray_parameter(b, i), s = 1.0 - t;
      for (int m = 0; m < bends; ++m) {
        Jet<N> f = choose(bends - 1, m) * kernel;
        for (int k = 0; k < m; ++k) f *= t;
        for (int k = m + 1; k < bends; ++k) f *= s;
        basis.push_back(f);
      }
    }
    return basis;
  }

private:
  std::array<PiecewisePolynomial, 3> slopes_;
  int degree_, bends_;
  Points coefficients_;
};

/// The scalar functions of t that alpha and beta may gain: 4 t (1 - t) times the Bernstein polynomials of degree count - 1.
PiecewisePolynomial slope_function(int count, int m) {
  const std::array<double, 3> arch = {0, 2, 0};
  std::vector<double> net(count, 0.0);
  net[m] = 1;
  return PiecewisePolynomial::bezier(arch, 1) * PiecewisePolynomial::bezier(net, 1);
}

template <int N>
Eigen::Matrix<double, 9, 1> derivatives_of(const Jet<N>& f) {
  Eigen::Matrix<double, 9, 1> d;
  for (int k = 0; k < 9; ++k) d[k] = f.c[k + 1];
  for (int k : {2, 4}) d[k] *= 2;
  for (int k : {5, 8}) d[k] *= 6;
  for (int k : {6, 7}) d[k] *= 2;
  return d;
}

/// What is the same for all holes: nodes, the interior basis and the kernels of the slopes at them.
struct Shared {
  using Basis = Eigen::Matrix<double, 9, Eigen::Dynamic, Eigen::RowMajor>;
  Quadrature quadrature;
  std::vector<Basis> interior;                            // at each node
  std::vector<std::array<Jet<3>, 3>> parameter;           // t_i at each node
  std::vector<std::array<std::vector<Jet<3>>, 3>> slope;  // kernel times function m, of side i, at each node
  std::array<Eigen::MatrixXd, 4> rows, normal;            // by order m of derivatives: rows sqrt(w) D^m of the interior basis
  Eigen::MatrixXd combination;                            // of the scalar functions, one basis function a column
  static constexpr int side_points = 12;
  double side_sum = 0;                         // of sin(pi t)
  std::vector<double> side_t;                  // where curvature is compared along a side: denser towards the corners
  std::array<Eigen::MatrixXd, 3> side_second;  // there: second derivative of each basis function across side i
  Eigen::MatrixXd side_slope;                  // there: the functions of alpha and beta
  Eigen::RowVectorXd middle, middle_slope;     // at b = (1/3, 1/3, 1/3): scalar functions, and kernel times functions of a side

  Shared(int degree, int bends, int slopes, int nodes) : quadrature(corner_quadrature(nodes)) {
    const Index n = quadrature.b.rows(), count = Correction::scalars(degree, bends);
    std::vector<PiecewisePolynomial> functions;
    for (int m = 0; m < slopes; ++m) functions.push_back(slope_function(slopes, m));
    for (int m = 1; m <= 3; ++m) rows[m].resize((m + 1) * n, count);
    for (Index k = 0; k < n; ++k) {
      const Barycentric<3> b = cartesian_barycentric<3>(quadrature.b.row(k).data());
      const std::vector<Jet<3>> basis = Correction::scalar_basis(b, degree, bends);
      Basis all(9, count);
      for (Index c = 0; c < count; ++c) all.col(c) = derivatives_of(basis[c]);
      const double w = std::sqrt(quadrature.weights[k]);
      for (int m = 1; m <= 3; ++m)
        for (int d = 0; d <= m; ++d) rows[m].row((m + 1) * k + d) = w * factor(m, d) * all.row(first_of(m) + d);
      interior.push_back(std::move(all));
      const std::array<Jet<3>, 3> weights = side_weights(b);
      std::array<Jet<3>, 3> t;
      std::array<std::vector<Jet<3>>, 3> kernels;
      for (int i = 0; i < 3; ++i) {
        t[i] = ray_parameter(b, i);
        const Jet<3> kernel = Correction::slope_kernel(b, weights, i);
        for (const PiecewisePolynomial& f : functions) {
          std::array<double, 4> series;
          f.taylor(t[i].value(), 3, series.data());
          kernels[i].push_back(kernel * compose<3>(series.data(), 1, t[i]));
        }
      }
      parameter.push_back(t);
      slope.push_back(std::move(kernels));
    }
    // orthonormal in the third-derivative energy: Bernstein polynomials times the squared bubble are nearly dependent
    const Eigen::MatrixXd r =
        Eigen::HouseholderQR<Eigen::MatrixXd>(rows[3]).matrixQR().topRows(count).triangularView<Eigen::Upper>();
    combination = r.triangularView<Eigen::Upper>().solve(Eigen::MatrixXd::Identity(count, count));
    for (Basis& all : interior) all *= combination;
    for (int m = 1; m <= 3; ++m) {
      rows[m] *= combination;
      normal[m] = rows[m].transpose() * rows[m];
    }

    const std::array<double, 3> thirds = {1.0 / 3, 1.0 / 3, 1.0 / 3};
    const Barycentric<0> b(thirds.data());
    const std::vector<Jet<0>> basis = Correction::scalar_basis(b, degree, bends);
    middle.resize(count);
    for (Index c = 0; c < count; ++c) middle[c] = basis[c].value();
    middle *= combination;
    middle_slope.resize(slopes);
    for (int m = 0; m < slopes; ++m) functions[m].taylor(0.5, 0, &middle_slope[m]);
    middle_slope *= Correction::slope_kernel(b, side_weights(b), 0).value();

    side_slope.resize(side_points, slopes);
    for (int k = 0; k < side_points; ++k) {
      side_t.push_back(0.5 * (1 - std::cos(M_PI * (k + 0.5) / side_points)));
      side_sum += std::sin(M_PI * side_t[k]);
      for (int m = 0; m < slopes; ++m) functions[m].taylor(side_t[k], 0, &side_slope(k, m));
    }
    for (int i = 0; i < 3; ++i) {
      side_second[i].resize(side_points, count);
      for (int k = 0; k < side_points; ++k) {
        Barycentric<2> b;  // db0: the way along delta_i
        b[i] = Jet<2>::linear(0, 1, 0);
        b[(i + 1) % 3] = Jet<2>::linear(1 - side_t[k], -0.5, 0);
        b[(i + 2) % 3] = Jet<2>::linear(side_t[k], -0.5, 0);
        const std::vector<Jet<2>> basis = Correction::scalar_basis(b, degree, bends);
        for (Index c = 0; c < count; ++c) side_second[i](k, c) = 2 * basis[c].c[jet_index(2, 0)];
      }
      side_second[i] *= combination;
    }
  }

  /// Derivative d of order m counts as often as it occurs in D^m; where order m begins in Derivatives.
  static double factor(int m, int d) { return std::sqrt(choose(m, d)); }
  static int first_of(int m) { return (m - 1) * (m + 2) / 2; }
};

const Shared& shared(int degree, int bends, int slopes, int nodes) {
  static std::mutex mutex;
  static std::map<std::array<int, 4>, std::unique_ptr<Shared>> all;
  const std::lock_guard<std::mutex> lock(mutex);
  std::unique_ptr<Shared>& one = all[{degree, bends, slopes, nodes}];
  if (!one) one = std::make_unique<Shared>(degree, bends, slopes, nodes);
  return *one;
}

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

/// The unknowns of one hole: the interior coefficients, component by component, then alpha and beta of each side.
class Problem {
public:
  Problem(const Surface& base, const Sides& sides, const Boundary& boundary, const FairingOptions& options)
      : shared_(shared(options.degree, options.bends, options.slopes, options.nodes)),
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
    basis_.resize(base_.size());
    in_shares(0, static_cast<Index>(base_.size()), nodes_a_share, [&](Index from, Index to) {
      for (Index k = from; k < to; ++k) basis_[k] = slope_basis(k);
    });
  }

  Index unknowns() const { return 3 * interior_ + slopes_; }

  /// What the unknowns add to the middle of the patch, three rows; none where the middle is free.
  Eigen::MatrixXd held() const {
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(options_.middle ? 3 : 0, unknowns());
    if (!options_.middle) return rows;
    for (int x = 0; x < 3; ++x) rows.row(x).segment(x * interior_, interior_) = size_ * shared_.middle;
    for (int i = 0; i < 3; ++i)
      for (std::size_t f = 0; f < directions_[i].size(); ++f)
        rows.middleCols(3 * interior_ + first_[i] + f * options_.slopes, options_.slopes) =
            directions_[i][f](0.5) * shared_.middle_slope;
    return rows;
  }

  bool controlled() const { return options_.tension > 0 || options_.middle; }

  bool follows_curvature() const { return !followed_.empty(); }

  /// The relative jumps of normal curvature along the sides followed, over what is tolerated, as rows whose squares sum to the mean
  /// square; their derivatives where `rows` is given. With alpha and beta free the surroundings' part is quadratic in them:
  /// n . P_dd = II(d, d), d = alpha r + beta c', and what a change (a, b) of alpha, beta adds to n . P_dd of a patch whose slopes are
  /// carried by slope_kernel is 2 (1/2 - t) n . (a r' + b c'').
  Eigen::VectorXd jumps(const Eigen::VectorXd& x, Eigen::MatrixXd* rows = nullptr) const {
    constexpr int points = Shared::side_points;
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

  Derivatives derivatives(std::size_t node, const Eigen::VectorXd& x) const {
    Derivatives d = base_[node];
    const Eigen::Map<const Eigen::MatrixXd> scalars(x.data(), interior_, 3);
    d += size_ * shared_.interior[node].lazyProduct(scalars);
    Eigen::Map<Eigen::Matrix<double, 27, 1>>(d.data()) += basis_[node].lazyProduct(x.tail(slopes_));
    return d;
  }

  /// The integral of w |D^order P|^2 over the size squared: thin_plate (2), third_derivative (3), tension (1).
  Quadratic quadratic(int order) const {
    const int rows = order + 1, first = Shared::first_of(order);
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
          const double f = w * Shared::factor(order, d);
          slope.row(rows * k + d) = f * basis_[k].row(3 * (first + d) + c);
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
    Eigen::MatrixX2d parts(static_cast<Index>(base_.size()), 2);
    in_shares(0, parts.rows(), nodes_a_share, [&](Index from, Index to) {
      for (Index k = from; k < to; ++k) {
        const CurvatureVariation v = curvature_variation(derivatives(k, x), flat_curvature(size_));
        parts.row(k) << v.variation.squaredNorm(), v.quadric.squaredNorm();
        parts.row(k) *= shared_.quadrature.weights[k] * size_ * size_ * v.area;
      }
    });
    return {parts.col(0).sum(), parts.col(1).sum()};
  }

  /// Gauss-Newton's model about x of minimum_variation (which = 0) or quadric_variation (1), those asked for.
  void linearise(const Eigen::VectorXd& x, const std::array<bool, 2>& wanted, std::array<Quadratic, 2>& model) const {
    // in blocks of nodes, always the same, so that sums do not depend on the number of cores
    constexpr Index block = 96;
    const Index n = static_cast<Index>(base_.size()), blocks = (n + block - 1) / block;
    std::vector<std::array<Quadratic, 2>> parts(blocks);
    in_shares(0, blocks, 1, [&](Index from, Index to) {
      for (Index at = from; at < to; ++at) parts[at] = linearise(x, wanted, at * block, std::min(n, (at + 1) * block));
    });
    model = std::move(parts[0]);
    for (Index at = 1; at < blocks; ++at)
      for (int which = 0; which < 2; ++which) {
        if (!wanted[which]) continue;
        model[which].normal += parts[at][which].normal;
        model[which].gradient += parts[at][which].gradient;
        model[which].constant += parts[at][which].constant;
      }
  }

  Quadratic linearised_jumps(const Eigen::VectorXd& x) const {
    Eigen::MatrixXd columns;
    const Eigen::VectorXd value = jumps(x, &columns);
    const Rows rows = columns;
    return quadratic_of(rows, value);
  }

  /// How much of x can be added until alpha falls below a tenth of what it was.
  double reach(const Eigen::VectorXd& x) const {
    double most = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 3; ++i) {
      if (scale_[i][0] == 0) continue;
      const PiecewisePolynomial added = scale_[i][0] * combination(x, i, 0);
      for (int k = 1; k < 32; ++k) {
        double before, change;
        boundary_.ribbons[i].alpha.taylor(k / 32.0, 0, &before);
        added.taylor(k / 32.0, 0, &change);
        if (!(change >= 0)) most = std::min(most, -0.9 * before / change);
      }
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
    return std::make_shared<Correction>(std::move(slopes), options_.degree, options_.bends, std::move(a));
  }

private:
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  using SlopeBasis = Eigen::Matrix<double, 27, Eigen::Dynamic, Eigen::RowMajor>;
  static constexpr Index nodes_a_share = 64;

  /// The derivatives, at a node, of what the free slopes add.
  SlopeBasis slope_basis(Index node) const {
    SlopeBasis basis = SlopeBasis::Zero(27, slopes_);
    for (int i = 0; i < 3; ++i)
      for (std::size_t f = 0; f < directions_[i].size(); ++f) {
        const JetPoint<3> direction = compose(directions_[i][f], shared_.parameter[node][i]);
        for (int m = 0; m < options_.slopes; ++m)
          for (int x = 0; x < 3; ++x) {
            const Eigen::Matrix<double, 9, 1> d = derivatives_of(shared_.slope[node][i][m] * direction.x[x]);
            for (int order = 0; order < 9; ++order) basis(3 * order + x, first_[i] + f * options_.slopes + m) = d[order];
          }
      }
    return basis;
  }

  /// A side whose curvature the patch is to follow, at the points of Shared::side_t.
  struct Followed {
    int i;
    std::array<SideForm, Shared::side_points> form;
    std::array<double, Shared::side_points> alpha, beta;
    std::array<double, Shared::side_points> base;  // n . P_dd of the base
    std::array<double, Shared::side_points> weight;
  };

  /// The same of some of the nodes.
  std::array<Quadratic, 2> linearise(const Eigen::VectorXd& x, const std::array<bool, 2>& wanted, Index from, Index to) const {
    constexpr Index block = 24;  // nodes: their rows stay in the cache
    std::array<Quadratic, 2> model;
    std::array<Rows, 2> jacobian;
    std::array<Eigen::VectorXd, 2> value;
    for (int which = 0; which < 2; ++which) {
      if (!wanted[which]) continue;
      model[which].normal.setZero(unknowns(), unknowns());
      model[which].gradient.setZero(unknowns());
    }
    for (Index start = from; start < to; start += block) {
      const Index n = std::min(block, to - start);
      for (int which = 0; which < 2; ++which) {
        if (!wanted[which]) continue;
        jacobian[which].resize(4 * n, unknowns());
        value[which].resize(4 * n);
      }
      for (Index k = start; k < start + n; ++k) {
        const CurvatureVariationRows v = curvature_variation_rows(derivatives(k, x), flat_curvature(size_));
        const double w = std::sqrt(shared_.quadrature.weights[k]) * size_;
        const Index row = 4 * (k - start);
        for (int which = 0; which < 2; ++which) {
          if (!wanted[which]) continue;
          value[which].segment<4>(row) = w * v.value.segment<4>(4 * which);
          const Eigen::Matrix<double, 4, 27, Eigen::RowMajor> rows = w * v.derivative.middleRows<4>(4 * which);
          for (int c = 0; c < 3; ++c) {
            Eigen::Matrix<double, 4, 9, Eigen::RowMajor> part;
            for (int d = 0; d < 9; ++d) part.col(d) = size_ * rows.col(3 * d + c);
            jacobian[which].block(row, c * interior_, 4, interior_) = part.lazyProduct(shared_.interior[k]);
          }
          jacobian[which].block(row, 3 * interior_, 4, slopes_) = rows.lazyProduct(basis_[k]);
        }
      }
      for (int which = 0; which < 2; ++which) {
        if (!wanted[which]) continue;
        model[which].normal.selfadjointView<Eigen::Lower>().rankUpdate(jacobian[which].transpose());
        model[which].gradient.noalias() += jacobian[which].transpose() * value[which];
        model[which].constant += value[which].squaredNorm();
      }
    }
    for (int which = 0; which < 2; ++which)
      if (wanted[which]) model[which].normal = model[which].normal.selfadjointView<Eigen::Lower>();
    return model;
  }

  void follow_curvature(const Surface& base) {
    constexpr int points = Shared::side_points;
    double curvature = 0;  // mean square of the sides'
    for (int i = 0; i < 3; ++i) {
      if (!options_.curvature[i] || sides_[i].q.empty() || scale_[i][0] == 0) continue;
      Followed side;
      side.i = i;
      Eigen::Matrix<double, points, 3, Eigen::RowMajor> b = Eigen::Matrix<double, points, 3, Eigen::RowMajor>::Zero();
      Eigen::Matrix<double, points, 18, Eigen::RowMajor> jets;
      for (int k = 0; k < points; ++k) {
        b(k, (i + 1) % 3) = 1 - shared_.side_t[k];
        b(k, (i + 2) % 3) = shared_.side_t[k];
      }
      base.evaluate(b.data(), points, 2, jets.data());
      const double d0 = i == 0 ? 1 : -0.5, d1 = i == 1 ? 1 : -0.5;
      for (int k = 0; k < points; ++k) {
        const double t = shared_.side_t[k];
        const SideForm form = side_form(sides_[i], t);
        side.form[k] = form;
        boundary_.ribbons[i].alpha.taylor(t, 0, &side.alpha[k]);
        boundary_.ribbons[i].beta.taylor(t, 0, &side.beta[k]);
        const Vec3 second = 2 * (d0 * d0 * jets.row(k).segment<3>(9) + d0 * d1 * jets.row(k).segment<3>(12) +
                                 d1 * d1 * jets.row(k).segment<3>(15));
        side.base[k] = form.n.dot(second);
        side.weight[k] = 1 / form.across(side.alpha[k] * form.r);
        curvature += form.squared_norm() / points / 3;
      }
      followed_.push_back(side);
    }
    const double unit = options_.curvature_jump * std::sqrt(curvature + flat_curvature(size_));
    for (Followed& side : followed_)
      for (int k = 0; k < points; ++k)
        side.weight[k] *=
            std::sqrt((0.05 + std::sin(M_PI * shared_.side_t[k])) / (3 * (0.05 * points + shared_.side_sum))) / unit;
  }

  static Quadratic quadratic_of(const Eigen::Ref<const Rows>& jacobian, const Eigen::VectorXd& value) {
    Quadratic q;
    q.normal.setZero(jacobian.cols(), jacobian.cols());
    q.normal.selfadjointView<Eigen::Lower>().rankUpdate(jacobian.transpose());
    q.normal = q.normal.selfadjointView<Eigen::Lower>();
    q.gradient.noalias() = jacobian.transpose() * value;
    q.constant = value.squaredNorm();
    return q;
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
    const PiecewisePolynomial along = sides_[i].c.derivative();
    if (options_.slopes_free[i] && !options_.position_only[i] && !sides_[i].r.empty()) {
      double r = 0, c = 0;
      for (int k = 0; k <= 16; ++k) {
        r += sides_[i].r(k / 16.0).norm() / 17;
        c += along(k / 16.0).norm() / 17;
      }
      scale_[i] = {r > 0 ? size_ / r : 0, c > 0 ? size_ / c : 0};
    }
    directions_[i] = directions_of(sides_[i], i);
    return directions_[i].size();
  }

  PiecewisePolynomial combination(const Eigen::VectorXd& x, int i, std::size_t direction) const {
    const int m = options_.slopes;
    std::vector<double> net(m);
    for (int k = 0; k < m; ++k) net[k] = x[3 * interior_ + first_[i] + static_cast<Index>(direction) * m + k];
    const std::array<double, 3> arch = {0, 2, 0};
    return PiecewisePolynomial::bezier(arch, 1) * PiecewisePolynomial::bezier(net, 1);
  }

  const Shared& shared_;
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
  std::vector<SlopeBasis> basis_;                    // of the slopes, at each node
};

/// The y that makes y . (normal y + 2 gradient) least among those with held y = 0; factor: of normal.
template <class Factor>
Eigen::VectorXd least(const Factor& factor, const Eigen::VectorXd& gradient, const Eigen::Ref<const Eigen::MatrixXd>& held) {
  Eigen::VectorXd y = -factor.solve(gradient);
  if (held.rows() == 0) return y;
  const Eigen::MatrixXd across = factor.solve(held.transpose());
  const Eigen::LDLT<Eigen::MatrixXd> small(held * across);
  for (int pass = 0; pass < 2; ++pass) y -= across * small.solve(held * y);  // twice, for the last digits
  return y;
}

/// The minimum of a quadratic energy, slopes free; with the scalar functions alone where alpha would leave its bound, or, where tension
/// or the middle is a person's to change (which shall not jump), most of the way from there to the bound. Curvature that is to be followed weighs a tenth of the energy at the start for each jump tolerated; two
/// passes, because slopes enter it squared.
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
      x.head(m) += least(normal.ldlt(), gradient, held.leftCols(m));
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
  Merit(const Problem& problem, const Quadratic& third, const Quadratic& tension, const std::string& energy)
      : problem_(problem),
        third_(third),
        tension_(tension),
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
      y = least(normal.llt(), gradient, held_);
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
  const Quadratic &third_, &tension_;
  Eigen::MatrixXd held_;
  bool quadric_, whole_;
};

/// Levenberg and Marquardt, damped in `metric` so that what the energy leaves open stays put: every step goes down. Stops when a step
/// gains less than `enough` (relative) or the energy is next to none. Returns the steps taken.
int descend(const Merit& merit, const Eigen::MatrixXd& metric, Eigen::VectorXd& x, Merit::Value& value, int iterations) {
  constexpr double enough = 5e-3, none = 1e-4;
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

/// The polynomial that has f's value and first kept - 1 derivatives at both ends.
class Ends {
public:
  Ends(const PiecewisePolynomial& f, int kept) : coefficients_(2 * kept, 3) {
    if (kept == 0) return;
    Eigen::MatrixXd conditions(2 * kept, 2 * kept), given(2 * kept, 3);
    for (int end = 0; end < 2; ++end)
      for (int order = 0; order < kept; ++order) {
        for (int k = 0; k < 2 * kept; ++k) conditions(end * kept + order, k) = end == 0 ? double(k == order) : choose(k, order);
        given.row(end * kept + order) = (order == 0 ? f(end) : f.derivative_at(end, order)) / (order == 2 ? 2 : 1);
      }
    coefficients_ = conditions.partialPivLu().solve(given);
  }

  Eigen::RowVector3d operator()(double t) const {
    Eigen::RowVector3d p = Eigen::RowVector3d::Zero();
    for (Index k = coefficients_.rows() - 1; k >= 0; --k) p = t * p + coefficients_.row(k);
    return p;
  }

private:
  Eigen::MatrixXd coefficients_;  // of powers of t
};

/// Polynomial of t by least squares with given ends.
struct FittedPolynomial {
  int degree, kept;
  const Ends& ends;
  Eigen::MatrixXd coefficients;
  double residual;  // largest, at the values

  FittedPolynomial(const Eigen::VectorXd& t, const Eigen::MatrixXd& values, int of_degree, int of_kept, const Ends& given)
      : degree(of_degree), kept(of_kept), ends(given) {
    const Index n = t.size();
    Eigen::MatrixXd basis(n, degree + 1), rest = values;
    for (Index k = 0; k < n; ++k) {
      basis.row(k) = chebyshev(t[k]);
      rest.row(k) -= ends(t[k]);
    }
    coefficients = basis.householderQr().solve(rest);
    residual = (basis * coefficients - rest).rowwise().norm().maxCoeff();
  }

  Eigen::RowVectorXd chebyshev(double t) const {
    Eigen::RowVectorXd row(degree + 1);
    const double x = 2 * t - 1;
    row[0] = 1;
    if (degree > 0) row[1] = x;
    for (int d = 2; d <= degree; ++d) row[d] = 2 * x * row[d - 1] - row[d - 2];
    return row * std::pow(4 * t * (1 - t), kept);
  }

  PiecewisePolynomial field() const {
    return PiecewisePolynomial::fit(
        [&](std::span<const double> t, std::span<double> out) {
          for (std::size_t k = 0; k < t.size(); ++k) {
            const Eigen::RowVector3d v = chebyshev(t[k]) * coefficients + ends(t[k]);
            std::copy_n(v.data(), 3, out.begin() + static_cast<Index>(3 * k));
          }
        },
        3, 1e-11, degree + 2 * kept, 0);
  }
};

/// The polynomial of least degree that is nearly as near as that of the highest, or the field itself where that is not near or
/// where it has few pieces. `rim`: the parameters of the mesh vertices; `kept`: how much of the ends, see Ends.
PiecewisePolynomial smoothed(const PiecewisePolynomial& f, const std::vector<double>& rim, int kept) {
  constexpr std::size_t few = 8;
  if (f.empty() || rim.size() <= few) return f;
  const Eigen::Map<const Eigen::VectorXd> t(rim.data(), static_cast<Index>(rim.size()));
  Eigen::MatrixXd values(t.size(), 3);
  double scale = 0;
  for (Index k = 0; k < t.size(); ++k) {
    values.row(k) = f(t[k]);
    scale = std::max(scale, (values.row(k) - values.row(0)).norm() + (kept == 3 ? 0 : values.row(k).norm()));
  }
  const Ends ends(f, kept);
  const int most = static_cast<int>(std::clamp<Index>((t.size() - 1) / 2 - kept, 4, 16));
  const double best = FittedPolynomial(t, values, most, kept, ends).residual;
  if (best > 1e-3 * scale) return f;
  for (int degree = std::min(6, most);; degree += 2) {
    const FittedPolynomial polynomial(t, values, std::min(degree, most), kept, ends);
    if (polynomial.residual <= std::max(2 * best, 2e-5 * scale) || degree >= most) return polynomial.field();
  }
}

/// A little of the interior term against folds (report.h): points of a grid that face away from the blend of the rim's normals, and
/// neighbours whose normals are far apart. The least in third derivatives, with a penalty on each fold that grows. Returns the
/// correction that leaves fewest and does not go far, or none.
SurfacePtr unfolding(const SurfacePtr& patch, const Sides& sides, double size, const std::function<Index(const Surface&)>& folds,
                     Index& least) {
  constexpr int rows = 64, rounds = 16, patience = 5, degree = 9;
  constexpr double faces = 0.02, neighbours = 0.55;  // cosines: least wanted
  constexpr double far = 0.25;                       // times the size: where that is not enough, nothing is
  const Shared& functions = shared(degree, 0, 0, 8);
  const Index count = functions.combination.cols();
  std::vector<Vec3> wanted;
  std::vector<double> at;
  std::vector<std::array<Index, 2>> edges;
  const RimNormals rim(sides);
  for (int q = 1; q < rows; ++q)
    for (int p = 1; p + q < rows; ++p) {
      const Index here = static_cast<Index>(wanted.size()), above = here + rows - 1 - q;
      if (p + q + 1 < rows) edges.insert(edges.end(), {{here, here + 1}, {here, above}, {here + 1, above}});
      const std::array<double, 3> b = {double(rows - p - q) / rows, double(p) / rows, double(q) / rows};
      wanted.push_back(rim.at(b.data()).normalized());
      at.insert(at.end(), b.begin(), b.end());
    }
  const Index points = static_cast<Index>(wanted.size());
  Eigen::MatrixXd first(2 * points, count);  // derivatives of the functions in b0 and b1, over the size
  for (Index k = 0; k < points; ++k) {
    const std::vector<Jet<1>> basis = Correction::scalar_basis(Barycentric<1>(&at[3 * k]), degree, 0);
    for (Index c = 0; c < count; ++c) first.block<2, 1>(2 * k, c) << basis[c].c[1], basis[c].c[2];
  }
  first = size * (first * functions.combination);
  Eigen::Matrix<double, Eigen::Dynamic, 9, Eigen::RowMajor> jets(points, 9);
  patch->evaluate(at.data(), points, 1, jets.data());

  const std::array<double, 3> none = {0, 0, 0};
  const PiecewisePolynomial zero = PiecewisePolynomial::constant(none);
  SurfacePtr best;
  Eigen::MatrixXd x = Eigen::MatrixXd::Zero(count, 3);
  double penalty = 10;
  for (int round = 0, idle = 0; round < rounds && idle < patience && least > 0; ++round, ++idle, penalty *= 3) {
    std::vector<Vec3> p(points), q(points), normal(points);
    std::vector<double> area(points);
    for (Index k = 0; k < points; ++k) {
      p[k] = jets.row(k).segment<3>(3).transpose() + x.transpose() * first.row(2 * k).transpose();
      q[k] = jets.row(k).segment<3>(6).transpose() + x.transpose() * first.row(2 * k + 1).transpose();
      area[k] = p[k].cross(q[k]).norm();
      normal[k] = p[k].cross(q[k]) / area[k];
    }
    Eigen::MatrixXd folded(3 * count, points + static_cast<Index>(edges.size()));  // what takes each fold away, one a column
    Eigen::VectorXd lacking(folded.cols());
    Index active = 0;
    // what a change does to n_k . m: (dp x q + p x dq) . m' = dp . (q x m') + dq . (m' x p), m' the part of m across n_k, over the area
    const auto add = [&](Index k, const Vec3& m) {
      const Vec3 across = (m - normal[k] * normal[k].dot(m)) / area[k], of_p = q[k].cross(across), of_q = across.cross(p[k]);
      for (int c = 0; c < 3; ++c)
        folded.col(active).segment(c * count, count) += of_p[c] * first.row(2 * k) + of_q[c] * first.row(2 * k + 1);
    };
    for (Index k = 0; k < points; ++k) {
      lacking[active] = faces - normal[k].dot(wanted[k]);
      if (!(lacking[active] > 0)) continue;
      folded.col(active).setZero();
      add(k, wanted[k]);
      ++active;
    }
    for (const auto& [a, b] : edges) {
      lacking[active] = neighbours - normal[a].dot(normal[b]);
      if (!(lacking[active] > 0)) continue;
      folded.col(active).setZero();
      add(a, normal[b]);
      add(b, normal[a]);
      ++active;
    }
    if (active == 0) break;  // folds are counted on more than this grid, or on a patch with more added
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(3 * count, 3 * count);
    const auto columns = folded.leftCols(active);
    matrix.selfadjointView<Eigen::Lower>().rankUpdate(columns, penalty);
    const Eigen::VectorXd right = penalty * columns * (lacking.head(active) + columns.transpose() * x.reshaped());
    x.reshaped() = matrix.selfadjointView<Eigen::Lower>().llt().solve(right);
    if (!x.allFinite()) break;
    const SurfacePtr correction = std::make_shared<Correction>(std::array<PiecewisePolynomial, 3>{zero, zero, zero}, degree, 0,
                                                               Points(size * (functions.combination * x)));
    const Points added = correction->positions(Eigen::Map<const Points>(at.data(), points, 3));
    if (!(added.rowwise().norm().maxCoeff() < far * size)) break;
    const Index left = folds(*sum(patch, correction));
    if (left < least) {
      least = left;
      best = correction;
      idle = -1;
    }
  }
  return best;
}

}  // namespace

Sides smoothed(const Sides& sides) {
  Sides out = sides;
  for (Side& side : out) {
    side.c = smoothed(side.c, side.rim, 3);  // what the patch's second derivatives at the corners are made of stays
    side.r = smoothed(side.r, side.rim, 2);
    side.q = smoothed(side.q, side.rim, 0);
  }
  return out;
}

FairResult fair(const SurfacePtr& base, const Sides& sides, const Boundary& boundary, const FairingOptions& options) {
  const std::array<std::string, 5> names = {"thin_plate", "third_derivative", "minimum_variation", "quadric_variation", "auto"};
  const auto name = std::find(names.begin(), names.end(), options.energy);
  if (name == names.end())
    throw InvalidArgument("No energy is called '" + options.energy +
                          "'; there are: thin_plate, third_derivative, minimum_variation, quadric_variation, auto");
  const bool quadratic = name < names.begin() + 2;

  FairResult result;
  result.energy = options.energy;
  const SurfacePtr start = options.middle ? with_middle(base, *options.middle) : base;
  result.patch = start;
  const Sides even = options.rebuild ? smoothed(sides) : sides;
  auto [even_boundary, even_base] = options.rebuild ? options.rebuild(even) : std::pair{boundary, base};
  if (options.middle) even_base = with_middle(even_base, *options.middle);
  const Problem problem(*even_base, even, even_boundary, options);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(problem.unknowns());
  const Quadratic third = problem.quadratic(3);
  Quadratic tension;
  if (options.tension > 0) {
    tension = problem.quadratic(1);
    const double wave = 2 * M_PI, weight = options.tension * std::pow(wave, options.energy == "thin_plate" ? 2 : 4);
    tension.normal *= weight;
    tension.gradient *= weight;
    tension.constant *= weight;
  }
  std::vector<std::pair<Eigen::VectorXd, double>> tried;  // best first
  if (quadratic) {
    Quadratic q = options.energy == "thin_plate" ? problem.quadratic(2) : third;
    if (options.tension > 0) q += tension;
    const double unit = boundary.size * boundary.size;
    result.before = unit * q.constant;
    const Eigen::VectorXd x = minimum(problem, q);
    tried.emplace_back(x, unit * q(x));
  } else {
    if (options.tension > 0) tension.constant -= tension(least(tension.normal.ldlt(), tension.gradient, problem.held()));
    const Merit merit(problem, third, tension, options.energy);
    Eigen::VectorXd x = minimum(problem, third);
    const Merit::Value before = merit(zero);
    Merit::Value value = merit(x);
    result.before = before.energy;
    if (value.log < before.log)
      tried.emplace_back(x, value.energy);
    else
      x = zero, value = before;
    result.iterations = descend(merit, third.normal, x, value, options.iterations);
    if (result.iterations > 0) tried.emplace(tried.begin(), x, value.energy);
  }
  result.after = result.before;
  SurfacePtr even_patch = even_base;  // the result, on smoothed sides: what energies are measured on
  for (const auto& [x, e] : tried) {
    if (!(e <= result.before)) continue;
    const SurfacePtr correction = problem.correction(x, sides);
    SurfacePtr patch = sum(base, correction);
    if (options.middle) patch = with_middle(patch, *options.middle);  // last: `even` and `sides` differ a little
    if (options.folds) {
      const Index folds = options.folds(*patch);
      if (folds > 0 && !result.folds) result.folds = options.folds(*start);  // counted only when needed
      if (folds > 0 && folds > *result.folds) {
        result.warnings = {"The fairest patch would fold over itself; a less fair one is used"};
        continue;
      }
      result.folds = folds;
    }
    result.patch = patch;
    result.after = e;
    even_patch = sum(even_base, correction);
    break;
  }
  if (options.folds && result.folds.value_or(0) > 0 && !options.middle)  // a given middle stays where it is
    if (const SurfacePtr correction = unfolding(result.patch, sides, boundary.size, options.folds, *result.folds)) {
      result.patch = sum(result.patch, correction);
      if (options.tension == 0) result.after = energy(*sum(even_patch, correction), options.energy, boundary.size, options.nodes);
    }
  return result;
}

SurfacePtr follow(const SurfacePtr& base, const Sides& sides, const Boundary& boundary, SurfacePoints points,
                  const FairingOptions& options) {
  const int slopes = options.slopes;
  const Index scalars = Correction::scalars(options.degree, options.bends), n = points.points.rows();
  std::vector<PiecewisePolynomial> functions;
  for (int m = 0; m < slopes; ++m) functions.push_back(slope_function(slopes, m));
  // r and c' are of any length; a hole is as long as its size
  std::array<std::array<PiecewisePolynomial, 2>, 3> directions;
  std::array<std::array<double, 2>, 3> scale = {};
  for (int i = 0; i < 3; ++i) {
    if (!options.slopes_free[i] || sides[i].r.empty()) continue;
    directions[i] = {sides[i].r, sides[i].c.derivative()};
    for (int d = 0; d < 2; ++d) {
      double length = 0;
      for (int k = 0; k <= 16; ++k) length += directions[i][d](k / 16.0).norm() / 17;
      if (length > 0) scale[i][d] = boundary.size / length;
    }
  }
  const auto added = [&](const Eigen::VectorXd& x, int i, int d) {
    PiecewisePolynomial f = (scale[i][d] * x[3 * scalars + (2 * i + d) * slopes]) * functions[0];
    for (int m = 1; m < slopes; ++m) f = f + (scale[i][d] * x[3 * scalars + (2 * i + d) * slopes + m]) * functions[m];
    return f;
  };
  const auto keeps_alpha = [&](const Eigen::VectorXd& x) {
    for (int i = 0; i < 3; ++i) {
      if (scale[i][0] == 0) continue;
      const PiecewisePolynomial change = added(x, i, 0);
      for (int k = 1; k < 32; ++k) {
        double before, more;
        boundary.ribbons[i].alpha.taylor(k / 32.0, 0, &before);
        change.taylor(k / 32.0, 0, &more);
        if (!(before + more >= 0.1 * before)) return false;
      }
    }
    return true;
  };

  SurfacePtr patch = base;
  for (int round = 0; round < 2; ++round) {
    Points b = (points.barycentric.array() + 1e-9).matrix();  // at a vertex the terms are 0/0
    for (Index k = 0; k < n; ++k) b.row(k) /= b.row(k).sum();
    const Points missing = points.points - base->positions(b);
    const Index unknowns = 3 * scalars + 6 * slopes;
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(3 * n, unknowns);
    Eigen::VectorXd right(3 * n);
    for (Index k = 0; k < n; ++k) {
      const Barycentric<0> at(b.row(k).data());
      const std::vector<Jet<0>> basis = Correction::scalar_basis(at, options.degree, options.bends);
      const std::array<Jet<0>, 3> weights = side_weights(at);
      const Vec3 normal = points.normals.row(k);
      const Eigen::Matrix3d across = 0.1 * Eigen::Matrix3d::Identity() + 0.9 * normal * normal.transpose();
      for (Index s = 0; s < scalars; ++s) rows.block<3, 3>(3 * k, 3 * s) = boundary.size * basis[s].value() * across;
      for (int i = 0; i < 3; ++i) {
        const Jet<0> t = ray_parameter(at, i);
        const double kernel = Correction::slope_kernel(at, weights, i).value();
        for (int d = 0; d < 2; ++d) {
          if (scale[i][d] == 0) continue;
          const Vec3 direction = (kernel * scale[i][d]) * (across * directions[i][d](t.value()));
          for (int m = 0; m < slopes; ++m) {
            double f;
            functions[m].taylor(t.value(), 0, &f);
            rows.block<3, 1>(3 * k, 3 * scalars + (2 * i + d) * slopes + m) = f * direction;
          }
        }
      }
      right.segment<3>(3 * k) = across * missing.row(k).transpose();
    }
    Eigen::VectorXd x = Eigen::VectorXd::Zero(unknowns);
    for (const Index m : {unknowns, 3 * scalars}) {
      Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(m, m);
      normal.selfadjointView<Eigen::Lower>().rankUpdate(rows.leftCols(m).transpose());
      normal.diagonal().array() += 1e-6 * normal.trace() / static_cast<double>(m);
      x.setZero();
      x.head(m) = normal.selfadjointView<Eigen::Lower>().ldlt().solve(rows.leftCols(m).transpose() * right);
      if (keeps_alpha(x)) break;
    }
    if (!x.allFinite()) return patch;
    std::array<PiecewisePolynomial, 3> changes;
    const std::array<double, 3> none = {0, 0, 0};
    for (int i = 0; i < 3; ++i)
      changes[i] = scale[i][0] == 0 && scale[i][1] == 0 ? PiecewisePolynomial::constant(none)
                                                        : added(x, i, 0) * directions[i][0] + added(x, i, 1) * directions[i][1];
    const Points coefficients = boundary.size * Eigen::Map<const Points>(x.data(), scalars, 3);
    patch = sum(base, std::make_shared<Correction>(std::move(changes), options.degree, options.bends, coefficients));
    if (round == 0) nearest(*patch, points.points, points.barycentric);
  }
  return patch;
}

}  // namespace tripatch
