// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include "condyle/surrogate/network_blocks.hpp"
#include "surrogate/tiny_surrogate.hpp"

using namespace condyle::surrogate;
using namespace condyle::test;

TEST_CASE("a network's layers are read as far as they go [property]") {
  const OnnxFile file = read_onnx(kTestData / "tiny_potential.onnx");
  const GraphTemplate graph(file);
  const auto layers = read_layers(graph, "energy");
  REQUIRE(layers.size() == 2);
  CHECK(layers[0].inputs == 6);
  CHECK(layers[0].outputs == 14);
  CHECK(layers[1].inputs == 14);
  CHECK(layers[1].outputs == 10);
  CHECK(read_layers(graph, "net_I").empty());
  CHECK(has_output(file, "stiffness"));
  CHECK_FALSE(has_output(file, "stress"));
}

TEST_CASE("a block is its own rows, after the shared ones, and its own columns [oracle]") {
  DenseLayer layer{4, 3, {}, {0.5, 1.5, 2.5}};
  for (int i = 0; i < 12; ++i) layer.weight.push_back(10.0 + i);
  const DenseLayer part = block(layer, 1, 1, 2, 1, 2);
  CHECK(part.inputs == 3);
  CHECK(part.outputs == 2);
  CHECK(part.weight == std::vector{11.0, 12.0, 17.0, 18.0, 20.0, 21.0});
  CHECK(part.bias == std::vector{1.5, 2.5});
  CHECK(rows_of(layer, 1, 2) == std::vector{13.0, 14.0, 15.0});
  CHECK_FALSE(is_zero(layer, 1, 3, 1, 2));
  layer.weight[4] = layer.weight[7] = 0.0;
  CHECK(is_zero(layer, 1, 3, 1, 2));
}

TEST_CASE("constants that are no layer are refused [error]") {
  OnnxFile file = read_onnx(kTestData / "tiny_potential.onnx");
  file.initialisers.at("energy.bias_2").shape = {3};
  const GraphTemplate graph(file);
  CHECK_THROWS_WITH_AS(read_layers(graph, "energy"),
                       "energy.weight_2 and energy.bias_2 are no layer", UnknownGraph);
}
