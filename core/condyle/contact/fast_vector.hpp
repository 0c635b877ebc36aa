// SPDX-License-Identifier: Apache-2.0
// Four doubles side by side, for the fast contact's kernels: one AVX register where the compilation
// has AVX, else two halves. Included by kernel compilations only; everything is static (see
// fast_kernel_body.hpp).
#pragma once

#include <cstdint>
#include <cstring>
#if defined(__SSE2__)
#include <immintrin.h>
#endif

#define CONDYLE_INLINE static inline __attribute__((always_inline))
#define CONDYLE_INLINE_MEMBER inline __attribute__((always_inline))

namespace condyle::contact::fast {
namespace {

#if defined(__AVX2__)

struct v4 {
  __m256d v;
};
CONDYLE_INLINE v4 splat(double a) { return {_mm256_set1_pd(a)}; }
CONDYLE_INLINE v4 make(double a, double b, double c, double d) {
  return {_mm256_set_pd(d, c, b, a)};
}
CONDYLE_INLINE v4 load(const double* p) { return {_mm256_loadu_pd(p)}; }
CONDYLE_INLINE v4 load(const float* p) { return {_mm256_cvtps_pd(_mm_loadu_ps(p))}; }
CONDYLE_INLINE void store(double* p, v4 a) { _mm256_storeu_pd(p, a.v); }
CONDYLE_INLINE v4 operator+(v4 a, v4 b) { return {a.v + b.v}; }
CONDYLE_INLINE v4 operator-(v4 a, v4 b) { return {a.v - b.v}; }
CONDYLE_INLINE v4 operator*(v4 a, v4 b) { return {a.v * b.v}; }
/// a·b + c, a·b − c and c − a·b, fused.
CONDYLE_INLINE v4 fma(v4 a, v4 b, v4 c) { return {_mm256_fmadd_pd(a.v, b.v, c.v)}; }
CONDYLE_INLINE v4 fms(v4 a, v4 b, v4 c) { return {_mm256_fmsub_pd(a.v, b.v, c.v)}; }
CONDYLE_INLINE v4 fnma(v4 a, v4 b, v4 c) { return {_mm256_fnmadd_pd(a.v, b.v, c.v)}; }
CONDYLE_INLINE v4 smaller(v4 a, v4 b) { return {_mm256_min_pd(a.v, b.v)}; }
CONDYLE_INLINE v4 larger(v4 a, v4 b) { return {_mm256_max_pd(a.v, b.v)}; }
/// Bit l is set where a < 0 (a == b) in lane l.
CONDYLE_INLINE int negative_lanes(v4 a) {
  return _mm256_movemask_pd(_mm256_cmp_pd(a.v, _mm256_setzero_pd(), _CMP_LT_OQ));
}
CONDYLE_INLINE int equal_lanes(v4 a, v4 b) {
  return _mm256_movemask_pd(_mm256_cmp_pd(a.v, b.v, _CMP_EQ_OQ));
}
/// Towards zero. @pre within int32.
CONDYLE_INLINE v4 truncated(v4 a) { return {_mm256_cvtepi32_pd(_mm256_cvttpd_epi32(a.v))}; }
CONDYLE_INLINE void store_integers(std::int32_t* p, v4 a) {
  _mm_storeu_si128(reinterpret_cast<__m128i*>(p), _mm256_cvttpd_epi32(a.v));
}
CONDYLE_INLINE void transpose(v4& a, v4& b, v4& c, v4& d) {
  const __m256d ab0 = _mm256_unpacklo_pd(a.v, b.v), ab1 = _mm256_unpackhi_pd(a.v, b.v);
  const __m256d cd0 = _mm256_unpacklo_pd(c.v, d.v), cd1 = _mm256_unpackhi_pd(c.v, d.v);
  a.v = _mm256_permute2f128_pd(ab0, cd0, 0x20);
  b.v = _mm256_permute2f128_pd(ab1, cd1, 0x20);
  c.v = _mm256_permute2f128_pd(ab0, cd0, 0x31);
  d.v = _mm256_permute2f128_pd(ab1, cd1, 0x31);
}

#else

typedef double v2 __attribute__((vector_size(16)));
struct v4 {
  v2 a, b;
};
CONDYLE_INLINE v4 splat(double a) { return {v2{a, a}, v2{a, a}}; }
CONDYLE_INLINE v4 make(double a, double b, double c, double d) { return {v2{a, b}, v2{c, d}}; }
CONDYLE_INLINE v4 load(const double* p) {
  v4 r;
  std::memcpy(&r.a, p, sizeof r.a);
  std::memcpy(&r.b, p + 2, sizeof r.b);
  return r;
}
CONDYLE_INLINE v4 load(const float* p) {
#if defined(__SSE2__)
  const __m128 f = _mm_loadu_ps(p);
  return {(v2)_mm_cvtps_pd(f), (v2)_mm_cvtps_pd(_mm_movehl_ps(f, f))};
#else
  return {v2{p[0], p[1]}, v2{p[2], p[3]}};
#endif
}
CONDYLE_INLINE void store(double* p, v4 r) {
  std::memcpy(p, &r.a, sizeof r.a);
  std::memcpy(p + 2, &r.b, sizeof r.b);
}
CONDYLE_INLINE v4 operator+(v4 x, v4 y) { return {x.a + y.a, x.b + y.b}; }
CONDYLE_INLINE v4 operator-(v4 x, v4 y) { return {x.a - y.a, x.b - y.b}; }
CONDYLE_INLINE v4 operator*(v4 x, v4 y) { return {x.a * y.a, x.b * y.b}; }
CONDYLE_INLINE v4 fma(v4 x, v4 y, v4 z) { return x * y + z; }
CONDYLE_INLINE v4 fms(v4 x, v4 y, v4 z) { return x * y - z; }
CONDYLE_INLINE v4 fnma(v4 x, v4 y, v4 z) { return z - x * y; }
CONDYLE_INLINE v2 smaller(v2 x, v2 y) { return x < y ? x : y; }
CONDYLE_INLINE v2 larger(v2 x, v2 y) { return x > y ? x : y; }
CONDYLE_INLINE v4 smaller(v4 x, v4 y) { return {smaller(x.a, y.a), smaller(x.b, y.b)}; }
CONDYLE_INLINE v4 larger(v4 x, v4 y) { return {larger(x.a, y.a), larger(x.b, y.b)}; }
CONDYLE_INLINE int negative_lanes(v4 x) {
  return (x.a[0] < 0.0 ? 1 : 0) | (x.a[1] < 0.0 ? 2 : 0) | (x.b[0] < 0.0 ? 4 : 0) |
         (x.b[1] < 0.0 ? 8 : 0);
}
CONDYLE_INLINE int equal_lanes(v4 x, v4 y) {
  return (x.a[0] == y.a[0] ? 1 : 0) | (x.a[1] == y.a[1] ? 2 : 0) | (x.b[0] == y.b[0] ? 4 : 0) |
         (x.b[1] == y.b[1] ? 8 : 0);
}
CONDYLE_INLINE v2 truncated(v2 x) {
  return v2{static_cast<double>(static_cast<std::int32_t>(x[0])),
            static_cast<double>(static_cast<std::int32_t>(x[1]))};
}
CONDYLE_INLINE v4 truncated(v4 x) { return {truncated(x.a), truncated(x.b)}; }
CONDYLE_INLINE void store_integers(std::int32_t* p, v4 x) {
  p[0] = static_cast<std::int32_t>(x.a[0]);
  p[1] = static_cast<std::int32_t>(x.a[1]);
  p[2] = static_cast<std::int32_t>(x.b[0]);
  p[3] = static_cast<std::int32_t>(x.b[1]);
}
CONDYLE_INLINE void transpose(v4& a, v4& b, v4& c, v4& d) {
  const v4 A{v2{a.a[0], b.a[0]}, v2{c.a[0], d.a[0]}}, B{v2{a.a[1], b.a[1]}, v2{c.a[1], d.a[1]}};
  const v4 C{v2{a.b[0], b.b[0]}, v2{c.b[0], d.b[0]}}, D{v2{a.b[1], b.b[1]}, v2{c.b[1], d.b[1]}};
  a = A;
  b = B;
  c = C;
  d = D;
}

#endif

CONDYLE_INLINE double lane_sum(v4 a) {
  double l[4];
  store(l, a);
  return (l[0] + l[1]) + (l[2] + l[3]);
}
CONDYLE_INLINE double lane_maximum(v4 a) {
  double l[4];
  store(l, a);
  const double low = l[0] > l[1] ? l[0] : l[1], high = l[2] > l[3] ? l[2] : l[3];
  return low > high ? low : high;
}

}  // namespace
}  // namespace condyle::contact::fast
