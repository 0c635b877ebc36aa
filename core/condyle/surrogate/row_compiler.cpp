// SPDX-License-Identifier: Apache-2.0
#include "condyle/surrogate/row_compiler.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>
#include <utility>

namespace condyle::surrogate {
namespace {

[[noreturn]] void refuse(const OnnxNode& node, const std::string& why) {
  throw UnknownGraph(node.op_type + " that makes " +
                     (node.outputs.empty() ? "nothing" : node.outputs.front()) + ": " + why);
}

const OnnxAttribute* find_attribute(const OnnxNode& node, const std::string& name) {
  for (const OnnxAttribute& attribute : node.attributes) {
    if (attribute.name == name) return &attribute;
  }
  return nullptr;
}

std::int64_t integer_attribute(const OnnxNode& node, const std::string& name,
                               std::int64_t otherwise) {
  const OnnxAttribute* found = find_attribute(node, name);
  return found == nullptr ? otherwise : found->integer;
}

/// A dimension of the tensor with its batch, as one of the row: 1 becomes 0. @p rank is the row's.
std::size_t row_axis(const OnnxNode& node, std::int64_t axis, std::size_t rank) {
  const auto full = static_cast<std::int64_t>(rank) + 1;
  const std::int64_t from_front = axis < 0 ? axis + full : axis;
  if (from_front < 1 || from_front >= full) refuse(node, "works across poses, or out of range");
  return static_cast<std::size_t>(from_front - 1);
}

/// Elements from one index of each dimension to the next, row-major.
std::vector<std::size_t> strides_of(const RowShape& shape) {
  std::vector<std::size_t> strides(shape.size(), 1);
  for (std::size_t d = shape.size(); d-- > 1;) {
    strides[d - 1] = strides[d] * static_cast<std::size_t>(shape[d]);
  }
  return strides;
}

/// Calls visit(position, element number) for each element of a shape, in order.
void for_each_element(const RowShape& shape,
                      const std::function<void(const RowShape&, std::size_t)>& visit) {
  RowShape position(shape.size(), 0);
  const std::size_t count = element_count(shape);
  for (std::size_t s = 0; s < count; ++s) {
    auto rest = static_cast<std::int64_t>(s);
    for (std::size_t d = shape.size(); d-- > 0; rest /= shape[d]) position[d] = rest % shape[d];
    visit(position, s);
  }
}

/// Where each element of `result` finds its own in an array of `shape`, broadcast to it.
std::vector<std::size_t> broadcast_index(const RowShape& shape, const RowShape& result) {
  const std::vector<std::size_t> strides = strides_of(shape);
  const std::size_t missing = result.size() - shape.size();
  std::vector<std::size_t> index(element_count(result));
  for_each_element(result, [&](const RowShape& position, std::size_t s) {
    for (std::size_t d = 0; d < shape.size(); ++d) {
      if (shape[d] > 1) index[s] += strides[d] * static_cast<std::size_t>(position[d + missing]);
    }
  });
  return index;
}

}  // namespace

std::size_t element_count(const RowShape& shape) {
  std::size_t count = 1;
  for (const std::int64_t size : shape) count *= static_cast<std::size_t>(size);
  return count;
}

int RowCompiler::add_value(const std::string& name, const RowShape& shape) {
  constexpr std::size_t kMost = 1 << 16;  // a bound on memory a row, far above any in use
  std::size_t count = 1;
  for (const std::int64_t size : shape) {
    if (size < 1 || size > static_cast<std::int64_t>(kMost))
      throw UnknownGraph(name + ": its size");
    count *= static_cast<std::size_t>(size);
    if (count > kMost) throw UnknownGraph(name + ": its size");
  }
  const int slot = static_cast<int>(sizes_.size());
  if (!values_.emplace(name, Value{slot, shape}).second || constants_.contains(name)) {
    throw UnknownGraph("value " + name + " is made twice");
  }
  sizes_.push_back(count);
  return slot;
}

const RowCompiler::Value* RowCompiler::find(const std::string& name) const {
  const auto found = values_.find(name);
  return found == values_.end() ? nullptr : &found->second;
}

int RowCompiler::slot_of(const std::string& name, const RowShape& shape) const {
  const Value* value = find(name);
  if (value == nullptr || value->shape != shape) {
    throw UnknownGraph("no node makes " + name + " of the contract's shape");
  }
  return value->slot;
}

const RowCompiler::Value& RowCompiler::row_value(const OnnxNode& node, std::size_t input) const {
  const Value* value = input < node.inputs.size() ? find(node.inputs[input]) : nullptr;
  if (value == nullptr)
    refuse(node, "input " + std::to_string(input + 1) + " is no value of a row");
  return *value;
}

const OnnxTensor& RowCompiler::double_constant(const OnnxNode& node, std::size_t input) const {
  const auto found =
      input < node.inputs.size() ? constants_.find(node.inputs[input]) : constants_.end();
  if (found == constants_.end() || found->second.type != "float64") {
    refuse(node, "input " + std::to_string(input + 1) + " is no float64 constant");
  }
  return found->second;
}

const std::vector<std::int64_t>& RowCompiler::integer_constant(const OnnxNode& node,
                                                               std::size_t input) const {
  const auto found =
      input < node.inputs.size() ? constants_.find(node.inputs[input]) : constants_.end();
  if (found == constants_.end() || found->second.type != "int64") {
    refuse(node, "input " + std::to_string(input + 1) + " is no int64 constant");
  }
  return found->second.integers;
}

/// An operand's shape without the batch. Values of a row all have the batch first, so their ranks
/// must be one; a constant may stretch over the batch by a leading 1.
RowShape RowCompiler::operand_shape(const OnnxNode& node, std::size_t input,
                                    std::size_t rank) const {
  if (const Value* value = find(node.inputs[input])) {
    if (value->shape.size() != rank) refuse(node, "operands of different rank");
    return value->shape;
  }
  RowShape shape = double_constant(node, input).shape;
  if (shape.size() == rank + 1 && shape.front() == 1) shape.erase(shape.begin());
  if (shape.size() > rank) refuse(node, "a constant of higher rank");
  return shape;
}

RowShape RowCompiler::broadcast_shape(const OnnxNode& node, std::size_t operands) const {
  if (node.inputs.size() != operands) refuse(node, "another number of inputs");
  std::size_t rank = 0;
  bool any = false;
  for (const std::string& input : node.inputs) {
    if (const Value* value = find(input)) {
      rank = std::max(rank, value->shape.size());
      any = true;
    }
  }
  if (!any) refuse(node, "of constants alone, or of values from elsewhere");
  RowShape result(rank, 1);
  for (std::size_t input = 0; input < operands; ++input) {
    const RowShape shape = operand_shape(node, input, rank);
    for (std::size_t d = 0; d < shape.size(); ++d) {
      std::int64_t& size = result[d + rank - shape.size()];
      if (size != shape[d] && size != 1 && shape[d] != 1) refuse(node, "sizes do not fit");
      size = std::max(size, shape[d]);
    }
  }
  return result;
}

RowOperand RowCompiler::operand(const OnnxNode& node, std::size_t input,
                                const RowShape& result) const {
  const RowShape shape = operand_shape(node, input, result.size());
  std::vector<std::size_t> index = broadcast_index(shape, result);
  RowOperand read;
  if (const Value* value = find(node.inputs[input])) {
    read.slot = value->slot;
    if (shape != result) read.index = std::move(index);
    return read;
  }
  const std::vector<double>& values = double_constant(node, input).doubles;
  for (const std::size_t element : index) read.constants.push_back(values[element]);
  return read;
}

void RowCompiler::add_step(std::unique_ptr<RowStep> step) { steps_.push_back(std::move(step)); }

bool RowCompiler::add_elementwise(const OnnxNode& node) {
  const std::string& op = node.op_type;
  if (!node.attributes.empty()) return false;
  // Whether the operator is known is asked before anything is declared.
  const bool unary = unary_step(op, {}, 0, 0) != nullptr;
  const bool binary = binary_step(op, {}, {}, 0, 0) != nullptr;
  if (!unary && !binary && op != "Where") return false;
  const std::size_t operands = unary ? 1 : binary ? 2 : 3;
  const RowShape shape = broadcast_shape(node, operands);
  const std::size_t size = element_count(shape);
  std::vector<RowOperand> read;
  for (std::size_t i = 0; i < operands; ++i) read.push_back(operand(node, i, shape));
  const int out = add_value(node.outputs.front(), shape);
  if (unary) add_step(unary_step(op, read[0], size, out));
  if (binary) add_step(binary_step(op, read[0], read[1], size, out));
  if (op == "Where") add_step(where_step(read[0], read[1], read[2], size, out));
  return true;
}

void RowCompiler::add_clip(const OnnxNode& node) {
  const Value in = row_value(node, 0);
  const std::size_t size = sizes_[static_cast<std::size_t>(in.slot)];
  const int out = add_value(node.outputs.front(), in.shape);
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const auto bound = [&](std::size_t input, double otherwise) {
    const bool given = input < node.inputs.size() && !node.inputs[input].empty();
    if (given && double_constant(node, input).doubles.size() != 1) refuse(node, "its bounds");
    const double value = given ? double_constant(node, input).doubles.front() : otherwise;
    return RowOperand{-1, std::vector<double>(size, value), {}};
  };
  add_step(binary_step("Max", {in.slot, {}, {}}, bound(1, -kNone), size, out));
  add_step(binary_step("Min", {out, {}, {}}, bound(2, kNone), size, out));
}

void RowCompiler::add_picks(const OnnxNode& node, const RowShape& shape,
                            std::vector<RowPick> picks) {
  const int out = add_value(node.outputs.front(), shape);
  add_step(pick_step(std::move(picks), out));
}

void RowCompiler::add_concat(const OnnxNode& node) {
  RowShape shape = row_value(node, 0).shape;
  const std::size_t axis = row_axis(node, integer_attribute(node, "axis", 0), shape.size());
  shape[axis] = 0;
  std::vector<std::pair<int, std::int64_t>> source;  // slot, and where its part begins
  for (std::size_t i = 0; i < node.inputs.size(); ++i) {
    const Value& value = row_value(node, i);
    RowShape rest = value.shape;
    if (rest.size() != shape.size()) refuse(node, "operands of different rank");
    source.emplace_back(value.slot, shape[axis]);
    const std::int64_t joined = shape[axis] + rest[axis];
    rest[axis] = shape[axis];
    if (rest != shape) refuse(node, "sizes do not fit");
    shape[axis] = joined;
  }
  std::vector<RowPick> picks;
  for_each_element(shape, [&](const RowShape& position, std::size_t) {
    std::size_t i = source.size() - 1;
    while (source[i].second > position[axis]) --i;
    const RowShape& from = row_value(node, i).shape;
    const auto strides = strides_of(from);
    std::size_t element = 0;
    for (std::size_t d = 0; d < position.size(); ++d) {
      const std::int64_t begin = d == axis ? source[i].second : 0;
      element += strides[d] * static_cast<std::size_t>(position[d] - begin);
    }
    picks.push_back({source[i].first, element});
  });
  add_picks(node, shape, std::move(picks));
}

void RowCompiler::add_gather(const OnnxNode& node) {
  const Value in = row_value(node, 0);
  const std::size_t axis = row_axis(node, integer_attribute(node, "axis", 0), in.shape.size());
  const std::vector<std::int64_t>& indices = integer_constant(node, 1);
  const std::size_t index_rank = constants_.at(node.inputs[1]).shape.size();
  if (index_rank > 1) refuse(node, "indices of more than one dimension");
  RowShape shape = in.shape;
  shape[axis] = static_cast<std::int64_t>(indices.size());
  const auto strides = strides_of(in.shape);
  std::vector<RowPick> picks;
  for_each_element(shape, [&](const RowShape& position, std::size_t) {
    std::size_t element = 0;
    for (std::size_t d = 0; d < position.size(); ++d) {
      std::int64_t at = position[d];
      if (d == axis) {
        at = indices[static_cast<std::size_t>(at)];
        if (at < 0) at += in.shape[d];
        if (at < 0 || at >= in.shape[d]) refuse(node, "an index out of range");
      }
      element += strides[d] * static_cast<std::size_t>(at);
    }
    picks.push_back({in.slot, element});
  });
  if (index_rank == 0) shape.erase(shape.begin() + static_cast<std::ptrdiff_t>(axis));
  add_picks(node, shape, std::move(picks));
}

void RowCompiler::add_slice(const OnnxNode& node) {
  const Value in = row_value(node, 0);
  const auto &starts = integer_constant(node, 1), &ends = integer_constant(node, 2);
  const auto& axes = integer_constant(node, 3);
  if (node.inputs.size() > 4) {
    for (const std::int64_t step : integer_constant(node, 4)) {
      if (step != 1) refuse(node, "steps other than 1");
    }
  }
  if (starts.size() != axes.size() || ends.size() != axes.size()) refuse(node, "its axes");
  RowShape shape = in.shape, first(in.shape.size(), 0);
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const std::size_t axis = row_axis(node, axes[i], in.shape.size());
    const std::int64_t size = in.shape[axis];
    const auto bound = [size](std::int64_t at) {
      return std::clamp<std::int64_t>(at < 0 ? at + size : at, 0, size);
    };
    first[axis] = bound(starts[i]);
    shape[axis] = bound(ends[i]) - first[axis];
    if (shape[axis] < 1) refuse(node, "nothing is left");
  }
  const auto strides = strides_of(in.shape);
  std::vector<RowPick> picks;
  for_each_element(shape, [&](const RowShape& position, std::size_t) {
    std::size_t element = 0;
    for (std::size_t d = 0; d < position.size(); ++d) {
      element += strides[d] * static_cast<std::size_t>(position[d] + first[d]);
    }
    picks.push_back({in.slot, element});
  });
  add_picks(node, shape, std::move(picks));
}

