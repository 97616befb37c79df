// Curve and slopes of a side at four parameters at a time, by instructions that multiply and add in one step: points have the same
// bits among whatever others, but not those that their jets have.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "tripatch/math/tolerances.h"
#include "tripatch/patch/simd.h"

#ifdef TRIPATCH_PACKS
#define TRIPATCH_FUSED_LAMBDA TRIPATCH_FUSED __attribute__((always_inline))
#define TRIPATCH_FUSED_INLINE TRIPATCH_FUSED __attribute__((always_inline)) inline

namespace tripatch {

/// The components of a coefficient, or one of them four times.
struct alignas(32) Four {
  double of[4];

  TRIPATCH_FUSED_INLINE Pack pack() const { return *reinterpret_cast<const LoosePack*>(of); }
};
inline std::array<Four, 3> spread_out(const double* a) {
  std::array<Four, 3> out;
  for (int x = 0; x < 3; ++x) std::fill_n(out[x].of, 4, a[x]);
  return out;
}
using Spread = std::array<Four, 3>;

/// A component of a polynomial and of its derivative.
template <int Degree>
TRIPATCH_FUSED_INLINE void component(const Spread* a, int x, const Pack& u, Pack (&out)[2]) {
  out[1] = a[Degree][x].pack();
  out[0] = out[1] * u + a[Degree - 1][x].pack();
  for (int k = Degree - 2; k >= 0; --k) {
    out[1] = out[1] * u + out[0];
    out[0] = out[0] * u + a[k][x].pack();
  }
}

/// Curve and slope of a side, and what is added to its slope (degree -1: nothing). The pieces of four parameters are looked up at
/// once, and where they are one its coefficients are read once.
template <int Curve, int Slope, int Added = -1>
class SideFields {
public:
  SideFields(const PiecewisePolynomial& curve, const PiecewisePolynomial& slope, const PiecewisePolynomial& added) {
    const std::vector<double> breaks = curve.refined(slope.breaks(), 0).refined(added.breaks(), 0).breaks();
    const PiecewisePolynomial c = curve.refined(breaks, Curve), d = slope.refined(breaks, Slope),
                              e = added.refined(breaks, std::max(Added, 0));
    std::vector<const PiecewisePolynomial*> fields = {&c, &d};
    if (Added >= 0) fields.push_back(&e);
    const Index n = c.pieces(), places = n == 1 ? 1 : 4 * n;
    for (Index p = 0; p < n; ++p) {
      for (const PiecewisePolynomial* field : fields)
        for (int k = 0; k <= field->degree(); ++k) {
          const double* const a = &field->coefficients()[3 * (p * (field->degree() + 1) + k)];
          coefficients_.push_back({a[0], a[1], a[2], 0});
          spread_.push_back(spread_out(a));
        }
      constexpr double infinity = std::numeric_limits<double>::infinity();
      pieces_.push_back({p > 0 ? breaks[p] : -infinity, p + 1 < n ? breaks[p + 1] : infinity, 0.5 * (breaks[p] + breaks[p + 1])});
    }
    for (Index k = 0, p = 0; k < places; ++k) {
      while (pieces_[p].end <= (1 - tolerance::fit) * static_cast<double>(k) / static_cast<double>(places)) ++p;
      lookup_.push_back(static_cast<std::int32_t>(p));
    }
  }

