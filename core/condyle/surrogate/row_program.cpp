// SPDX-License-Identifier: Apache-2.0
#include "condyle/surrogate/row_program.hpp"

#include <algorithm>
#include <utility>

#include "condyle/surrogate/row_compiler.hpp"

namespace condyle::surrogate {
namespace {

/// A thread's memory for programs, one run at a time; it grows to the largest program and stays.
struct Scratch {
  std::vector<double> memory;
  std::vector<RowSpan> spans;
};

Scratch& scratch() {
  thread_local Scratch mine;
  return mine;
}

}  // namespace

struct RowProgram::Impl {
  std::vector<std::size_t> sizes;  // of slots; the inputs come first
  std::vector<int> outputs;
  std::vector<std::unique_ptr<RowStep>> steps;
  std::size_t total = 0;
};

RowProgram::RowProgram(const std::vector<const OnnxNode*>& nodes,
                       const std::map<std::string, OnnxTensor>& constants,
                       const std::vector<Value>& inputs, const std::vector<Value>& outputs)
    : impl_(std::make_unique<Impl>()) {
  RowCompiler compiler(constants);
  for (const Value& input : inputs) compiler.add_value(input.name, input.shape);
  for (const OnnxNode* node : nodes) compiler.add_node(*node);
  for (const Value& output : outputs) {
    impl_->outputs.push_back(compiler.slot_of(output.name, output.shape));
  }
  impl_->sizes = compiler.sizes();
  impl_->steps = compiler.take_steps();
  for (const std::size_t size : impl_->sizes) impl_->total += size;
}

RowProgram::~RowProgram() = default;
RowProgram::RowProgram(RowProgram&&) noexcept = default;
RowProgram& RowProgram::operator=(RowProgram&&) noexcept = default;

void RowProgram::run(std::size_t rows, std::span<const double* const> inputs,
                     std::span<double* const> outputs) const {
  Scratch& mine = scratch();
  const Impl& program = *impl_;
  if (mine.memory.size() < program.total * kMaxRows) mine.memory.resize(program.total * kMaxRows);
  mine.spans.resize(std::max(mine.spans.size(), program.sizes.size()));
  double* at = mine.memory.data();
  for (std::size_t slot = 0; slot < program.sizes.size(); ++slot) {
    mine.spans[slot] = {at, program.sizes[slot]};
    if (slot < inputs.size()) std::copy_n(inputs[slot], rows * program.sizes[slot], at);
    at += rows * program.sizes[slot];
  }
  for (const auto& step : program.steps) step->run(rows, mine.spans);
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    if (outputs[i] == nullptr) continue;
    const auto slot = static_cast<std::size_t>(program.outputs[i]);
    std::copy_n(mine.spans[slot].data, rows * program.sizes[slot], outputs[i]);
  }
}

}  // namespace condyle::surrogate
