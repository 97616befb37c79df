#include "tripatch/patch/point_formula.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>
#include <vector>

#include "tripatch/math/thresholds.h"
#include "tripatch/math/unit_vector.h"
#include "tripatch/patch/ray_weights.h"
#include "tripatch/patch/side_fields.h"

namespace tripatch {
namespace {

PiecewisePolynomial sum_of(const PiecewisePolynomial& a, const PiecewisePolynomial& b) {
  return a.empty() ? b : b.empty() ? a : a + b;
}

int degree_inside(const Points& inside) {
  int degree = -1;
  while (jet_size(degree) < inside.rows()) ++degree;
  return degree;
}

/// Polynomials of two variables, highest power of the first first and of each the highest of the second first.
Points sum_inside(const Points& a, const Points& b) {
  if (a.rows() < b.rows()) return sum_inside(b, a);
  Points sum = a;
  const int degree = degree_inside(a), lower = degree_inside(b);
  Index from = 0, to = 0;
  for (int i = 0; i <= degree; ++i) {  // rows of i + 1
    if (const int row = i - (degree - lower); row >= 0) {
      sum.middleRows(to + i - row, row + 1) += b.middleRows(from, row + 1);
      from += row + 1;
    }
    to += i + 1;
  }
  return sum;
}

}  // namespace

PointTerms operator+(const PointTerms& a, const PointTerms& b) {
  PointTerms sum;
  for (int i = 0; i < 3; ++i) {
    const PointTerms::Ray &p = a.rays[i], &q = b.rays[i];
    PointTerms::Ray& ray = sum.rays[i];
    ray = {sum_of(p.curve, q.curve), sum_of(p.slope, q.slope), sum_of(p.added, q.added),
           p.corner + q.corner,      p.to_next + q.to_next,    p.to_previous + q.to_previous};
    ray.is_quintic = p.is_quintic || q.is_quintic;
    for (int k = 0; k < 4; ++k) {
      ray.vertex_second[k] = p.vertex_second[k] + q.vertex_second[k];
      ray.side_second[k] = p.side_second[k] + q.side_second[k];
    }
    sum.second_cross[i] = sum_of(a.second_cross[i], b.second_cross[i]);
  }
  sum.moved_by = a.moved_by + b.moved_by;
  sum.inside = sum_inside(a.inside, b.inside);
  return sum;
}

PointFormula::PointFormula(std::function<PointTerms()> terms) : terms_(std::move(terms)) {}

const PointFormula* formula_of(const Surface& surface) {
  const auto* const has = dynamic_cast<const FormulaSurface*>(&surface);
  return has ? has->formula() : nullptr;
}

#ifdef TRIPATCH_PACKS

namespace {

/// Without the highest powers of which derivatives feel nothing: Chebyshev polynomials instead of them.
PiecewisePolynomial economized(const PiecewisePolynomial& given) {
  if (given.empty()) return given;
  const int dimension = given.dimension(), full = given.degree();
  std::vector<double> a(given.coefficients().begin(), given.coefficients().end());
  const auto at = [&](Index piece, int power) { return &a[(piece * (full + 1) + power) * dimension]; };
  double largest = 0;  // derivative in the middle of a piece
  for (Index p = 0; p < given.pieces() && full > 0; ++p)
    for (int x = 0; x < dimension; ++x) largest = std::max(largest, std::abs(at(p, 1)[x]));
  int degree = full;
  for (; degree > 3; --degree) {
    double lost = 0;
    for (Index p = 0; p < given.pieces(); ++p) {
      const double quarter = 0.25 * (given.breaks()[p + 1] - given.breaks()[p]), share = std::pow(quarter, degree - 1);
      for (int x = 0; x < dimension; ++x) lost = std::max(lost, std::abs(at(p, degree)[x]) * degree * degree * share);
    }
    if (!(lost <= tolerance::rounding * largest)) break;
    for (Index p = 0; p < given.pieces(); ++p) {
      const double half = 0.5 * (given.breaks()[p + 1] - given.breaks()[p]);
      double share = 1;
      for (int j = 0, k = degree; k >= 2; ++j, k -= 2) {
        share *= -half * half * k * (k - 1) / (4.0 * (j + 1) * (degree - j - 1));
        for (int x = 0; x < dimension; ++x) at(p, k - 2)[x] -= share * at(p, degree)[x];
      }
    }
  }
  std::vector<double> kept;
  for (Index p = 0; p < given.pieces(); ++p) kept.insert(kept.end(), at(p, 0), at(p, 0) + (degree + 1) * dimension);
  return {given.breaks(), degree, dimension, std::move(kept)};
}

/// Numerators of homogeneous coordinates and their three derivatives, of which differences are those in the plane.
struct Rational {
  Pack value[3];
  Pack slope[3][3];  // by coordinate, then component
};

TRIPATCH_FUSED_INLINE void load_points(const double* from, Pack (&to)[3]) {
  const Pack p = *reinterpret_cast<const LoosePack*>(from), q = *reinterpret_cast<const LoosePack*>(from + 4),
             r = *reinterpret_cast<const LoosePack*>(from + 8);
  const Pack low = __builtin_shufflevector(p, q, 0, 1, 6, 7), high = __builtin_shufflevector(q, r, 0, 1, 6, 7),
             ends = __builtin_shufflevector(p, r, 2, 3, 4, 5);  // x0 y0 x2 y2, y1 z1 y3 z3, z0 x1 z2 x3
  to[0] = __builtin_shufflevector(low, ends, 0, 5, 2, 7);
  to[1] = __builtin_shufflevector(low, high, 1, 4, 3, 6);
  to[2] = __builtin_shufflevector(ends, high, 0, 5, 2, 7);
}

TRIPATCH_FUSED_INLINE void store_points(const Pack (&from)[3], double* to) {
  const Pack low = __builtin_shufflevector(from[0], from[1], 0, 4, 2, 6),
             ends = __builtin_shufflevector(from[2], from[0], 0, 5, 2, 7),
             high = __builtin_shufflevector(from[1], from[2], 1, 5, 3, 7);
  *reinterpret_cast<LoosePack*>(to) = __builtin_shufflevector(low, ends, 0, 1, 4, 5);
  *reinterpret_cast<LoosePack*>(to + 4) = __builtin_shufflevector(high, low, 0, 1, 6, 7);
  *reinterpret_cast<LoosePack*>(to + 8) = __builtin_shufflevector(ends, high, 2, 3, 6, 7);
}

}  // namespace

class PointFormula::Kernel {
public:
  virtual ~Kernel() = default;
  virtual void evaluate(const Surface& surface, const double* b, Index n, double* positions, double* normals) const = 0;
  template <bool Faired, bool Quintic, int Curve, int Slope, int Added = -1>
  class With;
};

/// Degrees of the fields of sides; Added, of quintic rays: what is added to their slopes.
template <bool Faired, bool Quintic, int Curve, int Slope, int Added>
class PointFormula::Kernel::With final : public Kernel {
public:
  explicit With(const PointTerms& terms)
      : rays_{Ray(terms, 0), Ray(terms, 1), Ray(terms, 2)},
        origin_(terms.rays[0].corner + terms.moved_by),
        degree_(degree_inside(terms.inside)) {
    for (Index k = 0; k < terms.inside.rows(); ++k) inside_.push_back(spread_out(terms.inside.row(k).data()));
  }

private:
  using Fields = SideFields<Curve, Slope, Added>;
  struct Ray {
    Spread corner, to_next, turned;  ///< corner: seen from the first
    Fields side;                     ///< seen from the corner
    std::vector<Spread> second_cross, vertex_second, side_second;