  /// Where four parameters are among the pieces.
  struct Place {
    Pack u;                 ///< from the middles of pieces
    const Spread* all;      ///< coefficients, where the piece is one
    const Four* of[lanes];  ///< of each
  };
  /// last: the piece of the parameters before, which may be that of these.
  TRIPATCH_FUSED_INLINE void locate(const Pack& t, Index& last, Place& place) const {
    const Piece& piece = pieces_[last];
    place.u = t - piece.middle;
    place.all = &spread_[size * last];
    if (!any_at_least(Pack(((t >= piece.start) & (t < piece.end)) ? 0.0 + Pack{} : 1.0 + Pack{}), 1)) return;
    const double places = static_cast<double>(lookup_.size());
    Pack scaled = t * places;
    scaled = scaled > 0.0 ? scaled : Pack{};  // where it is no number too
    scaled = scaled < places - 1 ? scaled : places - 1 + Pack{};
    Index p[lanes];
    for (int lane = 0; lane < lanes; ++lane) {
      p[lane] = lookup_[static_cast<std::int32_t>(scaled[lane])];
      p[lane] += static_cast<Index>(t[lane] >= pieces_[p[lane]].end);  // one break is passed or not, another rarely is
      while (t[lane] >= pieces_[p[lane]].end) ++p[lane];
      place.of[lane] = &coefficients_[size * p[lane]];
    }
    place.u = t - Pack{pieces_[p[0]].middle, pieces_[p[1]].middle, pieces_[p[2]].middle, pieces_[p[3]].middle};
    last = p[0];
    place.all = p[0] == p[1] && p[0] == p[2] && p[0] == p[3] ? &spread_[size * p[0]] : nullptr;
  }
  /// f(x, curve, slope, added) for each component: values and derivatives.
  template <class F>
  TRIPATCH_FUSED_INLINE void for_components(const Place& place, const F& f) const {
    if (place.all) {
      for (int x = 0; x < 3; ++x) {
        Pack c[2], d[2], e[2] = {};
        component<Curve>(place.all, x, place.u, c);
        component<Slope>(place.all + Curve + 1, x, place.u, d);
        if constexpr (Added >= 0) component<Added>(place.all + Curve + Slope + 2, x, place.u, e);
        f(x, c[0], c[1], d[0], d[1], e[0], e[1]);
      }
      return;
    }
    Pack u[lanes], c[2][3], d[2][3], e[2][3] = {};
    for (int lane = 0; lane < lanes; ++lane) u[lane] = place.u[lane] + Pack{};
    const Four* a[lanes] = {place.of[0], place.of[1], place.of[2], place.of[3]};
    several<Curve>(a, u, c);
    for (int lane = 0; lane < lanes; ++lane) a[lane] += Curve + 1;
    several<Slope>(a, u, d);
    if constexpr (Added >= 0) {
      for (int lane = 0; lane < lanes; ++lane) a[lane] += Slope + 1;
      several<Added>(a, u, e);
    }
    for (int x = 0; x < 3; ++x) f(x, c[0][x], c[1][x], d[0][x], d[1][x], e[0][x], e[1][x]);
  }

private:
  struct Piece {
    double start, end, middle;
  };

  template <int Degree>
  TRIPATCH_FUSED_INLINE static void several(const Four* const (&a)[lanes], const Pack (&u)[lanes], Pack (&out)[2][3]) {
    Pack sum[2][lanes];  // the components of a point in a register
    for (int lane = 0; lane < lanes; ++lane) {
      sum[1][lane] = a[lane][Degree].pack();
      sum[0][lane] = sum[1][lane] * u[lane] + a[lane][Degree - 1].pack();
    }
    for (int k = Degree - 2; k >= 0; --k)
      for (int lane = 0; lane < lanes; ++lane) {
        sum[1][lane] = sum[1][lane] * u[lane] + sum[0][lane];
        sum[0][lane] = sum[0][lane] * u[lane] + a[lane][k].pack();
      }
    for (int order = 0; order < 2; ++order) PackedField::turn(sum[order], out[order]);
  }

  static constexpr int size = Curve + Slope + Added + 3;
  std::vector<Four> coefficients_;  // of each piece those of the curve, the lowest power first, then of the slope
  std::vector<Spread> spread_;      // the same
  std::vector<Piece> pieces_;
  std::vector<std::int32_t> lookup_;  // first candidate piece for floor(t * lookup size)
};

}  // namespace tripatch
#endif
