// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

#include "condyle/surrogate/two_stage.hpp"
#include "support/random_pose.hpp"

using namespace condyle::surrogate;
using condyle::kSides;
using condyle::Pose;
using condyle::test::Draw;

namespace {

DenseLayer layer(Draw& draw, int inputs, int outputs, double range) {
  DenseLayer made{inputs, outputs, {}, {}};
  for (int i = 0; i < inputs * outputs; ++i) made.weight.push_back(draw(-range, range));
  for (int i = 0; i < outputs; ++i) made.bias.push_back(draw(-range, range));
  return made;
}

std::vector<DenseLayer> layers(Draw& draw, int inputs, int outputs) {
  return {layer(draw, inputs, 9, 0.7), layer(draw, 9, outputs, 40.0)};
}

/// A network written out in full.
std::vector<double> outputs_of(const std::vector<DenseLayer>& net, std::vector<double> x) {
  for (const DenseLayer& one : net) {
    std::vector<double> y = one.bias;
    for (int i = 0; i < one.inputs; ++i) {
      for (int j = 0; j < one.outputs; ++j) {
        y[static_cast<std::size_t>(j)] += x[static_cast<std::size_t>(i)] *
                                          one.weight[static_cast<std::size_t>(i * one.outputs + j)];
      }
    }
    if (&one != &net.back()) {
      for (double& value : y) value = std::tanh(value);
    }
    x = y;
  }
  return x;
}

}  // namespace

TEST_CASE("loads are those of the three nets, gated by side [oracle]") {
  Draw draw(13);
  const auto first = layers(draw, 6, 4);
  const std::array second{layers(draw, 8, 4), layers(draw, 8, 4)};
  for (const DenseKernels& kernels : all_dense_kernels()) {
    const TwoStage networks(DenseNetwork(first), {DenseNetwork(second[0]), DenseNetwork(second[1])},
                            kernels);
    std::vector<Pose> poses(networks.max_poses(false));
    for (Pose& pose : poses) {
      for (int i = 0; i < 6; ++i) pose[i] = draw(-1.5, 1.5);
    }
    DenseWorkspace workspace;
    std::vector<double> wrench(12 * poses.size(), -7.0);
    networks.evaluate(poses, workspace, wrench.data(), nullptr);
    int open = 0, shut = 0;
    for (std::size_t n = 0; n < poses.size(); ++n) {
      const std::vector<double> pose(poses[n].begin(), poses[n].end());
      const auto loads = outputs_of(first, pose);
      for (std::size_t side = 0; side < 2; ++side) {
        const double fy = loads[2 * side], mx = loads[2 * side + 1];
        auto inputs = pose;
        inputs.insert(inputs.end(), {fy, mx});
        const auto rest = outputs_of(second[side], inputs);
        std::vector<double> expected{rest[0], fy, rest[1], mx, rest[2], rest[3]};
        if (fy <= 0.0) expected.assign(6, 0.0);
        ++(fy <= 0.0 ? shut : open);
        for (std::size_t i = 0; i < 6; ++i) {
          // Loads of a few hundred, from sums of nine products.
          CHECK(std::abs(wrench[12 * n + 6 * side + i] - expected[i]) <= 1e-11);
        }
      }
    }
    CHECK(open > 8);
    CHECK(shut > 8);
  }
}

TEST_CASE("networks of other sizes are refused [error]") {
  Draw draw(4);
  const DenseNetwork first(layers(draw, 6, 4)), second(layers(draw, 8, 4));
  CHECK_NOTHROW(TwoStage(first, {second, second}));
  CHECK_THROWS_WITH_AS(TwoStage(first, {second, first}),
                       "two-stage surrogate: the networks must be 6 to 4, 8 to 4, 8 to 4",
                       std::invalid_argument);
}
