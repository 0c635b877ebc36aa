// SPDX-License-Identifier: Apache-2.0
#include "condyle/surrogate/dense_network.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>

namespace condyle::surrogate {
namespace {

int rounded_up(int width) { return (width + kDenseStep - 1) / kDenseStep * kDenseStep; }

bool all_finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); });
}

void require_sizes(const DenseLayer& layer, int inputs, const std::string& name) {
  if (layer.inputs < 1 || layer.outputs < 1 || (inputs != 0 && layer.inputs != inputs)) {
    throw std::invalid_argument(name + ": " + std::to_string(layer.inputs) + " inputs and " +
                                std::to_string(layer.outputs) + " outputs after " +
                                std::to_string(inputs) + " outputs");
  }
  if (std::max(layer.inputs, layer.outputs) > kMaxDenseWidth) {
    throw std::invalid_argument(name + ": " +
                                std::to_string(std::max(layer.inputs, layer.outputs)) +
                                " neurons: at most " + std::to_string(kMaxDenseWidth));
  }
  const auto n_in = static_cast<std::size_t>(layer.inputs);
  const auto n_out = static_cast<std::size_t>(layer.outputs);
  if (layer.weight.size() != n_in * n_out || layer.bias.size() != n_out) {
    throw std::invalid_argument(name + ": " + std::to_string(layer.weight.size()) +
                                " weights and " + std::to_string(layer.bias.size()) + " biases");
  }
  if (!all_finite(layer.weight) || !all_finite(layer.bias)) {
    throw std::invalid_argument(name + ": a weight is not finite");
  }
}

}  // namespace

DenseNetwork::DenseNetwork(const std::vector<DenseLayer>& layers) {
  if (layers.empty()) throw std::invalid_argument("network: no layers");
  for (const DenseLayer& layer : layers) {
    require_sizes(layer, outputs_, "layer " + std::to_string(layers_.size() + 1));
    Layer padded{layer.inputs, rounded_up(layer.outputs), {}, layer.bias};
    const auto n_out = static_cast<std::size_t>(layer.outputs);
    const auto width = static_cast<std::size_t>(padded.width);
    padded.bias.resize(width);
    padded.weight.resize(static_cast<std::size_t>(layer.inputs) * width);
    for (std::size_t i = 0; i < static_cast<std::size_t>(layer.inputs); ++i) {
      std::copy_n(&layer.weight[i * n_out], n_out, &padded.weight[i * width]);
    }
    if (layers_.empty()) inputs_ = layer.inputs;
    outputs_ = layer.outputs;
    stride_ = std::max({stride_, padded.width, rounded_up(layer.inputs)});
    layers_.push_back(std::move(padded));
  }
}

const double* DenseNetwork::evaluate(const DenseKernels& kernels, DenseWorkspace& workspace,
                                     int columns, bool derivatives) const {
  double* in = workspace.a.data();
  double* out = workspace.b.data();
  for (const Layer& layer : layers_) {
    kernels.multiply(layer.weight.data(), layer.inputs, layer.width, in, stride_, columns, out,
                     stride_);
    if (&layer == &layers_.back()) break;
    const auto activate = derivatives ? kernels.tanh_with_derivatives : kernels.tanh;
    activate(layer.bias.data(), layer.width, out, stride_, columns);
    std::swap(in, out);
  }
  const std::vector<double>& bias = layers_.back().bias;
  for (int c = 0; c < columns; c += derivatives ? kPoseColumns : 1) {
    double* column = out + c * stride_;
    for (int j = 0; j < outputs_; ++j) column[j] += bias[static_cast<std::size_t>(j)];
  }
  return out;
}

}  // namespace condyle::surrogate