    Ray(const PointTerms& terms, int i)
        : corner(spread_out(Vec3(terms.rays[i].corner - terms.rays[0].corner).data())),
          to_next(spread_out(terms.rays[i].to_next.data())),
          turned(spread_out(Vec3(terms.rays[i].to_previous - terms.rays[i].to_next).data())),
          side(or_zero(terms.rays[i].curve) - PiecewisePolynomial::constant({terms.rays[i].corner.data(), 3}),
               or_zero(terms.rays[i].slope), or_zero(terms.rays[i].added)) {
      for (int k = 0; k < 4; ++k) {
        vertex_second.push_back(spread_out(terms.rays[i].vertex_second[k].data()));
        side_second.push_back(spread_out(terms.rays[i].side_second[k].data()));
      }
      const PiecewisePolynomial bend = or_zero(terms.second_cross[i]).refined({}, 3);
      for (int k = 0; k <= bend.degree(); ++k) second_cross.push_back(spread_out(&bend.coefficients()[3 * k]));
    }
    static PiecewisePolynomial or_zero(const PiecewisePolynomial& field) {
      const std::array<double, 3> zero = {0, 0, 0};
      return field.empty() ? PiecewisePolynomial::constant(zero) : field;
    }
  };
  struct OnRay {
    Pack over, t;  ///< 1 / s and the parameter of the side
    typename Fields::Place place;
  };
  using Pieces = std::array<Index, 3>;

