// SPDX-License-Identifier: Apache-2.0
// Nodes of an ONNX graph made into the steps of a row program (row_program.hpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "condyle/surrogate/graph_template.hpp"
#include "condyle/surrogate/row_operators.hpp"

namespace condyle::surrogate {

using RowShape = std::vector<std::int64_t>;

/// Number of elements; 1 for a scalar.
std::size_t element_count(const RowShape& shape);

class RowCompiler {
 public:
  /// @pre constants outlive this object.
  explicit RowCompiler(const std::map<std::string, OnnxTensor>& constants)
      : constants_(constants) {}

  /// Declares a value of every row; `shape` is without the batch. @return its slot.
  int add_value(const std::string& name, const RowShape& shape);

  /// Adds a node's step. @throws UnknownGraph naming the node and what is not known of it.
  void add_node(const OnnxNode& node);

  /// The slot of a value. @throws UnknownGraph if there is none of the name and shape.
  int slot_of(const std::string& name, const RowShape& shape) const;

  /// Elements of each slot, in order.
  const std::vector<std::size_t>& sizes() const { return sizes_; }
  std::vector<std::unique_ptr<RowStep>> take_steps() { return std::move(steps_); }

 private:
  struct Value {
    int slot = 0;
    RowShape shape;
  };

  const Value* find(const std::string& name) const;
  const Value& row_value(const OnnxNode& node, std::size_t input) const;
  const OnnxTensor& double_constant(const OnnxNode& node, std::size_t input) const;
  const std::vector<std::int64_t>& integer_constant(const OnnxNode& node, std::size_t input) const;

  RowShape operand_shape(const OnnxNode& node, std::size_t input, std::size_t rank) const;
  RowShape broadcast_shape(const OnnxNode& node, std::size_t operands) const;
  RowOperand operand(const OnnxNode& node, std::size_t input, const RowShape& result) const;

  bool add_elementwise(const OnnxNode& node);
  bool add_movement(const OnnxNode& node);
  void add_clip(const OnnxNode& node);
  void add_concat(const OnnxNode& node);
  void add_gather(const OnnxNode& node);
  void add_slice(const OnnxNode& node);
  void add_reshape(const OnnxNode& node);
  void add_squeeze(const OnnxNode& node);
  void add_transpose(const OnnxNode& node);
  void add_reduce(const OnnxNode& node);
  void add_product(const OnnxNode& node);
  void add_picks(const OnnxNode& node, const RowShape& shape, std::vector<RowPick> picks);
  void add_step(std::unique_ptr<RowStep> step);

  const std::map<std::string, OnnxTensor>& constants_;
  std::map<std::string, Value> values_;
  std::vector<std::size_t> sizes_;
  std::vector<std::unique_ptr<RowStep>> steps_;
};

}  // namespace condyle::surrogate
