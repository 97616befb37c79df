// What the corner of a quad costs, for the vertices of quads to be moved: values to second order, of one corner or of four at a time.
#pragma once

#include <array>
#include <cmath>

#include "tripatch/math/simd.h"
#include "tripatch/math/thresholds.h"

namespace tripatch::corner_costs {

// Other numbers were tried on quads between four, five and six sides of a wavy saddle. Reported is by how much of the diameter a vertex of
// one of them moves at most.
/// Distortions count with this power: high enough for the worst corner to lead, low enough for Newton's steps to converge (5e-4 with 2).
constexpr int distortion_power = 3;
/// In the end the least angle leads: (1 / sin)^2 counts with this power (of two), and next to it how even the spacing is.
constexpr int sharp_power = 8;
constexpr double spacing = share::quarter;  ///< weight of the evenness, a choice

/// A function of two variables to second order about a place: its value, by u, by v, and the halves of uu, all of uv and of vv; T: a double,
/// or a Pack for four corners at a time. As Jet<2> to the last bit, but inlined, and what does not change is a number: Newton's steps are
/// nearly all of the time that quads take.
template <class T>
struct SecondOf {
  T value = {}, u = {}, v = {}, uu = {}, uv = {}, vv = {};

  TRIPATCH_ANY_PACK friend SecondOf operator+(const SecondOf& a, const SecondOf& b) {
    return {a.value + b.value, a.u + b.u, a.v + b.v, a.uu + b.uu, a.uv + b.uv, a.vv + b.vv};
  }
  TRIPATCH_ANY_PACK friend SecondOf operator-(const SecondOf& a, const SecondOf& b) {
    return {a.value - b.value, a.u - b.u, a.v - b.v, a.uu - b.uu, a.uv - b.uv, a.vv - b.vv};
  }
  TRIPATCH_ANY_PACK friend SecondOf operator+(const SecondOf& a, const T& b) { return {a.value + b, a.u, a.v, a.uu, a.uv, a.vv}; }
  TRIPATCH_ANY_PACK friend SecondOf operator+(const T& b, const SecondOf& a) { return a + b; }
  TRIPATCH_ANY_PACK friend SecondOf operator*(const T& s, const SecondOf& a) {
    return {s * a.value, s * a.u, s * a.v, s * a.uu, s * a.uv, s * a.vv};
  }
  TRIPATCH_ANY_PACK friend SecondOf operator*(const SecondOf& a, const T& s) { return s * a; }
  TRIPATCH_ANY_PACK friend SecondOf operator*(const SecondOf& a, const SecondOf& b) {
    return {a.value * b.value,
            a.value * b.u + a.u * b.value,
            a.value * b.v + a.v * b.value,
            a.value * b.uu + a.u * b.u + a.uu * b.value,
            a.value * b.uv + a.u * b.v + a.v * b.u + a.uv * b.value,
            a.value * b.vv + a.v * b.v + a.vv * b.value};
  }
};
using Second = SecondOf<double>;

/// f(a) by f, f' and f''/2 at a's value.
template <class T>
TRIPATCH_ANY_PACK SecondOf<T> composed(const T& f, const T& slope, const T& bend, const SecondOf<T>& a) {
  const T u = bend * a.u, v = bend * a.v;
  return {f, slope * a.u, slope * a.v, slope * a.uu + u * a.u, slope * a.uv + u * a.v + v * a.u, slope * a.vv + v * a.v};
}
template <class T>
TRIPATCH_ANY_PACK SecondOf<T> one_over(const SecondOf<T>& a) {
  const T f = 1 / a.value, slope = -f * f;
  return composed<T>(f, slope, -slope * f, a);
}
inline Second root_of(const Second& a) {
  const double f = std::sqrt(a.value), slope = f * 0.5 / a.value;
  return composed(f, slope, slope * -0.5 / (2 * a.value), a);
}
inline double root_of(double x) { return std::sqrt(x); }
TRIPATCH_ANY_PACK Second ratio(const Second& a, const Second& b) { return a * one_over(b); }
inline Second ratio(const Second& a, double b) { return a * (1 / b); }
inline Second ratio(double a, const Second& b) { return a * one_over(b); }
inline double ratio(double a, double b) { return a / b; }

#ifdef TRIPATCH_PACKS
/// The same of four corners at a time, in the same order of operations and with nothing fused: to the last bit.
namespace packed {

using corner_costs::one_over;
using Second = SecondOf<Pack>;

TRIPATCH_PACKED_INLINE Pack one_over(const Pack& x) { return 1 / x; }
TRIPATCH_PACKED_INLINE Pack ratio(const Pack& a, const Pack& b) { return a / b; }
template <class A, class B>
TRIPATCH_PACKED_INLINE auto ratio(const A& a, const B& b) {
  return a * one_over(b);
}

template <class T>
struct Arm {
  T to[3];
  T square;
};
template <class T>
TRIPATCH_PACKED_INLINE Arm<T> arm_of(const T (&to)[3]) {
  return {{to[0], to[1], to[2]}, to[0] * to[0] + to[1] * to[1] + to[2] * to[2]};
}
/// Each lane of its own scale.
TRIPATCH_PACKED_INLINE Arm<Pack> arm_between(const Pack& scale, const Pack (&from)[3], const Pack (&to)[3]) {
  const Pack way[3] = {scale * (to[0] - from[0]), scale * (to[1] - from[1]), scale * (to[2] - from[2])};
  return arm_of(way);
}
/// From where a vertex moves.
TRIPATCH_PACKED_INLINE Second way_from(const Pack& scale, const Second& moving, const Pack& to) {
  return scale * Second{to - moving.value, -moving.u, -moving.v, -moving.uu, -moving.uv, -moving.vv};
}
TRIPATCH_PACKED_INLINE Arm<Second> arm_from(const Pack& scale, const Second (&moving)[3], const Pack (&to)[3]) {
  const Second way[3] = {way_from(scale, moving[0], to[0]), way_from(scale, moving[1], to[1]), way_from(scale, moving[2], to[2])};
  return arm_of(way);
}
TRIPATCH_PACKED_INLINE Arm<Second> backwards(const Arm<Second>& arm) {
  const Pack minus = all_lanes(-1);
  return {{minus * arm.to[0], minus * arm.to[1], minus * arm.to[2]}, arm.square};
}

/// As Smoother's, between edges of quads none of which is turned over.
template <class A, class B>
TRIPATCH_PACKED_INLINE auto distortion(const Pack (&n)[3], const Arm<A>& next, const Arm<B>& last, bool in_space, bool sharp) {
  const auto& a = next.to;
  const auto& b = last.to;
  auto area = a[0] * b[1] - a[1] * b[0];
  if (in_space) area = n[0] * (a[1] * b[2] - a[2] * b[1]) + n[1] * (a[2] * b[0] - a[0] * b[2]) + n[2] * area;
  if (sharp) {
    auto power = ratio(next.square * last.square, area * area);
    for (int k = 1; k < sharp_power; k *= 2) power = power * power;
    const auto shape = ratio(next.square, last.square);
    return power + all_lanes(spacing) * (shape + one_over(shape));
  }
  const auto once = all_lanes(0.5) * ratio(next.square + last.square, area);
  auto power = once;
  for (int k = 1; k < distortion_power; ++k) power = power * once;
  return power;
}

}  // namespace packed
#endif

template <class T>
using Vector = std::array<T, 3>;
template <class A, class B>
auto dot(const Vector<A>& a, const Vector<B>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

}  // namespace tripatch::corner_costs
