// Four doubles in a register, or eight, where compiler and machine have them: chosen at run time. Nothing is fused, so that the bits are
// those of one number after the other.
#pragma once

#if defined(__x86_64__) && defined(__GLIBC__) && !defined(__clang__) && defined(__GNUC__) && !defined(__SANITIZE_THREAD__)
#if __GNUC__ >= 12
#define TRIPATCH_PACKS
#define TRIPATCH_PACKED __attribute__((target("avx2")))
#define TRIPATCH_PACKED_INLINE __attribute__((target("avx2"), always_inline)) inline
// The same for registers of eight, and for either: whatever the caller has.
#define TRIPATCH_WIDE __attribute__((target("arch=x86-64-v4,prefer-vector-width=512"), optimize("fp-contract=off")))
#define TRIPATCH_ANY_PACK __attribute__((always_inline)) inline
#define TRIPATCH_ANY_PACK_LAMBDA __attribute__((always_inline))
#endif
#endif

#ifdef TRIPATCH_PACKS
// What is inlined everywhere is handed to no function: how that would be done does not matter.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace tripatch {

constexpr int lanes = 4;
typedef double Pack __attribute__((vector_size(8 * lanes)));
typedef double WidePack __attribute__((vector_size(64)));
/// Numbers in one of either.
template <class P>
constexpr int width_of = sizeof(P) / sizeof(double);
/// Anywhere in memory.
typedef double LoosePack __attribute__((vector_size(8 * lanes), aligned(8), may_alias));

TRIPATCH_PACKED_INLINE Pack all_lanes(double s) { return Pack{s, s, s, s}; }
template <class P>
TRIPATCH_ANY_PACK P all_lanes_of(double s) {
  return s + P{};  // added to 0, for GCC 12 makes eight instructions of eight times the same number
}
TRIPATCH_ANY_PACK Pack loaded(const double* from) { return *reinterpret_cast<const LoosePack*>(from); }
TRIPATCH_PACKED_INLINE void store(const Pack& pack, double* to) { *reinterpret_cast<LoosePack*>(to) = pack; }

}  // namespace tripatch

#endif