namespace {

/// All elements of a value, in order.
std::vector<RowPick> all_elements(int slot, std::size_t count) {
  std::vector<RowPick> picks(count);
  for (std::size_t s = 0; s < count; ++s) picks[s] = {slot, s};
  return picks;
}

}  // namespace

void RowCompiler::add_reshape(const OnnxNode& node) {
  const Value in = row_value(node, 0);
  const auto& asked = integer_constant(node, 1);
  // The batch stays first: -1 or 0 there, and the rest is written out in full.
  if (asked.empty() || asked.front() > 0 || integer_attribute(node, "allowzero", 0) != 0) {
    refuse(node, "does not keep the poses apart");
  }
  const RowShape shape(asked.begin() + 1, asked.end());
  const bool positive = std::all_of(shape.begin(), shape.end(), [](auto n) { return n > 0; });
  if (!positive || element_count(shape) != element_count(in.shape)) {
    refuse(node, "does not keep the poses apart");
  }
  add_picks(node, shape, all_elements(in.slot, element_count(shape)));
}

/// Squeeze and Unsqueeze: dimensions of 1 go or come; the elements stay.
void RowCompiler::add_squeeze(const OnnxNode& node) {
  const Value in = row_value(node, 0);
  const auto& axes = integer_constant(node, 1);
  const bool adds = node.op_type == "Unsqueeze";
  const std::size_t rank = in.shape.size() + (adds ? axes.size() : 0);
  std::vector<bool> named(rank, false);
  for (const std::int64_t axis : axes) named[row_axis(node, axis, rank)] = true;
  RowShape shape;
  for (std::size_t d = 0, from = 0; d < rank; ++d) {
    const std::int64_t size = adds && named[d] ? 1 : in.shape.at(from++);
    if (!adds && named[d] && size != 1) refuse(node, "a dimension that is not 1");
    if (adds || !named[d]) shape.push_back(size);
  }
  add_picks(node, shape, all_elements(in.slot, element_count(shape)));
}

