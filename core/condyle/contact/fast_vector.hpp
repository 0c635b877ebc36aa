// SPDX-License-Identifier: Apache-2.0
// The vectors of the fast contact's kernels: kGroup doubles (vd), and as many bytes of floats (vf) seen
// as kSide rows of four. Included by kernel compilations only; everything is static (see
// fast_kernel_body.hpp).
//
// Each instruction set gives the same operations:
//
//   splat, load, store, + − ·, smaller, larger      lane by lane
//   fma(a, b, c)                                     a·b + c: of floats fused everywhere, of doubles
//   fms, fnma                                        where the instruction set can; a·b − c, c − a·b
//   negative_lanes, equal_lanes, chosen              lanes as bits of an int
//   truncated, store_integers, store_floats          conversions of doubles
//   load_rows(p, offset)                             four floats from each of kSide addresses
//   spread(p)                                        p[i] over the four lanes of row i
//   transpose(a, b, c, d)                            of each row's 4×4 by itself
//   low_doubles, high_doubles                        halves of the floats, widened
//
// Contraction is off in these compilations: a·b + c rounds twice, and only fma() and its like may be
// fused.
#pragma once

#include <cstdint>
#include <cstring>

#define CONDYLE_INLINE static inline __attribute__((always_inline))
#define CONDYLE_INLINE_MEMBER inline __attribute__((always_inline))

#if defined(__AVX512F__)
#include "condyle/contact/fast_vector_avx512.hpp"
#elif defined(__AVX2__)
#include "condyle/contact/fast_vector_avx2.hpp"
#else
#include "condyle/contact/fast_vector_baseline.hpp"
#endif

namespace condyle::contact::fast {
namespace {

constexpr int kSide = kGroup / 2;        // points side by side in a vf
constexpr int kAllLanes = (1 << kGroup) - 1;

CONDYLE_INLINE double lane_sum(vd a) {
  double l[kGroup];
  store(l, a);
  for (int n = kGroup / 2; n > 0; n /= 2) {
    for (int i = 0; i < n; ++i) l[i] = l[2 * i] + l[2 * i + 1];
  }
  return l[0];
}
CONDYLE_INLINE double lane_maximum(vd a) {
  double l[kGroup];
  store(l, a);
  for (int i = 1; i < kGroup; ++i) l[0] = l[0] > l[i] ? l[0] : l[i];
  return l[0];
}

}  // namespace
}  // namespace condyle::contact::fast
