// Four doubles in a register, by the vectors that GCC and clang have: on x86-64 with AVX2, which is asked for at run time, on other machines
// with what each of them has. Nothing is fused, so that the bits are those of one number after the other.
#pragma once

#if defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define TRIPATCH_THREAD_SANITIZER
#endif
#elif defined(__SANITIZE_THREAD__)
#define TRIPATCH_THREAD_SANITIZER
#endif

// The thread sanitizer is not there yet when static variables ask what the machine is.
#if (defined(__clang__) || (defined(__GNUC__) && __GNUC__ >= 12)) && !defined(TRIPATCH_THREAD_SANITIZER)
#define TRIPATCH_PACKS
#ifdef __x86_64__
#include <cpuid.h>
#define TRIPATCH_PACKED __attribute__((target("avx2")))
/// For what may multiply and add in one step. Instructions are named, not machines: zig turns off what machines have.
#define TRIPATCH_FUSED __attribute__((target("avx2,fma,bmi,bmi2")))
#ifndef __clang__
#define TRIPATCH_WIDE \
  __attribute__((target("avx2,fma,bmi,bmi2,avx512f,avx512bw,avx512cd,avx512dq,avx512vl,prefer-vector-width=512")))
#endif
#else
#define TRIPATCH_PACKED
#define TRIPATCH_FUSED
#endif
#define TRIPATCH_PACKED_INLINE TRIPATCH_PACKED __attribute__((always_inline)) inline
/// For formulas of packs and of single numbers: compiled as whatever they are inlined into. Packed functions
/// take no packs from them by value: clang refuses that.
#define TRIPATCH_ANY_PACK __attribute__((always_inline)) inline
#define TRIPATCH_ANY_PACK_LAMBDA __attribute__((always_inline))
#else
#define TRIPATCH_ANY_PACK inline
#define TRIPATCH_ANY_PACK_LAMBDA
#endif

namespace tripatch {

/// How many numbers a pack, or a number itself, holds.
template <class P>
constexpr int width_of = sizeof(P) / 8;

#ifdef TRIPATCH_PACKS
// What is inlined everywhere is handed to no function: how that would be done does not matter.
#pragma GCC diagnostic ignored "-Wpsabi"

constexpr int lanes = 4;
typedef double Pack __attribute__((vector_size(8 * lanes)));
/// Anywhere in memory.
typedef double LoosePack __attribute__((vector_size(8 * lanes), aligned(8), may_alias));

#ifdef __x86_64__
enum class Machine { any, fused, wide };

/// What the machine has, asked of itself: in what zig compiles, __builtin_cpu_supports says that it has nothing.
inline Machine machine() {
  static const Machine found = [] {
    unsigned a, b, c, d, saved;
    const bool knows =
        __get_cpuid(1, &a, &b, &c, &d) && (c & bit_OSXSAVE) && (c & bit_FMA) && __get_cpuid_count(7, 0, &a, &b, &c, &d);
    if (!knows) return Machine::any;
    __asm__("xgetbv" : "=a"(saved), "=d"(d) : "c"(0));  // which registers the system keeps
    const auto has = [&](unsigned kept, unsigned bits) { return (saved & kept) == kept && (b & bits) == bits; };
    if (!has(0x06, bit_AVX2 | bit_BMI | bit_BMI2)) return Machine::any;
    const bool wide = has(0xe6, bit_AVX512F | bit_AVX512BW | bit_AVX512CD | bit_AVX512DQ | bit_AVX512VL);
    return wide ? Machine::wide : Machine::fused;
  }();
  return found;
}
#endif

/// Whether the machine has registers for packs, and multiplies and adds in one step.
inline bool has_packs() {
#ifdef __x86_64__
  return machine() != Machine::any;
#else
  return true;
#endif
}

TRIPATCH_PACKED_INLINE Pack all_lanes(double s) { return Pack{s, s, s, s}; }
TRIPATCH_PACKED_INLINE Pack loaded(const double* from) { return *reinterpret_cast<const LoosePack*>(from); }
TRIPATCH_PACKED_INLINE void store(const Pack& pack, double* to) { *reinterpret_cast<LoosePack*>(to) = pack; }
TRIPATCH_PACKED_INLINE Pack square_root(const Pack& x) {
#if defined(__x86_64__) && !defined(__clang__)
  return __builtin_ia32_sqrtpd256(x);
#elif defined(__clang__) && __has_builtin(__builtin_elementwise_sqrt)
  return __builtin_elementwise_sqrt(x);
#else
  return Pack{__builtin_sqrt(x[0]), __builtin_sqrt(x[1]), __builtin_sqrt(x[2]), __builtin_sqrt(x[3])};
#endif
}
TRIPATCH_PACKED_INLINE Pack smaller(const Pack& a, const Pack& b) { return a < b ? a : b; }
/// Whether a lane of a is not below s.
TRIPATCH_PACKED_INLINE bool any_at_least(const Pack& a, double s) {
#ifdef __x86_64__
  return __builtin_ia32_movmskpd256(Pack(a >= s)) != 0;
#else
  return a[0] >= s || a[1] >= s || a[2] >= s || a[3] >= s;
#endif
}

#endif

/// A number in all lanes, or itself. Added to 0, for GCC 12 puts four times the same number in their places one by one.
template <class P>
TRIPATCH_ANY_PACK void spread(double s, P& out) {
  out = s + P{};
}
template <class P>
TRIPATCH_ANY_PACK double number(const P& of, [[maybe_unused]] int lane) {
  if constexpr (width_of<P> == 1)
    return of;
  else
    return of[lane];
}

}  // namespace tripatch
