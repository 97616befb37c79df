// Four doubles in a register, where compiler and machine have them: chosen at run time. Nothing is fused, so that the bits are those of
// one number after the other.
#pragma once

#if defined(__x86_64__) && defined(__GLIBC__) && !defined(__clang__) && defined(__GNUC__) && !defined(__SANITIZE_THREAD__)
#if __GNUC__ >= 12
#define TRIPATCH_PACKS
#define TRIPATCH_PACKED __attribute__((target("avx2")))
#define TRIPATCH_PACKED_INLINE __attribute__((target("avx2"), always_inline)) inline
#define TRIPATCH_PACKED_LAMBDA __attribute__((target("avx2"), always_inline))
#endif
#endif

#ifdef TRIPATCH_PACKS

namespace tripatch {

constexpr int lanes = 4;
typedef double Pack __attribute__((vector_size(8 * lanes)));
/// Anywhere in memory.
typedef double LoosePack __attribute__((vector_size(8 * lanes), aligned(8), may_alias));

TRIPATCH_PACKED_INLINE Pack all_lanes(double s) { return Pack{s, s, s, s}; }
TRIPATCH_PACKED_INLINE Pack loaded(const double* from) { return *reinterpret_cast<const LoosePack*>(from); }
/// Two numbers from each of two places.
TRIPATCH_PACKED_INLINE Pack loaded_pairs(const double* low, const double* high) {
  typedef double Pair __attribute__((vector_size(16), aligned(8), may_alias));
  return __builtin_shufflevector(*reinterpret_cast<const Pair*>(low), *reinterpret_cast<const Pair*>(high), 0, 1, 2, 3);
}
TRIPATCH_PACKED_INLINE void store(const Pack& pack, double* to) { *reinterpret_cast<LoosePack*>(to) = pack; }

}  // namespace tripatch

#endif