  TRIPATCH_FUSED void evaluate(const Surface& surface, const double* b, Index n, double* positions,
                               double* normals) const override {
    double rest[3 * lanes], there[3 * lanes], beside[3 * lanes];  // the last point again where there are no more
    Pieces last = {0, 0, 0};
    for (Index k = 0; k < n; k += lanes) {
      const Index count = std::min<Index>(lanes, n - k);
      const bool whole = count == lanes;
      if (!whole)
        for (Index lane = 0; lane < lanes; ++lane) std::copy_n(b + 3 * (k + std::min(lane, count - 1)), 3, rest + 3 * lane);
      four(surface, whole ? b + 3 * k : rest, whole && positions ? positions + 3 * k : there, whole ? normals + 3 * k : beside,
           last);
      if (whole) continue;
      if (positions) std::copy_n(there, 3 * count, positions + 3 * k);
      std::copy_n(beside, 3 * count, normals + 3 * k);
    }
  }

  TRIPATCH_FUSED_INLINE void four(const Surface& surface, const double* points, double* positions, double* normals,
                                  Pieces& last) const {
    Pack b[3];
    load_points(points, b);
    Pack position[3], tangent[2][3];
    const bool near = planes(b, last, position, tangent);
    Pack normal[3], squared = {};
    for (int x = 0; x < 3; ++x) {
      const int y = (x + 1) % 3, z = (x + 2) % 3;
      normal[x] = tangent[0][y] * tangent[1][z] - tangent[0][z] * tangent[1][y];
    }
    for (int x = 0; x < 3; ++x) squared += normal[x] * normal[x];
    Pack over = 1.0 / square_root(squared);
    if (any_at_least(over * over, unit_overflow) || any_at_least(squared, unit_overflow)) {
      for (int lane = 0; lane < lanes; ++lane) {
        const Vec3 unit = unit_vector({normal[0][lane], normal[1][lane], normal[2][lane]});
        for (int x = 0; x < 3; ++x) normal[x][lane] = unit[x];
      }
    } else {
      for (int x = 0; x < 3; ++x) normal[x] *= over;
    }
    store_points(position, positions);
    store_points(normal, normals);
    if (near) correct_near(surface, points, positions, normals);
  }

  static void correct_near(const Surface& surface, const double* points, double* positions, double* normals) {
    for (int lane = 0; lane < lanes; ++lane) {
      if (vertex_of(points + 3 * lane, VertexSafeSurface::vertex_radius[1]) < 0) continue;
      std::array<double, 9> jet;
      surface.evaluate(points + 3 * lane, 1, 1, jet.data());
      std::copy_n(jet.data(), 3, positions + 3 * lane);
      Eigen::Map<Vec3>(normals + 3 * lane) = unit_vector(Vec3::Map(&jet[3]).cross(Vec3::Map(&jet[6])));
    }
  }

  /// Positions and derivatives by b0 and b1; whether one is near to a vertex.
  TRIPATCH_FUSED_INLINE bool planes(const Pack (&b)[3], Pieces& last, Pack (&position)[3], Pack (&tangent)[2][3]) const {
    Rational plain, bent;
    bool near = false;
    OnRay on[3];
    for (int i = 0; i < 3; ++i) {
      on[i].over = 1.0 / (b[(i + 1) % 3] + b[(i + 2) % 3]);
      near |= any_at_least(on[i].over, 1 / VertexSafeSurface::vertex_radius[1]);
      on[i].t = b[(i + 2) % 3] * on[i].over;
      rays_[i].side.locate(on[i].t, last[i], on[i].place);
    }
    add_ray<0>(rays_[0], b, on[0], plain);
    add_ray<1>(rays_[1], b, on[1], plain);
    add_ray<2>(rays_[2], b, on[2], plain);
    if constexpr (Faired) {
      add_second_cross<0>(rays_[0], b, on[0], bent);
      add_second_cross<1>(rays_[1], b, on[1], bent);
      add_second_cross<2>(rays_[2], b, on[2], bent);
    }
    const Pack square[3] = {b[0] * b[0], b[1] * b[1], b[2] * b[2]};
    {
      const Pack over = 1.0 / (square[1] * square[2] + square[0] * (square[1] + square[2]));
      Pack slope[3];
      for (int i = 0; i < 3; ++i) slope[i] = 2.0 * b[i] * (square[(i + 1) % 3] + square[(i + 2) % 3]);
      for (int x = 0; x < 3; ++x) {
        position[x] = 0.5 * over * plain.value[x];
        for (int d = 0; d < 2; ++d)
          tangent[d][x] = over * (plain.slope[d][x] - plain.slope[2][x] - position[x] * (slope[d] - slope[2]));
      }
    }
    if constexpr (Faired) {
      Pack cube[3], slope[3], sum[3][3];
      for (int i = 0; i < 3; ++i) cube[i] = square[i] * b[i];
      const Pack over = 1.0 / (cube[1] * cube[2] + cube[0] * (cube[1] + cube[2]));
      for (int i = 0; i < 3; ++i) slope[i] = 3.0 * square[i] * (cube[(i + 1) % 3] + cube[(i + 2) % 3]);
      interior(b[0] - 1.0 / 3, b[1] - 1.0 / 3, sum);
      const Pack g = 27 * (b[0] * b[1] * b[2]), bubble = g * g;
      const Pack of_bubble[2] = {54 * g * (b[1] * (b[2] - b[0])), 54 * g * (b[0] * (b[2] - b[1]))};
      for (int x = 0; x < 3; ++x) {
        const Pack across = over * (1.0 / 3) * bent.value[x];
        for (int d = 0; d < 2; ++d)
          tangent[d][x] += over * (bent.slope[d][x] - bent.slope[2][x] - across * (slope[d] - slope[2])) +
                           (bubble * sum[1 + d][x] + of_bubble[d] * sum[0][x]);
        position[x] += across + bubble * sum[0][x];
      }
    }
    for (int x = 0; x < 3; ++x) position[x] += origin_[x];
    return near;
  }

