// SPDX-License-Identifier: Apache-2.0
// A small evaluator of the part of a surrogate's graph that judges a pose: `error` and `trust` from
// `pose` and `wrench`. Each row (pose) by itself, so that what a node does to one row is worked out
// once, when the file is read: broadcasting, slices and reshapes become lists of elements.
//
// Known operators, all on float64 and with the batch as their first dimension: Abs, Add, And, Clip,
// Concat, Div, Exp, Gather, Gemm, Greater(OrEqual), Identity, Less(OrEqual), Log, MatMul (by a
// constant), Max, Min, Mul, Neg, Not, Or, Pow, Reciprocal, Reduce(L2, Max, Mean, Min, Sum,
// SumSquare), Relu, Reshape, Sigmoid, Slice, Sqrt, Squeeze, Sub, Tanh, Transpose, Unsqueeze, Where.
// Semantics are those of the standard's opset 17. What is not known is refused, never guessed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "condyle/surrogate/graph_template.hpp"

namespace condyle::surrogate {

/// Thread safety: run() is const and may be called from many threads at once.
class RowProgram {
 public:
  /// Rows that one run takes at most.
  static constexpr std::size_t kMaxRows = 28;

  /// A value that comes from outside: its name, and its shape after the batch.
  struct Value {
    std::string name;
    std::vector<std::int64_t> shape;
  };

  /// @param nodes in an order in which each reads what came before.
  /// @throws UnknownGraph naming the node and what is not known of it.
  RowProgram(const std::vector<const OnnxNode*>& nodes,
             const std::map<std::string, OnnxTensor>& constants, const std::vector<Value>& inputs,
             const std::vector<Value>& outputs);
  ~RowProgram();
  RowProgram(RowProgram&&) noexcept;
  RowProgram& operator=(RowProgram&&) noexcept;

  /// @param inputs, outputs (rows, size) row-major, in the constructor's order; an output that is
  ///   null is not written.
  /// @pre rows ≤ kMaxRows. Allocates on a thread's first run only.
  void run(std::size_t rows, std::span<const double* const> inputs,
           std::span<double* const> outputs) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace condyle::surrogate
