// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include "condyle/surrogate/potential_graph.hpp"
#include "surrogate/tiny_surrogate.hpp"

using namespace condyle::surrogate;
using namespace condyle::test;

namespace {

OnnxFile full_file() { return read_onnx(kTestData / "tiny_potential.onnx"); }

template <typename Change>
std::string refusal(const Change& change) {
  OnnxFile file = full_file();
  change(file);
  try {
    GraphTemplate graph(file);
    match_potential(graph);
  } catch (const UnknownGraph& unknown) {
    return unknown.what();
  }
  return "accepted";
}

OnnxNode& maker_of(OnnxFile& file, const std::string& output) {
  for (OnnxNode& node : file.nodes) {
    if (node.outputs.front() == output) return node;
  }
  throw std::logic_error("no node makes " + output);
}

}  // namespace

TEST_CASE("the energies' nodes are matched, those of error and trust are left [property]") {
  const OnnxFile file = full_file();
  GraphTemplate graph(file);
  CHECK(resembles_potential(graph));
  const auto networks = match_potential(graph);
  CHECK(networks->max_poses(true) > 4);
  CHECK(!graph.rest().empty());
  CHECK(graph.rest().size() < file.nodes.size() / 3);
  for (const OnnxNode* node : graph.rest()) {
    for (const std::string& input : node->inputs) CHECK(!input.starts_with("energy"));
  }
}

TEST_CASE("a wrench-only graph of energies is matched whole [property]") {
  const OnnxFile file = read_onnx(kTestData / "tiny_potential_wrench.onnx");
  GraphTemplate graph(file);
  match_potential(graph);
  CHECK(graph.rest().empty());
  const OnnxFile other = read_onnx(kTestData / "tiny_two_stage.onnx");
  CHECK_FALSE(resembles_potential(GraphTemplate(other)));
}

TEST_CASE("a graph that is not exactly an energy's is refused, with the place [error]") {
  const auto constant = [](const char* name, std::size_t at, double change) {
    return refusal([&](OnnxFile& f) { f.initialisers.at(name).doubles.at(at) += change; });
  };
  CHECK(refusal([](OnnxFile&) {}) == "accepted");
  for (const char* name : {"energy.last_row", "energy.first_pairs", "energy.constant_pairs",
                           "energy.pose_tangent", "energy.bend_of_side", "energy.angle_columns",
                           "angle.multiples", "angle.phases", "turn.weight", "turns.bias"}) {
    CHECK(constant(name, 3, 1e-9) == std::string("constant ") + name + " is not what it has to be");
  }
  CHECK(constant("energy.curve_factor", 1, 1e-9) ==
        "constant energy.curve_factor is not what it has to be");
  CHECK(constant("energy.steepness", 2, 1e-9) ==
        "constant energy.last_weight is not what it has to be");
  // From a medial neuron to a lateral one: row 2, column 8 of ten.
  CHECK(constant("energy.weight_2", 28, 1e-9) == "energy is not two networks side by side");
  CHECK(refusal([](OnnxFile& f) { maker_of(f, "energy.back_1").attributes.clear(); }) ==
        "the attributes of energy.back_1 are others");
  CHECK(refusal([](OnnxFile& f) { maker_of(f, "sines").op_type = "Cos"; }) ==
        "sines is made by Cos, not Sin");
  CHECK(refusal([](OnnxFile& f) { maker_of(f, "energy.bend").inputs[1] = "energy.steepness"; }) ==
        "the inputs of energy.bend are others");
  CHECK(refusal([](OnnxFile& f) {
          for (double& q : f.initialisers.at("energy.exponent").doubles) q = 0.0;
          const auto& force = f.initialisers.at("energy.force_factor").doubles;
          f.initialisers.at("energy.curve_factor").doubles = force;
        }) == "potential surrogate: exponent 0.000000 must be positive");
}