void RowCompiler::add_transpose(const OnnxNode& node) {
  const Value in = row_value(node, 0);
  const OnnxAttribute* order = find_attribute(node, "perm");
  if (order == nullptr || order->integers.size() != in.shape.size() + 1 ||
      order->integers.front() != 0) {
    refuse(node, "does not keep the poses first");
  }
  const auto strides = strides_of(in.shape);
  RowShape shape;
  std::vector<std::size_t> from;
  for (std::size_t d = 1; d < order->integers.size(); ++d) {
    from.push_back(row_axis(node, order->integers[d], in.shape.size()));
    shape.push_back(in.shape[from.back()]);
  }
  std::vector<RowPick> picks;
  for_each_element(shape, [&](const RowShape& position, std::size_t) {
    std::size_t element = 0;
    for (std::size_t d = 0; d < from.size(); ++d) {
      element += strides[from[d]] * static_cast<std::size_t>(position[d]);
    }
    picks.push_back({in.slot, element});
  });
  add_picks(node, shape, std::move(picks));
}

void RowCompiler::add_reduce(const OnnxNode& node) {
  const Value in = row_value(node, 0);
  const OnnxAttribute* attribute = find_attribute(node, "axes");
  // ReduceSum takes its axes as an input, the others of opset 17 as an attribute.
  const auto& axes = attribute != nullptr ? attribute->integers : integer_constant(node, 1);
  const bool keeps = integer_attribute(node, "keepdims", 1) != 0;
  if (axes.empty()) refuse(node, "no axes");
  RowShape kept = in.shape;
  for (const std::int64_t axis : axes) kept[row_axis(node, axis, kept.size())] = 1;
  RowShape shape;
  for (std::size_t d = 0; d < kept.size(); ++d) {
    const bool reduced = std::any_of(axes.begin(), axes.end(), [&](std::int64_t axis) {
      return row_axis(node, axis, kept.size()) == d;
    });
    if (keeps || !reduced) shape.push_back(kept[d]);
  }
  const std::vector<std::size_t> target = broadcast_index(kept, in.shape);
  std::vector<std::vector<std::size_t>> groups(element_count(kept));
  for (std::size_t s = 0; s < target.size(); ++s) groups[target[s]].push_back(s);
  const int out = add_value(node.outputs.front(), shape);
  auto step = reduce_step(node.op_type, in.slot, std::move(groups), out);
  if (step == nullptr) refuse(node, "an operator that is not known here");
  add_step(std::move(step));
}