  /// Adds twice a ray's position, times its side's weight (b_j b_k)^2, and derivatives of the product.
  template <int I>
  TRIPATCH_FUSED_INLINE static void add_ray(const Ray& ray, const Pack (&b)[3], const OnRay& on, Rational& sum) {
    constexpr int i = I, j = (i + 1) % 3, k = (i + 2) % 3;
    const Pack &r = b[i], &t = on.t, &over = on.over, s = b[j] + b[k], v = b[j] * b[k], vv = v * v;
    RayWeights<Pack> w;
    weigh_ray<Quintic>(r, s, w);
    const Pack added = -(s * s) * r, w_added = s * (1.0 - 3.0 * r);  // of the cubic ray
    const Pack twice = v + v, along = vv * (over * over);
    const auto each = [&](int x, const Pack& c, const Pack& c_t, const Pack& d, const Pack& d_t, const Pack& e, const Pack& e_t)
                          TRIPATCH_FUSED_LAMBDA {
                            const Pack turned = ray.turned[x].pack(), slope = ray.to_next[x].pack() + t * turned;
                            Pack f = ray.corner[x].pack() + w.h1 * slope + w.h3 * c + w.h4 * d,
                                 by_t = w.h1 * turned + w.h3 * c_t + w.h4 * d_t, by_s = w.d1 * slope + w.d3 * c + w.d4 * d;
                            if constexpr (Quintic) {
                              Pack at_vertex[2], at_side[2];
                              component<3>(ray.vertex_second.data(), x, t, at_vertex);
                              component<3>(ray.side_second.data(), x, t, at_side);
                              f += w.h2 * at_vertex[0] + w.h5 * at_side[0] + added * e;
                              by_t += w.h2 * at_vertex[1] + w.h5 * at_side[1] + added * e_t;
                              by_s += w.d2 * at_vertex[0] + w.d5 * at_side[0] + w_added * e;
                            }
                            add<I>(x, b, v, twice * f, along * by_t, -vv * by_s, sum);
                          };
    ray.side.for_components(on.place, each);
  }

  /// Adds three times what bends a side, times its cubic weight, and derivatives of the product.
  template <int I>
  TRIPATCH_FUSED_INLINE static void add_second_cross(const Ray& ray, const Pack (&b)[3], const OnRay& on, Rational& sum) {
    constexpr int i = I, j = (i + 1) % 3, k = (i + 2) % 3;
    const Pack &over = on.over, v = b[j] * b[k], rv = b[i] * v, half = 0.5 * rv * rv;
    const Pack u = on.t - 0.5, thrice = 3.0 * half, along = half * v * (over * over), across = rv * v * v;
    for (int x = 0; x < 3; ++x) {
      Pack q[2];
      component<3>(ray.second_cross.data(), x, u, q);
      add<I>(x, b, v, thrice * q[0], along * q[1], across * q[0], sum);
    }
  }

