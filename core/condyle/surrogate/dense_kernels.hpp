// SPDX-License-Identifier: Apache-2.0
// The arithmetic of dense tanh layers on a few columns at once, once for each instruction set.
//
// A column is the state of one pose, or one of its derivatives, at a layer: `width` doubles, a
// multiple of kDenseStep. Columns lie one after the other, `stride` doubles apart. Each column's
// sums are taken in the same order whatever stands beside it: so a pose gives the same bytes alone,
// in a batch, and with or without derivatives (for one instruction set).
#pragma once

#include <span>

namespace condyle::surrogate {

/// Widths are rounded up to this, with zero weights: the doubles of the widest register.
inline constexpr int kDenseStep = 8;
/// The widest layer, rounded up.
inline constexpr int kMaxDenseWidth = 128;
/// A value and its derivatives by the six coordinates of the pose.
inline constexpr int kDenseTangents = 6;
inline constexpr int kPoseColumns = 1 + kDenseTangents;
/// Columns that one call takes: four poses with their derivatives.
inline constexpr int kMaxDenseColumns = 4 * kPoseColumns;

/// The kernels of one instruction set. Same results in all to 1e-12: they differ in which products
/// are fused.
struct DenseKernels {
  const char* instruction_set = "";  ///< "baseline", "avx2" or "avx512"

  /// out[c][j] = Σ_i in[c][i]·weight[i·width + j] for each of `columns` columns.
  /// @param weight (inputs, width) row-major.
  /// @pre in and out do not overlap; width ≤ out_stride.
  void (*multiply)(const double* weight, int inputs, int width, const double* in, int in_stride,
                   int columns, double* out, int out_stride) = nullptr;

  /// column[j] ← tanh(column[j] + bias[j]), within 8 units in the last place; NaN stays NaN.
  void (*tanh)(const double* bias, int width, double* values, int stride, int columns) = nullptr;

  /// As tanh for every seventh column, the value of a pose; the six after it are its derivatives:
  /// they become (1 − tanh²)·derivative.
  void (*tanh_with_derivatives)(const double* bias, int width, double* values, int stride,
                                int columns) = nullptr;

  /// values[c][j] ← (1 − hidden[c][j]²)·values[c][j]: a step of back-propagation.
  void (*times_slope)(const double* hidden, int width, double* values, int stride,
                      int columns) = nullptr;

  /// out[k] = (1 − hidden²)·in[k] for the six derivatives of one pose; in and out may not overlap.
  void (*slope_tangents)(const double* hidden, int width, const double* in, int in_stride,
                         double* out, int out_stride) = nullptr;

  /// sums[·] += Σ_j −2·hidden[j]·delta[j]·tangent[k][j]·tangent[m][j] for the 21 pairs k ≤ m in the
  /// order (0,0), (0,1), ..., (5,5): what a layer adds to the second derivative of a scalar.
  void (*add_curvature)(const double* hidden, const double* delta, int width, const double* tangent,
                        int stride, double* sums) = nullptr;
};

/// Pairs k ≤ m of the six coordinates.
inline constexpr int kDensePairs = kDenseTangents * (kDenseTangents + 1) / 2;

/// The best that this machine can run.
const DenseKernels& dense_kernels();

/// All that it can run, the best first.
std::span<const DenseKernels> all_dense_kernels();

}  // namespace condyle::surrogate
