// SPDX-License-Identifier: Apache-2.0
// What a row program is made of: steps that each compute one value of every row from others.
// A row is one pose; a value is `size` doubles of it, row after row, `stride` doubles apart.
// Truth values are 1 and 0.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "condyle/surrogate/dense_kernels.hpp"

namespace condyle::surrogate {

/// Where a value's rows are during a run.
struct RowSpan {
  double* data = nullptr;
  std::size_t stride = 0;
};

/// A value by its number, or constants: what a step reads. index[s] is the element that goes into
/// element s of the result: broadcasting, written out.
struct RowOperand {
  int slot = -1;                   ///< -1: constants
  std::vector<double> constants;   ///< already broadcast to the result's size
  std::vector<std::size_t> index;  ///< empty where it would count 0, 1, 2, ...
};

/// Thread safety: run() is const; each thread has spans of its own.
class RowStep {
 public:
  virtual ~RowStep() = default;
  /// @param spans by slot; what this step writes is among them.
  virtual void run(std::size_t rows, const std::vector<RowSpan>& spans) const = 0;
};

/// Elements of other values, in any order: Concat, Gather, Reshape, Slice, Squeeze, Transpose.
struct RowPick {
  int slot = 0;
  std::size_t element = 0;
};
std::unique_ptr<RowStep> pick_step(std::vector<RowPick> picks, int out);

/// Operators of one, two and three operands, element by element, by their ONNX names; null if not
/// known here. `size` is the result's.
std::unique_ptr<RowStep> unary_step(const std::string& op_type, RowOperand a, std::size_t size,
                                    int out);
std::unique_ptr<RowStep> binary_step(const std::string& op_type, RowOperand a, RowOperand b,
                                     std::size_t size, int out);
std::unique_ptr<RowStep> where_step(RowOperand condition, RowOperand a, RowOperand b,
                                    std::size_t size, int out);

/// ReduceSum, ReduceMean, ReduceMax, ReduceMin, ReduceSumSquare, ReduceL2 over elements
/// groups[s][·] of a value; null if not known here.
std::unique_ptr<RowStep> reduce_step(const std::string& op_type, int slot,
                                     std::vector<std::vector<std::size_t>> groups, int out);

/// out[m] = Σ_k a[k]·weight[k][m] + bias[m], for each of `columns` stretches of k elements.
/// @param weight (inputs, outputs); bias empty or (outputs).
/// The result's elements are `outputs` a column, without gaps.
std::unique_ptr<RowStep> multiply_step(int slot, std::size_t columns, std::size_t inputs,
                                       std::size_t outputs, const std::vector<double>& weight,
                                       const std::vector<double>& bias, int out);

}  // namespace condyle::surrogate
