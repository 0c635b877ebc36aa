// SPDX-License-Identifier: Apache-2.0
// The vectors of the dense layers' kernels: kLanes doubles in a register. Included by kernel
// compilations only; everything is static, so that a function compiled for one instruction set
// never serves another.
//
// + − · ÷, comparisons and choices are the compiler's vector extension; what is said by hand is the
// fused product (contraction is off).
#pragma once

#include <cstdint>
#include <cstring>

#if defined(__AVX2__)
#include <immintrin.h>
#endif

#define CONDYLE_INLINE static inline __attribute__((always_inline))

namespace condyle::surrogate::dense {
namespace {

#if defined(__AVX512F__)
constexpr int kLanes = 8;
#elif defined(__AVX2__)
constexpr int kLanes = 4;
#else
constexpr int kLanes = 2;
#endif

typedef double Vector __attribute__((vector_size(8 * kLanes)));
typedef std::int64_t Integers __attribute__((vector_size(8 * kLanes)));

CONDYLE_INLINE Vector splat(double a) { return a - Vector{}; }
CONDYLE_INLINE Vector load(const double* p) {
  Vector a;
  std::memcpy(&a, p, sizeof a);
  return a;
}
CONDYLE_INLINE void store(double* p, Vector a) { std::memcpy(p, &a, sizeof a); }

/// a·b + c, rounded once where the instruction set can.
CONDYLE_INLINE Vector multiply_add(Vector a, Vector b, Vector c) {
#if defined(__AVX512F__)
  return _mm512_fmadd_pd(a, b, c);
#elif defined(__FMA__)
  return _mm256_fmadd_pd(a, b, c);
#else
  return a * b + c;
#endif
}

/// Within ±limit; what is not a number stays so: the minimum of two is the second where they do not
/// compare.
CONDYLE_INLINE Vector clamped(Vector a, double limit) {
#if defined(__AVX512F__)
  return _mm512_max_pd(splat(-limit), _mm512_min_pd(splat(limit), a));
#elif defined(__AVX2__)
  return _mm256_max_pd(splat(-limit), _mm256_min_pd(splat(limit), a));
#else
  a = a > splat(limit) ? splat(limit) : a;
  return a < splat(-limit) ? splat(-limit) : a;
#endif
}

CONDYLE_INLINE Integers bits(Vector a) { return (Integers)a; }
CONDYLE_INLINE Vector number(Integers a) { return (Vector)a; }

}  // namespace
}  // namespace condyle::surrogate::dense