  /// Adds v f, with derivatives b_k (f - by_t) and b_j (f + by_t) by the coordinates that v = b_j b_k is the product of.
  template <int I>
  TRIPATCH_FUSED_INLINE static void add(int x, const Pack (&b)[3], const Pack& v, const Pack& f, const Pack& by_t,
                                        const Pack& by_r, Rational& sum) {
    constexpr int i = I, j = (i + 1) % 3, k = (i + 2) % 3;
    const Pack value = v * f, by_j = b[k] * (f - by_t), by_k = b[j] * (f + by_t);
    if constexpr (I == 0) {
      sum.value[x] = value, sum.slope[i][x] = by_r, sum.slope[j][x] = by_j, sum.slope[k][x] = by_k;
    } else {
      sum.value[x] += value, sum.slope[i][x] += by_r, sum.slope[j][x] += by_j, sum.slope[k][x] += by_k;
    }
  }

  /// The polynomial that the squared bubble multiplies, and its derivatives.
  TRIPATCH_FUSED_INLINE void interior(const Pack& u, const Pack& v, Pack (&sum)[3][3]) const {
    for (int k = 0; k < 3; ++k)
      for (int x = 0; x < 3; ++x) sum[k][x] = Pack{};
    const Spread* a = inside_.data();
    for (int i = 0; i <= degree_; ++i) {
      Pack row[2][3] = {};  // the polynomial of v that multiplies a power of u
      for (int j = 0; j <= i; ++j, ++a)
        for (int x = 0; x < 3; ++x) {
          row[1][x] = row[1][x] * v + row[0][x];
          row[0][x] = row[0][x] * v + (*a)[x].pack();
        }
      for (int x = 0; x < 3; ++x) {
        sum[1][x] = sum[1][x] * u + sum[0][x];
        sum[0][x] = sum[0][x] * u + row[0][x];
        sum[2][x] = sum[2][x] * u + row[1][x];
      }
    }
  }

  std::array<Ray, 3> rays_;
  Vec3 origin_;  ///< from which positions are measured
  std::vector<Spread> inside_;
  int degree_;
};

const PointFormula::Kernel* PointFormula::kernel() const {
  std::call_once(once_, [&] {
    PointTerms terms = terms_();
    int curve = 0, slope = 0, added = 0;
    bool plain = terms.inside.rows() == 0, quintic = false;
    for (int i = 0; i < 3; ++i) {
      PointTerms::Ray& ray = terms.rays[i];
      if (!ray.is_quintic) ray.slope = sum_of(ray.slope, ray.added), ray.added = {};
      for (PiecewisePolynomial* field : {&ray.curve, &ray.slope, &ray.added}) *field = economized(*field);
      curve = std::max(curve, ray.curve.degree()), slope = std::max(slope, ray.slope.degree());
      added = std::max(added, ray.added.degree());
      plain &= terms.second_cross[i].empty();
      quintic |= ray.is_quintic;
      if (terms.second_cross[i].pieces() > 1 || terms.second_cross[i].degree() > 3) return;
    }
    // by edges of meshes curves are of degree 5, and slopes one more; a fairing adds 4 or 5, of which many short pieces feel two
    const auto make = [&]<bool Faired, bool Quintic, int Slope, int Added>(
                          std::bool_constant<Faired>, std::bool_constant<Quintic>, std::integral_constant<int, Slope>,
                          std::integral_constant<int, Added>) {
      if (!kernel_ && (Faired || plain) && Quintic == quintic && curve <= 5 && slope <= Slope && added <= std::max(Added, 0))
        kernel_ = std::make_unique<const Kernel::With<Faired, Quintic, 5, Slope, Added>>(terms);
    };
    make(std::false_type(), std::false_type(), std::integral_constant<int, 6>(), std::integral_constant<int, -1>());
    make(std::true_type(), std::false_type(), std::integral_constant<int, 8>(), std::integral_constant<int, -1>());
    make(std::true_type(), std::false_type(), std::integral_constant<int, 10>(), std::integral_constant<int, -1>());
    make(std::true_type(), std::true_type(), std::integral_constant<int, 6>(), std::integral_constant<int, 8>());
    make(std::true_type(), std::true_type(), std::integral_constant<int, 6>(), std::integral_constant<int, 10>());
  });
  return kernel_.get();
}

bool PointFormula::is_worth(Index points) const {
  constexpr Index many = count::quadratic;  // what a formula for sides of a hundred pieces takes to be made, it saves then
  return points >= many && has_packs() && kernel();
}

void PointFormula::evaluate(const Surface& surface, const double* b, Index n, double* positions, double* normals) const {
  kernel_->evaluate(surface, b, n, positions, normals);
}

#else

class PointFormula::Kernel {};
bool PointFormula::is_worth(Index) const { return false; }
void PointFormula::evaluate(const Surface&, const double*, Index, double*, double*) const {}

#endif

PointFormula::~PointFormula() = default;

}  // namespace tripatch
