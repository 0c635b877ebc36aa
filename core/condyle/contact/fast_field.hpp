// SPDX-License-Identifier: Apache-2.0
// The spline field at a batch of points, for the fast contact's kernels. Included by kernel
// compilations only; everything is static (see fast_kernel_body.hpp).
//
// The four x-neighbours of a stencil are contiguous, so a point's 64 coefficients are 16 vector
// loads, contracted over y and z in lanes along x, kSide points side by side; a transpose then puts
// 2·kGroup points into the lanes for the contraction over x.
//
// Single precision, as the coefficients are: φ is then right to some 1e-7 of a millimetre, ∇φ to 1e-6,
// a thousandth of what the field itself is wrong by, for half the work. Where a point lies in its
// cell is found in double precision, unfused, and floats are fused everywhere, so that a point gives
// the same bits with every instruction set.
#pragma once

#include "condyle/contact/fast_kernel.hpp"
#include "condyle/contact/fast_points.hpp"
#include "condyle/contact/fast_vector.hpp"

namespace condyle::contact::fast {
namespace {

CONDYLE_INLINE void value_weights(vf t, vf w[4]) {
  const vf s = splat(1.0f) - t, k = splat(2.0f / 3.0f), half = splat(0.5f);
  const vf sixth = splat(1.0f / 6.0f), one = splat(1.0f), tt = t * t, ss = s * s;
  w[0] = ss * s * sixth;
  w[1] = fma(tt, half * t - one, k);
  w[2] = fma(ss, half * s - one, k);
  w[3] = tt * t * sixth;
}
CONDYLE_INLINE void slope_weights(vf t, vf w[4]) {
  const vf s = splat(1.0f) - t, half = splat(0.5f), two = splat(2.0f), k = splat(1.5f);
  w[0] = splat(-0.5f) * s * s;
  w[1] = t * (k * t - two);
  w[2] = s * (two - k * s);
  w[3] = half * t * t;
}
CONDYLE_INLINE void curvature_weights(vf t, vf w[4]) {
  const vf s = splat(1.0f) - t, two = splat(2.0f), three = splat(3.0f);
  w[0] = s;
  w[1] = three * t - two;
  w[2] = three * s - two;
  w[3] = t;
}

/// Weights of a batch in memory: read back for kSide points at a time, each over its four lanes.
struct Spread {
  alignas(64) float w[4][kBatch];
  CONDYLE_INLINE_MEMBER void put(int n, const vf weights[4]) {
    for (int i = 0; i < 4; ++i) store(w[i] + n, weights[i]);
  }
  CONDYLE_INLINE_MEMBER vf get(int weight, int point) const { return spread(w[weight] + point); }
};

/// The lanes along x of two groups' points, as four vectors with a point in each lane.
CONDYLE_INLINE void take(const float (*lanes)[4], vf c[4]) {
  for (int l = 0; l < 4; ++l) {
    const float* rows[kSide];
    for (int i = 0; i < kSide; ++i) rows[i] = lanes[l + 4 * i];
    c[l] = load_rows(rows, 0);
  }
  transpose(c[0], c[1], c[2], c[3]);
}

CONDYLE_INLINE vf contract(const vf w[4], const vf c[4]) {
  return fma(w[0], c[0], w[1] * c[1]) + fma(w[2], c[2], w[3] * c[3]);
}

CONDYLE_INLINE void store_doubles(double* p, vf a) {
  store(p, low_doubles(a));
  store(p + kGroup, high_doubles(a));
}
CONDYLE_INLINE void store_doubles(double* p, vf a, vd factor) {
  store(p, low_doubles(a) * factor);
  store(p + kGroup, high_doubles(a) * factor);
}

/// φ at located points. @param count multiple of kGroup. @param value kBatch [m].
static void values(const FieldView& field, const Points& at, int count, double* value) {
  Spread y, z;
  alignas(64) float lanes[kBatch][4];
  vf w[4];
  const int twos = whole_twos(count);
  for (int n = 0; n < twos; n += kTwo) {
    value_weights(load(at.t[1] + n), w), y.put(n, w);
    value_weights(load(at.t[2] + n), w), z.put(n, w);
  }
  for (int n = 0; n < twos; n += kSide) {
    const float* c[kSide];
    for (int i = 0; i < kSide; ++i) c[i] = field.coefficients + at.base[n + i];
    vf plane[4];
#pragma GCC unroll 4
    for (int j = 0; j < 4; ++j) {
      const vf weight = y.get(j, n);
#pragma GCC unroll 4
      for (int k = 0; k < 4; ++k) {
        const vf r = load_rows(c, k * field.plane + j * field.row);
        plane[k] = j == 0 ? weight * r : fma(weight, r, plane[k]);
      }
    }
    store(lanes[n], fma(z.get(0, n), plane[0], z.get(1, n) * plane[1]) +
                        fma(z.get(2, n), plane[2], z.get(3, n) * plane[3]));
  }
  for (int n = 0; n < twos; n += kTwo) {
    vf c[4];
    take(lanes + n, c);
    value_weights(load(at.t[0] + n), w);
    store_doubles(value + n, contract(w, c));
  }
}

/// A field's value and derivatives at a batch of points.
struct FieldBatch {
  alignas(64) double value[kBatch], gradient[3][kBatch];
  alignas(64) double hessian[6][kBatch];  ///< xx, yy, zz, xy, xz, yz; only with kHessian
};

/// Where the contraction over y and z leaves a batch: lanes along x; the digits say how often
/// differentiated along y and z.
struct Contracted {
  alignas(64) float c00[kBatch][4], c10[kBatch][4], c01[kBatch][4], c20[kBatch][4], c02[kBatch][4],
      c11[kBatch][4];
};

template <bool kHessian>
CONDYLE_INLINE void contract_yz(const FieldView& field, const Points& at, int twos,
                                Contracted& out) {
  Spread y0, y1, y2, z0, z1, z2;
  for (int n = 0; n < twos; n += kTwo) {
    const vf ty = load(at.t[1] + n), tz = load(at.t[2] + n);
    vf w[4];
    value_weights(ty, w), y0.put(n, w);
    slope_weights(ty, w), y1.put(n, w);
    value_weights(tz, w), z0.put(n, w);
    slope_weights(tz, w), z1.put(n, w);
    if constexpr (kHessian) {
      curvature_weights(ty, w), y2.put(n, w);
      curvature_weights(tz, w), z2.put(n, w);
    }
  }
  for (int n = 0; n < twos; n += kSide) {
    const float* c[kSide];
    for (int i = 0; i < kSide; ++i) c[i] = field.coefficients + at.base[n + i];
    // Over y first, four planes at a time: twelve sums, three weights and a row are the sixteen
    // registers of AVX2.
    vf a0[4], a1[4], a2[4];
#pragma GCC unroll 4
    for (int j = 0; j < 4; ++j) {
      const vf w0 = y0.get(j, n), w1 = y1.get(j, n);
      const vf w2 = kHessian ? y2.get(j, n) : splat(0.0f);
#pragma GCC unroll 4
      for (int k = 0; k < 4; ++k) {
        const vf r = load_rows(c, k * field.plane + j * field.row);
        a0[k] = j == 0 ? w0 * r : fma(w0, r, a0[k]);
        a1[k] = j == 0 ? w1 * r : fma(w1, r, a1[k]);
        if constexpr (kHessian) a2[k] = j == 0 ? w2 * r : fma(w2, r, a2[k]);
      }
    }
    vf s00 = z0.get(0, n) * a0[0], s10 = z0.get(0, n) * a1[0], s01 = z1.get(0, n) * a0[0];
    vf s20 = splat(0.0f), s02 = s20, s11 = s20;
    if constexpr (kHessian) {
      s20 = z0.get(0, n) * a2[0], s02 = z2.get(0, n) * a0[0], s11 = z1.get(0, n) * a1[0];
    }
#pragma GCC unroll 3
    for (int k = 1; k < 4; ++k) {
      const vf w0 = z0.get(k, n), w1 = z1.get(k, n);
      s00 = fma(w0, a0[k], s00);
      s10 = fma(w0, a1[k], s10);
      s01 = fma(w1, a0[k], s01);
      if constexpr (kHessian) {
        s20 = fma(w0, a2[k], s20);
        s02 = fma(z2.get(k, n), a0[k], s02);
        s11 = fma(w1, a1[k], s11);
      }
    }
    store(out.c00[n], s00), store(out.c10[n], s10), store(out.c01[n], s01);
    if constexpr (kHessian) {
      store(out.c20[n], s20), store(out.c02[n], s02), store(out.c11[n], s11);
    }
  }
}

/// φ, ∇φ and, if kHessian, ∇²φ at located points. @param count multiple of kGroup.
template <bool kHessian>
CONDYLE_INLINE void derivatives(const FieldView& field, const Points& at, int count,
                                FieldBatch& out) {
  const int twos = whole_twos(count);
  Contracted yz;
  contract_yz<kHessian>(field, at, twos, yz);
  const vd g = splat(field.inverse_spacing), h = g * g;
  for (int n = 0; n < twos; n += kTwo) {
    const vf t = load(at.t[0] + n);
    vf x0[4], x1[4], x2[4], c[4];
    value_weights(t, x0);
    slope_weights(t, x1);
    if constexpr (kHessian) curvature_weights(t, x2);
    take(yz.c00 + n, c);
    store_doubles(out.value + n, contract(x0, c));
    store_doubles(out.gradient[0] + n, contract(x1, c), g);
    if constexpr (kHessian) store_doubles(out.hessian[0] + n, contract(x2, c), h);
    take(yz.c10 + n, c);
    store_doubles(out.gradient[1] + n, contract(x0, c), g);
    if constexpr (kHessian) store_doubles(out.hessian[3] + n, contract(x1, c), h);
    take(yz.c01 + n, c);
    store_doubles(out.gradient[2] + n, contract(x0, c), g);
    if constexpr (kHessian) {
      store_doubles(out.hessian[4] + n, contract(x1, c), h);
      take(yz.c20 + n, c);
      store_doubles(out.hessian[1] + n, contract(x0, c), h);
      take(yz.c02 + n, c);
      store_doubles(out.hessian[2] + n, contract(x0, c), h);
      take(yz.c11 + n, c);
      store_doubles(out.hessian[5] + n, contract(x0, c), h);
    }
  }
}

}  // namespace
}  // namespace condyle::contact::fast
