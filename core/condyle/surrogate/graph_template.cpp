// SPDX-License-Identifier: Apache-2.0
#include "condyle/surrogate/graph_template.hpp"

#include <algorithm>

namespace condyle::surrogate {
namespace {

constexpr std::int64_t kOpset = 17;
// AttributeProto.AttributeType
constexpr int kInteger = 2;
constexpr int kIntegers = 7;

std::vector<OnnxAttribute> sorted(std::vector<OnnxAttribute> attributes) {
  std::sort(attributes.begin(), attributes.end(),
            [](const auto& a, const auto& b) { return a.name < b.name; });
  return attributes;
}

}  // namespace

GraphTemplate::GraphTemplate(const OnnxFile& file) : file_(file) {
  if (!file.beyond.empty()) throw UnknownGraph("the file has " + file.beyond);
  const auto opset = file.opsets.find("");
  if (opset == file.opsets.end() || opset->second != kOpset) {
    throw UnknownGraph("its operators are not those of opset " + std::to_string(kOpset));
  }
  for (const OnnxNode& node : file.nodes) {
    for (const std::string& output : node.outputs) {
      const bool is_input =
          std::any_of(file.signature.inputs.begin(), file.signature.inputs.end(),
                      [&](const TensorSignature& input) { return input.name == output; });
      if (is_input || file.initialisers.contains(output) || !maker_.emplace(output, &node).second) {
        throw UnknownGraph("value " + output + " is made twice");
      }
    }
  }
}

void GraphTemplate::expect(const std::string& op_type, const std::vector<std::string>& inputs,
                           const std::string& output,
                           const std::vector<OnnxAttribute>& attributes) {
  const auto found = maker_.find(output);
  if (found == maker_.end()) throw UnknownGraph("no node makes " + output);
  const OnnxNode& node = *found->second;
  if (node.op_type != op_type || !node.domain.empty()) {
    throw UnknownGraph(output + " is made by " + node.op_type + ", not " + op_type);
  }
  if (node.inputs != inputs || node.outputs.size() != 1) {
    throw UnknownGraph("the inputs of " + output + " are others");
  }
  if (sorted(node.attributes) != sorted(attributes)) {
    throw UnknownGraph("the attributes of " + output + " are others");
  }
  matched_.insert(&node);
}

bool GraphTemplate::has_constant(const std::string& name) const {
  return file_.initialisers.contains(name);
}

const OnnxTensor& GraphTemplate::doubles(const std::string& name) const {
  const auto found = file_.initialisers.find(name);
  if (found == file_.initialisers.end() || found->second.type != "float64") {
    throw UnknownGraph("there is no float64 constant " + name);
  }
  return found->second;
}

const OnnxTensor& GraphTemplate::integers(const std::string& name) const {
  const auto found = file_.initialisers.find(name);
  if (found == file_.initialisers.end() || found->second.type != "int64") {
    throw UnknownGraph("there is no int64 constant " + name);
  }
  return found->second;
}

void GraphTemplate::expect_doubles(const std::string& name, const std::vector<std::int64_t>& shape,
                                   const std::vector<double>& values) const {
  const OnnxTensor& tensor = doubles(name);
  if (tensor.shape != shape || tensor.doubles != values) {
    throw UnknownGraph("constant " + name + " is not what it has to be");
  }
}

void GraphTemplate::expect_number(const std::string& name, double value) const {
  const OnnxTensor& tensor = doubles(name);
  if (tensor.shape.size() > 1 || tensor.doubles != std::vector{value}) {
    throw UnknownGraph("constant " + name + " is not what it has to be");
  }
}

void GraphTemplate::expect_integers(const std::string& name,
                                    const std::vector<std::int64_t>& values) const {
  const OnnxTensor& tensor = integers(name);
  if (tensor.shape.size() != 1 || tensor.integers != values) {
    throw UnknownGraph("constant " + name + " is not what it has to be");
  }
}

std::vector<const OnnxNode*> GraphTemplate::rest() const {
  std::vector<const OnnxNode*> nodes;
  for (const OnnxNode& node : file_.nodes) {
    if (!matched_.contains(&node)) nodes.push_back(&node);
  }
  return nodes;
}

OnnxAttribute GraphTemplate::integer_attribute(const std::string& name, std::int64_t value) {
  return {.name = name, .kind = kInteger, .number = 0.0, .integer = value, .integers = {}};
}

OnnxAttribute GraphTemplate::integers_attribute(const std::string& name,
                                                const std::vector<std::int64_t>& values) {
  return {.name = name, .kind = kIntegers, .number = 0.0, .integer = 0, .integers = values};
}

}  // namespace condyle::surrogate