/// MatMul and Gemm by a constant matrix.
void RowCompiler::add_product(const OnnxNode& node) {
  const Value in = row_value(node, 0);
  const OnnxTensor& weight = double_constant(node, 1);
  const bool gemm = node.op_type == "Gemm";
  if (!node.attributes.empty()) refuse(node, "attributes that are not known here");
  if (weight.shape.size() != 2 || in.shape.empty() || (gemm && in.shape.size() != 1) ||
      in.shape.back() != weight.shape[0]) {
    refuse(node, "sizes do not fit");
  }
  RowShape shape = in.shape;
  shape.back() = weight.shape[1];
  const std::size_t inputs = static_cast<std::size_t>(weight.shape[0]);
  const std::size_t outputs = static_cast<std::size_t>(weight.shape[1]);
  std::vector<double> bias;
  if (gemm && node.inputs.size() > 2) bias = operand(node, 2, shape).constants;
  if (gemm && node.inputs.size() > 2 && bias.size() != outputs) refuse(node, "its bias");
  const int out = add_value(node.outputs.front(), shape);
  const std::size_t columns = element_count(in.shape) / inputs;
  add_step(multiply_step(in.slot, columns, inputs, outputs, weight.doubles, bias, out));
}

bool RowCompiler::add_movement(const OnnxNode& node) {
  using Add = void (RowCompiler::*)(const OnnxNode&);
  static const std::map<std::string, Add> kKnown{
      {"Concat", &RowCompiler::add_concat},       {"Gather", &RowCompiler::add_gather},
      {"Slice", &RowCompiler::add_slice},         {"Reshape", &RowCompiler::add_reshape},
      {"Squeeze", &RowCompiler::add_squeeze},     {"Unsqueeze", &RowCompiler::add_squeeze},
      {"Transpose", &RowCompiler::add_transpose}, {"Clip", &RowCompiler::add_clip},
      {"MatMul", &RowCompiler::add_product},      {"Gemm", &RowCompiler::add_product}};
  const auto found = kKnown.find(node.op_type);
  if (found != kKnown.end()) {
    (this->*found->second)(node);
    return true;
  }
  if (!node.op_type.starts_with("Reduce")) return false;
  add_reduce(node);
  return true;
}

void RowCompiler::add_node(const OnnxNode& node) {
  if (!node.domain.empty() || node.outputs.size() != 1) refuse(node, "not a standard operator");
  if (!add_elementwise(node) && !add_movement(node)) {
    refuse(node, "an operator that is not known here");
  }
}

}  // namespace condyle::surrogate
