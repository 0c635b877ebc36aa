// SPDX-License-Identifier: Apache-2.0
// Departures of the graph: test_fused_surrogate.cpp.
#include <doctest/doctest.h>

#include "condyle/surrogate/two_stage_graph.hpp"
#include "surrogate/tiny_surrogate.hpp"

using namespace condyle::surrogate;
using namespace condyle::test;

TEST_CASE("the networks' nodes are matched, those of error and trust are left [property]") {
  const OnnxFile file = read_onnx(kTestData / "tiny_two_stage.onnx");
  GraphTemplate graph(file);
  const auto networks = match_two_stage(graph);
  CHECK(networks->max_poses(true) == 4);
  CHECK(!graph.rest().empty());
  CHECK(graph.rest().size() < file.nodes.size() / 2);
  for (const OnnxNode* node : graph.rest()) {
    for (const std::string& input : node->inputs) CHECK(!input.starts_with("net_"));
  }
}

TEST_CASE("a wrench-only graph is matched whole [property]") {
  const OnnxFile file = read_onnx(kTestData / "tiny_two_stage_wrench.onnx");
  GraphTemplate graph(file);
  match_two_stage(graph);
  CHECK(graph.rest().empty());
}
