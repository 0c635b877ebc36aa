// SPDX-License-Identifier: Apache-2.0
// The body of the dense layers' kernels (dense_kernels.hpp), compiled once for each instruction set
// by dense_kernel_*.cpp, which name the table (CONDYLE_DENSE_KERNELS) and the set.
#include "condyle/surrogate/dense_kernels.hpp"
#include "condyle/surrogate/dense_vector.hpp"

namespace condyle::surrogate::dense {
namespace {

// Sums that are kept in registers: columns × kTileVectors. AVX-512 has 32 registers, the others 16;
// eight sums at least hide a fused product's latency.
#if defined(__AVX512F__)
constexpr int kTileColumns = 7;
#else
constexpr int kTileColumns = 4;
#endif
constexpr int kTileVectors = 2;

template <int C, int V>
CONDYLE_INLINE void multiply_tile(const double* weight, int inputs, int width, const double* in,
                                  int in_stride, double* out, int out_stride) {
  Vector sum[C][V] = {};
  for (int i = 0; i < inputs; ++i, weight += width) {
    Vector w[V];
    for (int v = 0; v < V; ++v) w[v] = load(weight + v * kLanes);
    for (int c = 0; c < C; ++c) {
      const Vector x = splat(in[c * in_stride + i]);
      for (int v = 0; v < V; ++v) sum[c][v] = multiply_add(x, w[v], sum[c][v]);
    }
  }
  for (int c = 0; c < C; ++c) {
    for (int v = 0; v < V; ++v) store(out + c * out_stride + v * kLanes, sum[c][v]);
  }
}

template <int C>
CONDYLE_INLINE void multiply_columns(const double* weight, int inputs, int width, const double* in,
                                     int in_stride, double* out, int out_stride) {
  int j = 0;
  for (; j + kTileVectors * kLanes <= width; j += kTileVectors * kLanes) {
    multiply_tile<C, kTileVectors>(weight + j, inputs, width, in, in_stride, out + j, out_stride);
  }
  if (j < width) {
    multiply_tile<C, 1>(weight + j, inputs, width, in, in_stride, out + j, out_stride);
  }
}

void multiply(const double* weight, int inputs, int width, const double* in, int in_stride,
              int columns, double* out, int out_stride) {
  constexpr int kTile = kTileColumns;
  int c = 0;
  for (; c + kTile <= columns; c += kTile, in += kTile * in_stride, out += kTile * out_stride) {
    multiply_columns<kTile>(weight, inputs, width, in, in_stride, out, out_stride);
  }
  for (; c + 3 <= columns; c += 3, in += 3 * in_stride, out += 3 * out_stride) {
    multiply_columns<3>(weight, inputs, width, in, in_stride, out, out_stride);
  }
  for (; c < columns; ++c, in += in_stride, out += out_stride) {
    multiply_columns<1>(weight, inputs, width, in, in_stride, out, out_stride);
  }
}

/// tanh x = (2^k·A − B)/(2^k·A + B), exp(r) = A/B, 2x = k·ln 2 + r, |r| ≤ ln(2)/2.
///
/// With A, B = Q(r²) ± r·P(r²) (the rational of Moshier's Cephes, good to 1e-16) numerator and
/// denominator are (2^k ∓ 1)·Q + (2^k ± 1)·r·P: nothing cancels for small x, where k = 0.
CONDYLE_INLINE void tanh_fraction(Vector x, Vector& numerator, Vector& denominator) {
  // Beyond 44/2 tanh is 1 in double precision.
  const Vector u = clamped(x + x, 44.0);
  // Adding 1.5·2^52 rounds to an integer and leaves it in the low bits.
  const Vector magic = splat(6755399441055744.0);
  const Vector shifted = multiply_add(u, splat(1.4426950408889634), magic);
  const Vector k = shifted - magic;
  // ln 2 in two parts; the first has trailing zeros, so that k times it is exact.
  Vector r = multiply_add(k, splat(-6.93147180369123816490e-01), u);
  r = multiply_add(k, splat(-1.90821492927058770002e-10), r);
  const Vector z = r * r;
  Vector p = multiply_add(splat(1.26177193074810590878e-4), z, splat(3.02994407707441961300e-2));
  p = multiply_add(p, z, splat(9.99999999999999999910e-1)) * r;
  Vector q = multiply_add(splat(3.00198505138664455042e-6), z, splat(2.52448340349684104192e-3));
  q = multiply_add(q, z, splat(2.27265548208155028766e-1));
  q = multiply_add(q, z, splat(2.0));
  // Into the exponent; what stands above the low bits is shifted out.
  const Vector power = number((bits(shifted) << 52) + bits(splat(1.0)));
  const Vector less = power - splat(1.0), more = power + splat(1.0);
  numerator = multiply_add(more, p, less * q);
  denominator = multiply_add(less, p, more * q);
}

/// Four fractions by one division, which takes as long as ten products: 1/a = b·1/(a·b). The
/// denominators are below 2^66, and four of them well within range. What is not a number spreads to
/// the same lane of the other three: neurons of the same pose, which has no result anyway.
CONDYLE_INLINE void tanh_of_four(const double* bias, double* column) {
  Vector n[4], d[4];
  for (int v = 0; v < 4; ++v) {
    tanh_fraction(load(column + v * kLanes) + load(bias + v * kLanes), n[v], d[v]);
  }
  const Vector first = d[0] * d[1], second = d[2] * d[3];
  const Vector inverse = splat(1.0) / (first * second);
  const Vector of_first = inverse * second, of_second = inverse * first;
  store(column, n[0] * (of_first * d[1]));
  store(column + kLanes, n[1] * (of_first * d[0]));
  store(column + 2 * kLanes, n[2] * (of_second * d[3]));
  store(column + 3 * kLanes, n[3] * (of_second * d[2]));
}

CONDYLE_INLINE void tanh_column(const double* bias, int width, double* column) {
  int j = 0;
  for (; j + 4 * kLanes <= width; j += 4 * kLanes) tanh_of_four(bias + j, column + j);
  for (; j < width; j += kLanes) {
    Vector n, d;
    tanh_fraction(load(column + j) + load(bias + j), n, d);
    store(column + j, n / d);
  }
}

void tanh_columns(const double* bias, int width, double* values, int stride, int columns) {
  for (int c = 0; c < columns; ++c) tanh_column(bias, width, values + c * stride);
}

void tanh_with_derivatives(const double* bias, int width, double* values, int stride, int columns) {
  for (int c = 0; c < columns; c += kPoseColumns) {
    double* column = values + c * stride;
    tanh_column(bias, width, column);
    for (int j = 0; j < width; j += kLanes) {
      const Vector h = load(column + j);
      const Vector slope = splat(1.0) - h * h;
      for (int k = 1; k <= kDenseTangents; ++k) {
        double* tangent = column + k * stride + j;
        store(tangent, load(tangent) * slope);
      }
    }
  }
}

void times_slope(const double* hidden, int width, double* values, int stride, int columns) {
  for (int c = 0; c < columns; ++c, hidden += stride, values += stride) {
    for (int j = 0; j < width; j += kLanes) {
      const Vector h = load(hidden + j);
      store(values + j, (splat(1.0) - h * h) * load(values + j));
    }
  }
}

void slope_tangents(const double* hidden, int width, const double* in, int in_stride, double* out,
                    int out_stride) {
  for (int j = 0; j < width; j += kLanes) {
    const Vector h = load(hidden + j);
    const Vector slope = splat(1.0) - h * h;
    for (int k = 0; k < kDenseTangents; ++k) {
      store(out + k * out_stride + j, slope * load(in + k * in_stride + j));
    }
  }
}

CONDYLE_INLINE double sum_of_lanes(Vector a) {
#if defined(__AVX512F__)
  const __m256d four = _mm512_castpd512_pd256(a) + _mm512_extractf64x4_pd(a, 1);
#elif defined(__AVX2__)
  const __m256d four = a;
#endif
#if defined(__AVX2__)
  const __m128d two = _mm256_castpd256_pd128(four) + _mm256_extractf128_pd(four, 1);
  return two[0] + two[1];
#else
  return a[0] + a[1];
#endif
}

/// Rows [First, End) of the pairs: not all at once where there are only sixteen registers.
template <int First, int End>
CONDYLE_INLINE void add_curvature_rows(const double* hidden, const double* delta, int width,
                                       const double* tangent, int stride, double* sums) {
  constexpr int kColumns = kDenseTangents - First;
  Vector sum[End - First][kColumns] = {};
  for (int j = 0; j < width; j += kLanes) {
    const Vector bend = splat(-2.0) * load(hidden + j) * load(delta + j);
#pragma GCC unroll 6
    for (int k = First; k < End; ++k) {
      const Vector bent = bend * load(tangent + k * stride + j);
#pragma GCC unroll 6
      for (int m = k; m < kDenseTangents; ++m) {
        Vector& total = sum[k - First][m - First];
        total = multiply_add(bent, load(tangent + m * stride + j), total);
      }
    }
  }
#pragma GCC unroll 6
  for (int k = First; k < End; ++k) {
#pragma GCC unroll 6
    for (int m = k; m < kDenseTangents; ++m) {
      const int pair = k * kDenseTangents - k * (k - 1) / 2 + m - k;
      sums[pair] += sum_of_lanes(sum[k - First][m - First]);
    }
  }
}

void add_curvature(const double* hidden, const double* delta, int width, const double* tangent,
                   int stride, double* sums) {
#if defined(__AVX512F__)
  add_curvature_rows<0, 6>(hidden, delta, width, tangent, stride, sums);
#else
  add_curvature_rows<0, 2>(hidden, delta, width, tangent, stride, sums);
  add_curvature_rows<2, 6>(hidden, delta, width, tangent, stride, sums);
#endif
}

}  // namespace

extern const DenseKernels CONDYLE_DENSE_KERNELS;
const DenseKernels CONDYLE_DENSE_KERNELS{CONDYLE_DENSE_INSTRUCTION_SET,
                                         &multiply,
                                         &tanh_columns,
                                         &tanh_with_derivatives,
                                         &times_slope,
                                         &slope_tangents,
                                         &add_curvature};

}  // namespace condyle::surrogate::dense
