// SPDX-License-Identifier: Apache-2.0
// The kernels' vectors in AVX2 registers: see fast_vector.hpp.
#pragma once

#include <immintrin.h>

namespace condyle::contact::fast {
namespace {

constexpr int kGroup = 4;

struct vd {
  __m256d v;
};
CONDYLE_INLINE vd splat(double a) { return {_mm256_set1_pd(a)}; }
CONDYLE_INLINE vd load(const double* p) { return {_mm256_loadu_pd(p)}; }
CONDYLE_INLINE void store(double* p, vd a) { _mm256_storeu_pd(p, a.v); }
CONDYLE_INLINE vd operator+(vd a, vd b) { return {a.v + b.v}; }
CONDYLE_INLINE vd operator-(vd a, vd b) { return {a.v - b.v}; }
CONDYLE_INLINE vd operator*(vd a, vd b) { return {a.v * b.v}; }
CONDYLE_INLINE vd fma(vd a, vd b, vd c) { return {_mm256_fmadd_pd(a.v, b.v, c.v)}; }
CONDYLE_INLINE vd fms(vd a, vd b, vd c) { return {_mm256_fmsub_pd(a.v, b.v, c.v)}; }
CONDYLE_INLINE vd fnma(vd a, vd b, vd c) { return {_mm256_fnmadd_pd(a.v, b.v, c.v)}; }
CONDYLE_INLINE vd smaller(vd a, vd b) { return {_mm256_min_pd(a.v, b.v)}; }
CONDYLE_INLINE vd larger(vd a, vd b) { return {_mm256_max_pd(a.v, b.v)}; }
CONDYLE_INLINE int negative_lanes(vd a) {
  return _mm256_movemask_pd(_mm256_cmp_pd(a.v, _mm256_setzero_pd(), _CMP_LT_OQ));
}
CONDYLE_INLINE int equal_lanes(vd a, vd b) {
  return _mm256_movemask_pd(_mm256_cmp_pd(a.v, b.v, _CMP_EQ_OQ));
}
/// Zero where the lane's bit is not set.
CONDYLE_INLINE vd chosen(int lanes, vd a) {
  const __m256i bit = _mm256_setr_epi64x(1, 2, 4, 8);
  const __m256i set = _mm256_and_si256(_mm256_set1_epi64x(lanes), bit);
  return {_mm256_and_pd(a.v, _mm256_castsi256_pd(_mm256_cmpeq_epi64(set, bit)))};
}
/// Towards zero. @pre within int32.
CONDYLE_INLINE vd truncated(vd a) { return {_mm256_cvtepi32_pd(_mm256_cvttpd_epi32(a.v))}; }
CONDYLE_INLINE void store_integers(std::int32_t* p, vd a) {
  _mm_storeu_si128(reinterpret_cast<__m128i*>(p), _mm256_cvttpd_epi32(a.v));
}
CONDYLE_INLINE void store_floats(float* p, vd a) { _mm_storeu_ps(p, _mm256_cvtpd_ps(a.v)); }

struct vf {
  __m256 v;
};
CONDYLE_INLINE vf splat(float a) { return {_mm256_set1_ps(a)}; }
CONDYLE_INLINE vf load(const float* p) { return {_mm256_loadu_ps(p)}; }
CONDYLE_INLINE void store(float* p, vf a) { _mm256_storeu_ps(p, a.v); }
CONDYLE_INLINE vf operator+(vf a, vf b) { return {a.v + b.v}; }
CONDYLE_INLINE vf operator-(vf a, vf b) { return {a.v - b.v}; }
CONDYLE_INLINE vf operator*(vf a, vf b) { return {a.v * b.v}; }
CONDYLE_INLINE vf fma(vf a, vf b, vf c) { return {_mm256_fmadd_ps(a.v, b.v, c.v)}; }
CONDYLE_INLINE vf load_rows(const float* const p[2], std::int64_t offset) {
  return {_mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(p[0] + offset)),
                               _mm_loadu_ps(p[1] + offset), 1)};
}
CONDYLE_INLINE vf spread(const float* p) {
  double both;
  std::memcpy(&both, p, sizeof both);
  return {_mm256_permutevar_ps(_mm256_castpd_ps(_mm256_set1_pd(both)),
                               _mm256_setr_epi32(0, 0, 0, 0, 1, 1, 1, 1))};
}
CONDYLE_INLINE void transpose(vf& a, vf& b, vf& c, vf& d) {
  const __m256 ab0 = _mm256_unpacklo_ps(a.v, b.v), ab1 = _mm256_unpackhi_ps(a.v, b.v);
  const __m256 cd0 = _mm256_unpacklo_ps(c.v, d.v), cd1 = _mm256_unpackhi_ps(c.v, d.v);
  a.v = _mm256_shuffle_ps(ab0, cd0, 0x44);
  b.v = _mm256_shuffle_ps(ab0, cd0, 0xee);
  c.v = _mm256_shuffle_ps(ab1, cd1, 0x44);
  d.v = _mm256_shuffle_ps(ab1, cd1, 0xee);
}
CONDYLE_INLINE vd low_doubles(vf a) { return {_mm256_cvtps_pd(_mm256_castps256_ps128(a.v))}; }
CONDYLE_INLINE vd high_doubles(vf a) { return {_mm256_cvtps_pd(_mm256_extractf128_ps(a.v, 1))}; }

}  // namespace
}  // namespace condyle::contact::fast
