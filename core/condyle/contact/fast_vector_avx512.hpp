// SPDX-License-Identifier: Apache-2.0
// The kernels' vectors in AVX-512 registers: see fast_vector.hpp.
#pragma once

#include <immintrin.h>

namespace condyle::contact::fast {
namespace {

constexpr int kGroup = 8;

struct vd {
  __m512d v;
};
CONDYLE_INLINE vd splat(double a) { return {_mm512_set1_pd(a)}; }
CONDYLE_INLINE vd load(const double* p) { return {_mm512_loadu_pd(p)}; }
CONDYLE_INLINE void store(double* p, vd a) { _mm512_storeu_pd(p, a.v); }
CONDYLE_INLINE vd operator+(vd a, vd b) { return {a.v + b.v}; }
CONDYLE_INLINE vd operator-(vd a, vd b) { return {a.v - b.v}; }
CONDYLE_INLINE vd operator*(vd a, vd b) { return {a.v * b.v}; }
CONDYLE_INLINE vd fma(vd a, vd b, vd c) { return {_mm512_fmadd_pd(a.v, b.v, c.v)}; }
CONDYLE_INLINE vd fms(vd a, vd b, vd c) { return {_mm512_fmsub_pd(a.v, b.v, c.v)}; }
CONDYLE_INLINE vd fnma(vd a, vd b, vd c) { return {_mm512_fnmadd_pd(a.v, b.v, c.v)}; }
CONDYLE_INLINE vd smaller(vd a, vd b) { return {_mm512_min_pd(a.v, b.v)}; }
CONDYLE_INLINE vd larger(vd a, vd b) { return {_mm512_max_pd(a.v, b.v)}; }
CONDYLE_INLINE int negative_lanes(vd a) {
  return _mm512_cmp_pd_mask(a.v, _mm512_setzero_pd(), _CMP_LT_OQ);
}
CONDYLE_INLINE int equal_lanes(vd a, vd b) { return _mm512_cmp_pd_mask(a.v, b.v, _CMP_EQ_OQ); }
/// Zero where the lane's bit is not set.
CONDYLE_INLINE vd chosen(int lanes, vd a) {
  return {_mm512_maskz_mov_pd(static_cast<__mmask8>(lanes), a.v)};
}
/// Towards zero. @pre within int32.
CONDYLE_INLINE vd truncated(vd a) { return {_mm512_cvtepi32_pd(_mm512_cvttpd_epi32(a.v))}; }
CONDYLE_INLINE void store_integers(std::int32_t* p, vd a) {
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(p), _mm512_cvttpd_epi32(a.v));
}
CONDYLE_INLINE void store_floats(float* p, vd a) { _mm256_storeu_ps(p, _mm512_cvtpd_ps(a.v)); }

struct vf {
  __m512 v;
};
CONDYLE_INLINE vf splat(float a) { return {_mm512_set1_ps(a)}; }
CONDYLE_INLINE vf load(const float* p) { return {_mm512_loadu_ps(p)}; }
CONDYLE_INLINE void store(float* p, vf a) { _mm512_storeu_ps(p, a.v); }
CONDYLE_INLINE vf operator+(vf a, vf b) { return {a.v + b.v}; }
CONDYLE_INLINE vf operator-(vf a, vf b) { return {a.v - b.v}; }
CONDYLE_INLINE vf operator*(vf a, vf b) { return {a.v * b.v}; }
CONDYLE_INLINE vf fma(vf a, vf b, vf c) { return {_mm512_fmadd_ps(a.v, b.v, c.v)}; }
CONDYLE_INLINE vf load_rows(const float* const p[4], std::int64_t offset) {
  const __m256 low = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(p[0] + offset)),
                                          _mm_loadu_ps(p[1] + offset), 1);
  const __m256 high = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(p[2] + offset)),
                                           _mm_loadu_ps(p[3] + offset), 1);
  return {_mm512_insertf32x8(_mm512_castps256_ps512(low), high, 1)};
}
CONDYLE_INLINE vf spread(const float* p) {
  return {_mm512_permutevar_ps(_mm512_broadcast_f32x4(_mm_loadu_ps(p)),
                               _mm512_setr_epi32(0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3))};
}
CONDYLE_INLINE void transpose(vf& a, vf& b, vf& c, vf& d) {
  const __m512 ab0 = _mm512_unpacklo_ps(a.v, b.v), ab1 = _mm512_unpackhi_ps(a.v, b.v);
  const __m512 cd0 = _mm512_unpacklo_ps(c.v, d.v), cd1 = _mm512_unpackhi_ps(c.v, d.v);
  a.v = _mm512_shuffle_ps(ab0, cd0, 0x44);
  b.v = _mm512_shuffle_ps(ab0, cd0, 0xee);
  c.v = _mm512_shuffle_ps(ab1, cd1, 0x44);
  d.v = _mm512_shuffle_ps(ab1, cd1, 0xee);
}
CONDYLE_INLINE vd low_doubles(vf a) { return {_mm512_cvtps_pd(_mm512_castps512_ps256(a.v))}; }
CONDYLE_INLINE vd high_doubles(vf a) {
  return {_mm512_cvtps_pd(_mm512_extractf32x8_ps(a.v, 1))};
}

}  // namespace
}  // namespace condyle::contact::fast
