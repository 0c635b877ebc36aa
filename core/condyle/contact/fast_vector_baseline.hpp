// SPDX-License-Identifier: Apache-2.0
// The kernels' vectors in halves of 16 bytes, as every compiler for every machine has them: see
// fast_vector.hpp.
#pragma once

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace condyle::contact::fast {
namespace {

constexpr int kGroup = 4;

typedef double d2 __attribute__((vector_size(16)));
typedef float f4 __attribute__((vector_size(16)));

template <typename Half, typename Scalar>
CONDYLE_INLINE Half load_half(const Scalar* p) {
  Half r;
  std::memcpy(&r, p, sizeof r);
  return r;
}

struct vd {
  d2 a, b;
};
CONDYLE_INLINE vd splat(double a) { return {d2{a, a}, d2{a, a}}; }
CONDYLE_INLINE vd load(const double* p) { return {load_half<d2>(p), load_half<d2>(p + 2)}; }
CONDYLE_INLINE void store(double* p, vd r) {
  std::memcpy(p, &r.a, sizeof r.a);
  std::memcpy(p + 2, &r.b, sizeof r.b);
}
CONDYLE_INLINE vd operator+(vd x, vd y) { return {x.a + y.a, x.b + y.b}; }
CONDYLE_INLINE vd operator-(vd x, vd y) { return {x.a - y.a, x.b - y.b}; }
CONDYLE_INLINE vd operator*(vd x, vd y) { return {x.a * y.a, x.b * y.b}; }
CONDYLE_INLINE vd fma(vd x, vd y, vd z) { return x * y + z; }
CONDYLE_INLINE vd fms(vd x, vd y, vd z) { return x * y - z; }
CONDYLE_INLINE vd fnma(vd x, vd y, vd z) { return z - x * y; }
CONDYLE_INLINE d2 smaller(d2 x, d2 y) { return x < y ? x : y; }
CONDYLE_INLINE d2 larger(d2 x, d2 y) { return x > y ? x : y; }
CONDYLE_INLINE vd smaller(vd x, vd y) { return {smaller(x.a, y.a), smaller(x.b, y.b)}; }
CONDYLE_INLINE vd larger(vd x, vd y) { return {larger(x.a, y.a), larger(x.b, y.b)}; }
CONDYLE_INLINE int negative_lanes(vd x) {
  return (x.a[0] < 0.0 ? 1 : 0) | (x.a[1] < 0.0 ? 2 : 0) | (x.b[0] < 0.0 ? 4 : 0) |
         (x.b[1] < 0.0 ? 8 : 0);
}
CONDYLE_INLINE int equal_lanes(vd x, vd y) {
  return (x.a[0] == y.a[0] ? 1 : 0) | (x.a[1] == y.a[1] ? 2 : 0) | (x.b[0] == y.b[0] ? 4 : 0) |
         (x.b[1] == y.b[1] ? 8 : 0);
}
/// Zero where the lane's bit is not set.
CONDYLE_INLINE vd chosen(int lanes, vd x) {
  return {d2{lanes & 1 ? x.a[0] : 0.0, lanes & 2 ? x.a[1] : 0.0},
          d2{lanes & 4 ? x.b[0] : 0.0, lanes & 8 ? x.b[1] : 0.0}};
}
/// Towards zero. @pre within int32.
CONDYLE_INLINE d2 truncated(d2 x) {
  return d2{static_cast<double>(static_cast<std::int32_t>(x[0])),
            static_cast<double>(static_cast<std::int32_t>(x[1]))};
}
CONDYLE_INLINE vd truncated(vd x) { return {truncated(x.a), truncated(x.b)}; }
CONDYLE_INLINE void store_integers(std::int32_t* p, vd x) {
  for (int i = 0; i < 2; ++i) p[i] = static_cast<std::int32_t>(x.a[i]);
  for (int i = 0; i < 2; ++i) p[2 + i] = static_cast<std::int32_t>(x.b[i]);
}
CONDYLE_INLINE void store_floats(float* p, vd x) {
  for (int i = 0; i < 2; ++i) p[i] = static_cast<float>(x.a[i]);
  for (int i = 0; i < 2; ++i) p[2 + i] = static_cast<float>(x.b[i]);
}

struct vf {
  f4 a, b;
};
CONDYLE_INLINE vf splat(float a) { return {f4{a, a, a, a}, f4{a, a, a, a}}; }
CONDYLE_INLINE vf load(const float* p) { return {load_half<f4>(p), load_half<f4>(p + 4)}; }
CONDYLE_INLINE void store(float* p, vf x) {
  std::memcpy(p, &x.a, sizeof x.a);
  std::memcpy(p + 4, &x.b, sizeof x.b);
}
CONDYLE_INLINE vf operator+(vf x, vf y) { return {x.a + y.a, x.b + y.b}; }
CONDYLE_INLINE vf operator-(vf x, vf y) { return {x.a - y.a, x.b - y.b}; }
CONDYLE_INLINE vf operator*(vf x, vf y) { return {x.a * y.a, x.b * y.b}; }
CONDYLE_INLINE vd doubles(f4 x) {
#if defined(__SSE2__)
  const __m128 f = (__m128)x;
  return {(d2)_mm_cvtps_pd(f), (d2)_mm_cvtps_pd(_mm_movehl_ps(f, f))};
#else
  return {d2{x[0], x[1]}, d2{x[2], x[3]}};
#endif
}
CONDYLE_INLINE f4 floats(vd x) {
#if defined(__SSE2__)
  return (f4)_mm_movelh_ps(_mm_cvtpd_ps((__m128d)x.a), _mm_cvtpd_ps((__m128d)x.b));
#else
  return f4{static_cast<float>(x.a[0]), static_cast<float>(x.a[1]), static_cast<float>(x.b[0]),
            static_cast<float>(x.b[1])};
#endif
}
/// As if fused, by way of doubles: the product is exact there, and rounding the sum twice differs from
/// rounding it once for one sum in 5e8.
CONDYLE_INLINE vf fma(vf x, vf y, vf z) {
  return {floats(doubles(x.a) * doubles(y.a) + doubles(z.a)),
          floats(doubles(x.b) * doubles(y.b) + doubles(z.b))};
}
CONDYLE_INLINE vf load_rows(const float* const p[2], std::int64_t offset) {
  return {load_half<f4>(p[0] + offset), load_half<f4>(p[1] + offset)};
}
CONDYLE_INLINE vf spread(const float* p) {
  return {f4{p[0], p[0], p[0], p[0]}, f4{p[1], p[1], p[1], p[1]}};
}
CONDYLE_INLINE void transpose(f4& a, f4& b, f4& c, f4& d) {
  const f4 A{a[0], b[0], c[0], d[0]}, B{a[1], b[1], c[1], d[1]};
  const f4 C{a[2], b[2], c[2], d[2]}, D{a[3], b[3], c[3], d[3]};
  a = A, b = B, c = C, d = D;
}
CONDYLE_INLINE void transpose(vf& a, vf& b, vf& c, vf& d) {
  transpose(a.a, b.a, c.a, d.a);
  transpose(a.b, b.b, c.b, d.b);
}
CONDYLE_INLINE vd low_doubles(vf x) { return doubles(x.a); }
CONDYLE_INLINE vd high_doubles(vf x) { return doubles(x.b); }

}  // namespace
}  // namespace condyle::contact::fast
