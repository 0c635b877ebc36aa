// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>
#include <random>
#include <stdexcept>

#include "condyle/surrogate/dense_network.hpp"

using namespace condyle::surrogate;

namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

DenseLayer layer(int inputs, int outputs, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> uniform(-0.6, 0.6);
  DenseLayer made{inputs, outputs, {}, {}};
  for (int i = 0; i < inputs * outputs; ++i) made.weight.push_back(uniform(generator));
  for (int i = 0; i < outputs; ++i) made.bias.push_back(uniform(generator));
  return made;
}

std::vector<DenseLayer> general_layers() {
  return {layer(5, 11, 1), layer(11, 30, 2), layer(30, 3, 3)};
}

/// The network by Eigen, one pose.
Eigen::VectorXd by_eigen(const std::vector<DenseLayer>& layers, Eigen::VectorXd x) {
  for (std::size_t l = 0; l < layers.size(); ++l) {
    const DenseLayer& one = layers[l];
    const Eigen::Map<const RowMajor> weight(one.weight.data(), one.inputs, one.outputs);
    x = (weight.transpose() * x + Eigen::Map<const Eigen::VectorXd>(one.bias.data(), one.outputs))
            .eval();
    if (l + 1 < layers.size()) x = x.array().tanh().matrix().eval();
  }
  return x;
}

}  // namespace

TEST_CASE("values and derivatives are those of the formula, by each instruction set [derivative]") {
  const auto layers = general_layers();
  const DenseNetwork network(layers);
  CHECK(network.inputs() == 5);
  CHECK(network.outputs() == 3);
  CHECK(network.hidden_layers() == 2);
  for (const DenseKernels& kernels : all_dense_kernels()) {
    CAPTURE(kernels.instruction_set);
    DenseWorkspace workspace;
    // Two poses, each with a value and six directions.
    std::vector<Eigen::VectorXd> columns;
    for (int c = 0; c < 2 * kPoseColumns; ++c) {
      const DenseLayer random = layer(1, 5, 40 + static_cast<std::uint64_t>(c));
      columns.push_back(Eigen::Map<const Eigen::VectorXd>(random.bias.data(), 5));
      std::copy_n(random.bias.data(), 5, workspace.a.data() + c * network.stride());
    }
    const double* out = network.evaluate(kernels, workspace, 2 * kPoseColumns, true);
    for (int c = 0; c < 2 * kPoseColumns; ++c) {
      const Eigen::Map<const Eigen::Vector3d> found(out + c * network.stride());
      const Eigen::VectorXd& value =
          columns[static_cast<std::size_t>(c / kPoseColumns * kPoseColumns)];
      if (c % kPoseColumns == 0) {
        CHECK((found - by_eigen(layers, value)).norm() <= 1e-13);
        continue;
      }
      // Central differences: truncation h²·f'''/6 ~ 1e-9 at h = 1e-4.
      const Eigen::VectorXd step = 1e-4 * columns[static_cast<std::size_t>(c)];
      const Eigen::VectorXd difference =
          (by_eigen(layers, value + step) - by_eigen(layers, value - step)) / 2e-4;
      CHECK(difference.norm() > 1e-3);
      CHECK((found - difference).norm() <= 1e-8);
    }
  }
}

TEST_CASE("layers that do not fit are refused [error]") {
  CHECK_THROWS_WITH_AS(DenseNetwork({layer(5, 7, 1), layer(8, 2, 2)}),
                       "layer 2: 8 inputs and 2 outputs after 7 outputs", std::invalid_argument);
  CHECK_THROWS_WITH_AS(DenseNetwork({layer(5, 129, 1)}), "layer 1: 129 neurons: at most 128",
                       std::invalid_argument);
  CHECK_THROWS_AS(DenseNetwork(std::vector<DenseLayer>{}), std::invalid_argument);
  auto damaged = layer(5, 7, 1);
  damaged.weight[3] = std::nan("");
  CHECK_THROWS_WITH_AS(DenseNetwork({damaged}), "layer 1: a weight is not finite",
                       std::invalid_argument);
  damaged = layer(5, 7, 1);
  damaged.bias.pop_back();
  CHECK_THROWS_WITH_AS(DenseNetwork({damaged}), "layer 1: 35 weights and 6 biases",
                       std::invalid_argument);
}
