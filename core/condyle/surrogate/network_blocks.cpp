// SPDX-License-Identifier: Apache-2.0
#include "condyle/surrogate/network_blocks.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace condyle::surrogate {
namespace {

DenseLayer read_layer(const GraphTemplate& graph, const std::string& net, int index) {
  const OnnxTensor& weight = graph.doubles(numbered(net, "weight", index));
  const OnnxTensor& bias = graph.doubles(numbered(net, "bias", index));
  if (weight.shape.size() != 2 || bias.shape.size() != 1 || bias.shape[0] != weight.shape[1]) {
    throw UnknownGraph(weight.name + " and " + bias.name + " are no layer");
  }
  // Two networks side by side at most.
  constexpr std::int64_t kWidest = 2 * kMaxDenseWidth;
  if (weight.shape[0] > kWidest || weight.shape[1] > kWidest) {
    throw UnknownGraph(weight.name + " is wider than " + std::to_string(kWidest));
  }
  return {static_cast<int>(weight.shape[0]), static_cast<int>(weight.shape[1]), weight.doubles,
          bias.doubles};
}

}  // namespace

std::string numbered(const std::string& net, const char* what, int layer) {
  return net + "." + what + "_" + std::to_string(layer);
}

std::vector<DenseLayer> read_layers(const GraphTemplate& graph, const std::string& net) {
  std::vector<DenseLayer> layers;
  for (int index = 1; graph.has_constant(numbered(net, "weight", index)); ++index) {
    layers.push_back(read_layer(graph, net, index));
  }
  return layers;
}

DenseLayer block(const DenseLayer& layer, int shared, int row, int inputs, int column,
                 int outputs) {
  DenseLayer part{shared + inputs, outputs, {}, {}};
  for (int i = 0; i < shared + inputs; ++i) {
    const int from = i < shared ? i : row + i;
    const auto begin = layer.weight.begin() + std::ptrdiff_t{from} * layer.outputs + column;
    part.weight.insert(part.weight.end(), begin, begin + outputs);
  }
  const auto begin = layer.bias.begin() + column;
  part.bias.assign(begin, begin + outputs);
  return part;
}

bool is_zero(const DenseLayer& layer, int row, int row_end, int column, int column_end) {
  for (int i = row; i < row_end; ++i) {
    for (int j = column; j < column_end; ++j) {
      if (layer.weight[static_cast<std::size_t>(i) * static_cast<std::size_t>(layer.outputs) +
                       static_cast<std::size_t>(j)] != 0.0) {
        return false;
      }
    }
  }
  return true;
}

std::vector<double> rows_of(const DenseLayer& layer, int first, int last) {
  const auto n = static_cast<std::ptrdiff_t>(layer.outputs);
  return {layer.weight.begin() + first * n, layer.weight.begin() + last * n};
}

bool has_output(const OnnxFile& file, const char* name) {
  const auto& outputs = file.signature.outputs;
  return std::any_of(outputs.begin(), outputs.end(),
                     [&](const TensorSignature& output) { return output.name == name; });
}

}  // namespace condyle::surrogate
