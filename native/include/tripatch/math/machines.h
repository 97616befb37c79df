// Four doubles in a register, where compiler and machine have them: chosen at run time. Nothing is fused, so that the bits are those of
// one number after the other.
#pragma once

#if defined(__x86_64__) && defined(__GLIBC__) && !defined(__clang__) && defined(__GNUC__) && !defined(__SANITIZE_THREAD__)
#if __GNUC__ >= 12
#define TRIPATCH_PACKS
#define TRIPATCH_PACKED __attribute__((target("avx2")))
#define TRIPATCH_PACKED_INLINE __attribute__((target("avx2"), always_inline)) inline
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
TRIPATCH_PACKED_INLINE void store(const Pack& pack, double* to) { *reinterpret_cast<LoosePack*>(to) = pack; }

}  // namespace tripatch

#endif
