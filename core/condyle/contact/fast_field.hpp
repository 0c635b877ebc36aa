// SPDX-License-Identifier: Apache-2.0
// The spline field at four points at a time, for the fast contact's kernels. Included by kernel
// compilations only; everything is static (see fast_kernel_body.hpp).
//
// The four x-neighbours of a stencil are contiguous, so a point's 64 coefficients are 16 vector
// loads, contracted over y and z in lanes along x; a 4×4 transpose then puts four points into the
// lanes for the contraction over x.
#pragma once

#include "condyle/contact/fast_kernel.hpp"
#include "condyle/contact/fast_vector.hpp"

namespace condyle::contact::fast {
namespace {

/// Points are treated in batches, one stage of the work after the other, so that the many
/// independent short chains of a stage overlap in the processor; a point at a time would wait for
/// its own latencies.
constexpr int kBatch = 32;

struct Points {
  alignas(32) double q[3][kBatch];  ///< in F [m]
  alignas(32) double t[3][kBatch];  ///< fractions in their cells
  std::int32_t base[kBatch];        ///< where their stencils begin
  int inside[kBatch / kGroup];  ///< bit l: the stencil fits in the grid; elsewhere the nearest cell
                                ///< stands in
};

/// Fills t, base and inside from q. @param count multiple of kGroup.
CONDYLE_INLINE void locate(const FieldView& field, int count, Points& at) {
  const v4 row = splat(static_cast<double>(field.row));
  const v4 plane = splat(static_cast<double>(field.plane));
  const v4 first = splat(static_cast<double>(1 + field.row + field.plane));
  for (int n = 0; n < count; n += kGroup) {
    v4 cell[3];
    int inside = 15;
    for (int a = 0; a < 3; ++a) {
      const v4 u = fma(load(at.q[a] + n), splat(field.inverse_spacing), splat(field.offset[a]));
      const v4 held = smaller(larger(u, splat(1.0)), splat(field.last[a]));
      inside &= equal_lanes(u, held);
      cell[a] = truncated(held);
      store(at.t[a] + n, held - cell[a]);
    }
    store_integers(at.base + n, fma(cell[2], plane, fma(cell[1], row, cell[0])) - first);
    at.inside[n / kGroup] = inside;
  }
}

CONDYLE_INLINE void value_weights(v4 t, v4 w[4]) {
  const v4 s = splat(1.0) - t, k = splat(2.0 / 3.0), half = splat(0.5), sixth = splat(1.0 / 6.0);
  const v4 tt = t * t, ss = s * s;
  w[0] = ss * s * sixth;
  w[1] = fma(tt, fms(half, t, splat(1.0)), k);
  w[2] = fma(ss, fms(half, s, splat(1.0)), k);
  w[3] = tt * t * sixth;
}
CONDYLE_INLINE void slope_weights(v4 t, v4 w[4]) {
  const v4 s = splat(1.0) - t, half = splat(0.5), two = splat(2.0), k = splat(1.5);
  w[0] = splat(-0.5) * s * s;
  w[1] = t * fms(k, t, two);
  w[2] = s * fnma(k, s, two);
  w[3] = half * t * t;
}
CONDYLE_INLINE void curvature_weights(v4 t, v4 w[4]) {
  const v4 s = splat(1.0) - t, two = splat(2.0), three = splat(3.0);
  w[0] = s;
  w[1] = fms(three, t, two);
  w[2] = fms(three, s, two);
  w[3] = t;
}

/// Weights of a batch in memory: read back one at a time and spread over the lanes.
struct Spread {
  alignas(32) double w[4][kBatch];
  CONDYLE_INLINE_MEMBER void put(int n, const v4 weights[4]) {
    for (int i = 0; i < 4; ++i) store(w[i] + n, weights[i]);
  }
  CONDYLE_INLINE_MEMBER v4 get(int weight, int point) const { return splat(w[weight][point]); }
};

/// Four points' lanes along x, as four vectors with a point in each lane.
CONDYLE_INLINE void take(const double (*lanes)[4], v4 c[4]) {
  for (int l = 0; l < 4; ++l) c[l] = load(lanes[l]);
  transpose(c[0], c[1], c[2], c[3]);
}

CONDYLE_INLINE v4 contract(const v4 w[4], const v4 c[4]) {
  return fma(w[0], c[0], w[1] * c[1]) + fma(w[2], c[2], w[3] * c[3]);
}

/// φ at located points. @param count multiple of kGroup. @param value kBatch [m].
static void values(const FieldView& field, const Points& at, int count, double* value) {
  Spread y, z;
  alignas(32) double lanes[kBatch][4];
  v4 w[4];
  for (int n = 0; n < count; n += kGroup) {
    value_weights(load(at.t[1] + n), w), y.put(n, w);
    value_weights(load(at.t[2] + n), w), z.put(n, w);
  }
  for (int n = 0; n < count; ++n) {
    const float* c = field.coefficients + at.base[n];
    v4 total[2] = {splat(0.0), splat(0.0)};
#pragma GCC unroll 4
    for (int k = 0; k < 4; ++k) {
      const float* r = c + k * field.plane;
      const v4 low = fma(y.get(1, n), load(r + field.row), y.get(0, n) * load(r));
      const v4 high =
          fma(y.get(3, n), load(r + 3 * field.row), y.get(2, n) * load(r + 2 * field.row));
      total[0] = fma(z.get(k, n), low, total[0]);
      total[1] = fma(z.get(k, n), high, total[1]);
    }
    store(lanes[n], total[0] + total[1]);
  }
  for (int n = 0; n < count; n += kGroup) {
    v4 c[4];
    take(lanes + n, c);
    value_weights(load(at.t[0] + n), w);
    store(value + n, contract(w, c));
  }
}

/// A field's value and derivatives at a batch of points.
struct FieldBatch {
  alignas(32) double value[kBatch], gradient[3][kBatch];
  alignas(32) double hessian[6][kBatch];  ///< xx, yy, zz, xy, xz, yz; only with kHessian
};

/// Where the contraction over y and z leaves a batch: lanes along x; the digits say how often
/// differentiated along y and z.
struct Contracted {
  alignas(32) double c00[kBatch][4], c10[kBatch][4], c01[kBatch][4], c20[kBatch][4], c02[kBatch][4],
      c11[kBatch][4];
};

template <bool kHessian>
CONDYLE_INLINE void contract_yz(const FieldView& field, const Points& at, int count,
                                Contracted& out) {
  Spread y0, y1, y2, z0, z1, z2;
  for (int n = 0; n < count; n += kGroup) {
    const v4 ty = load(at.t[1] + n), tz = load(at.t[2] + n);
    v4 w[4];
    value_weights(ty, w), y0.put(n, w);
    slope_weights(ty, w), y1.put(n, w);
    value_weights(tz, w), z0.put(n, w);
    slope_weights(tz, w), z1.put(n, w);
    if constexpr (kHessian) {
      curvature_weights(ty, w), y2.put(n, w);
      curvature_weights(tz, w), z2.put(n, w);
    }
  }
  for (int n = 0; n < count; ++n) {
    const float* c = field.coefficients + at.base[n];
    // Over y first, four planes at a time: twelve sums, three weights and a row are the sixteen
    // registers of AVX2.
    v4 a0[4], a1[4], a2[4];
#pragma GCC unroll 4
    for (int j = 0; j < 4; ++j) {
      const v4 w0 = y0.get(j, n), w1 = y1.get(j, n);
      const v4 w2 = kHessian ? y2.get(j, n) : splat(0.0);
#pragma GCC unroll 4
      for (int k = 0; k < 4; ++k) {
        const v4 r = load(c + k * field.plane + j * field.row);
        a0[k] = j == 0 ? w0 * r : fma(w0, r, a0[k]);
        a1[k] = j == 0 ? w1 * r : fma(w1, r, a1[k]);
        if constexpr (kHessian) a2[k] = j == 0 ? w2 * r : fma(w2, r, a2[k]);
      }
    }
    v4 s00 = z0.get(0, n) * a0[0], s10 = z0.get(0, n) * a1[0], s01 = z1.get(0, n) * a0[0];
    v4 s20 = splat(0.0), s02 = s20, s11 = s20;
    if constexpr (kHessian) {
      s20 = z0.get(0, n) * a2[0], s02 = z2.get(0, n) * a0[0], s11 = z1.get(0, n) * a1[0];
    }
#pragma GCC unroll 3
    for (int k = 1; k < 4; ++k) {
      const v4 w0 = z0.get(k, n), w1 = z1.get(k, n);
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
  Contracted yz;
  contract_yz<kHessian>(field, at, count, yz);
  const v4 g = splat(field.inverse_spacing), h = g * g;
  for (int n = 0; n < count; n += kGroup) {
    const v4 t = load(at.t[0] + n);
    v4 x0[4], x1[4], x2[4], c[4];
    value_weights(t, x0);
    slope_weights(t, x1);
    if constexpr (kHessian) curvature_weights(t, x2);
    take(yz.c00 + n, c);
    store(out.value + n, contract(x0, c));
    store(out.gradient[0] + n, contract(x1, c) * g);
    if constexpr (kHessian) store(out.hessian[0] + n, contract(x2, c) * h);
    take(yz.c10 + n, c);
    store(out.gradient[1] + n, contract(x0, c) * g);
    if constexpr (kHessian) store(out.hessian[3] + n, contract(x1, c) * h);
    take(yz.c01 + n, c);
    store(out.gradient[2] + n, contract(x0, c) * g);
    if constexpr (kHessian) {
      store(out.hessian[4] + n, contract(x1, c) * h);
      take(yz.c20 + n, c);
      store(out.hessian[1] + n, contract(x0, c) * h);
      take(yz.c02 + n, c);
      store(out.hessian[2] + n, contract(x0, c) * h);
      take(yz.c11 + n, c);
      store(out.hessian[5] + n, contract(x0, c) * h);
    }
  }
}

/// Of the group of points from n on: bit l: point n + l is closest to the open border, as
/// geometry::DistanceField::on_border says. @param lanes the points to ask about.
static int border_lanes(const FieldView& field, const Points& at, int n, int lanes) {
  const std::int64_t centre =
      1 + field.row + field.plane;  // from a stencil's first node to its cell
  int flagged = 0;
  for (int l = 0; l < kGroup; ++l) {
    flagged |= field.border_cells[at.base[n + l] + centre] == 0 ? 0 : 1 << l;
  }
  int result = 0;
  for (int l = 0; l < kGroup && (lanes & flagged) != 0; ++l) {
    if (((lanes & flagged) >> l & 1) == 0) continue;
    const std::int64_t low = at.base[n + l] + centre;
    const double x = at.t[0][n + l], y = at.t[1][n + l], z = at.t[2][n + l];
    double share = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
      const int i = corner & 1, j = (corner >> 1) & 1, k = corner >> 2;
      const double w = (i ? x : 1.0 - x) * (j ? y : 1.0 - y) * (k ? z : 1.0 - z);
      if (field.border_nodes[low + i + field.row * j + field.plane * k] != 0) share += w;
    }
    if (share >= 0.5) result |= 1 << l;
  }
  return result;
}

}  // namespace
}  // namespace condyle::contact::fast
