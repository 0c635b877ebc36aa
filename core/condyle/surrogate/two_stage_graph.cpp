// SPDX-License-Identifier: Apache-2.0
// The counterpart of add_two_stage() in python/condyle/training/onnx_two_stage.py, node by node.
// Nets II and III stand there as one network of block-diagonal weights: they are taken apart here,
// and the blocks between them must be zero.
#include "condyle/surrogate/two_stage_graph.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "condyle/surrogate/network_blocks.hpp"

namespace condyle::surrogate {
namespace {

constexpr int kPose = 6;
constexpr int kFirst = 2;   // Fy, Mx of a side
constexpr int kSecond = 4;  // Fx, Fz, My, Mz

std::vector<DenseLayer> read_network(const GraphTemplate& graph, const std::string& net) {
  std::vector<DenseLayer> layers = read_layers(graph, net);
  if (layers.size() < 2) throw UnknownGraph("there is no network " + net + " with hidden layers");
  return layers;
}

/// The nodes of a network that reads `inputs` and, with a seed, the derivative of its first sums.
/// @return the names of its outputs and of their derivatives.
std::pair<std::string, std::string> expect_network(GraphTemplate& graph, const std::string& net,
                                                   int layers, const std::string& inputs,
                                                   const std::string& seed) {
  std::string hidden = inputs, tangent = seed;
  for (int l = 1;; ++l) {
    const std::string weight = numbered(net, "weight", l), sums = numbered(net, "sums", l);
    graph.expect("Gemm", {hidden, weight, numbered(net, "bias", l)}, sums);
    if (!seed.empty() && l > 1) {
      const std::string d_sums = numbered(net, "sums_tangent", l);
      graph.expect("MatMul", {tangent, weight}, d_sums);
      tangent = d_sums;
    }
    if (l == layers) return {sums, tangent};
    hidden = numbered(net, "hidden", l);
    graph.expect("Tanh", {sums}, hidden);
    if (seed.empty()) continue;
    const std::string square = numbered(net, "square", l), slope = numbered(net, "slope", l);
    graph.expect("Mul", {hidden, hidden}, square);
    graph.expect("Sub", {"one", square}, slope);
    graph.expect("Mul", {tangent, slope}, numbered(net, "tangent", l));
    tangent = numbered(net, "tangent", l);
  }
}

/// Where each of 2 × 6 loads stands among the outputs of nets I, II and III.
constexpr std::array<std::int64_t, 12> kLoadOrder{4, 0, 5, 1, 6, 7, 8, 2, 9, 3, 10, 11};

void expect_wrench(GraphTemplate& graph, const std::string& first, const std::string& second) {
  const auto axis = [](std::int64_t value) {
    return std::vector{GraphTemplate::integer_attribute("axis", value)};
  };
  graph.expect_integers("load_order", {kLoadOrder.begin(), kLoadOrder.end()});
  graph.expect_integers("wrench.shape", {-1, 2, 6});
  graph.expect_integers("Fy.columns", {0, kFirst});
  graph.expect_integers("axis_2", {2});
  graph.expect_number("zero", 0.0);
  graph.expect("Concat", {first, second}, "loads", axis(1));
  graph.expect("Gather", {"loads", "load_order"}, "ordered_loads", axis(1));
  graph.expect("Reshape", {"ordered_loads", "wrench.shape"}, "ungated_wrench");
  graph.expect("Gather", {first, "Fy.columns"}, "ungated_Fy", axis(1));
  graph.expect("LessOrEqual", {"ungated_Fy", "zero"}, "lifted_side");
  graph.expect("Unsqueeze", {"lifted_side", "axis_2"}, "lifted");
  graph.expect("Where", {"lifted", "zero", "ungated_wrench"}, "wrench");
}

void expect_stiffness(GraphTemplate& graph, const std::string& first, const std::string& second) {
  graph.expect_integers("stiffness.shape", {-1, 2, 6, 6});
  graph.expect_integers("axis_3", {3});
  graph.expect("Concat", {first, second}, "load_tangents",
               {GraphTemplate::integer_attribute("axis", 2)});
  graph.expect("Transpose", {"load_tangents"}, "row_tangents",
               {GraphTemplate::integers_attribute("perm", {1, 2, 0})});
  graph.expect("Gather", {"row_tangents", "load_order"}, "ordered_tangents",
               {GraphTemplate::integer_attribute("axis", 1)});
  graph.expect("Reshape", {"ordered_tangents", "stiffness.shape"}, "ungated_stiffness");
  graph.expect("Unsqueeze", {"lifted", "axis_3"}, "lifted_rows");
  graph.expect("Where", {"lifted_rows", "zero", "ungated_stiffness"}, "stiffness");
}

/// Nets II and III out of the one that holds them side by side.
std::array<std::vector<DenseLayer>, kSides> take_apart(const std::vector<DenseLayer>& joined) {
  std::array<std::vector<DenseLayer>, kSides> nets;
  int border = kFirst;  // inputs of the medial net, shared ones apart
  for (const DenseLayer& layer : joined) {
    const bool is_first = &layer == &joined.front(), is_last = &layer == &joined.back();
    const int shared = is_first ? kPose : 0;
    const int split = shared + border, n_out = layer.outputs;
    // The medial net's neurons end with the last that reads one of its inputs.
    int medial = is_last ? kSecond : n_out - 1;
    while (!is_last && medial > 1 && is_zero(layer, shared, split, medial - 1, medial)) --medial;
    if (layer.inputs <= split || !is_zero(layer, shared, split, medial, n_out) ||
        !is_zero(layer, split, layer.inputs, 0, medial)) {
      throw UnknownGraph("net_II_III is not two networks side by side");
    }
    nets[kMedial].push_back(block(layer, shared, 0, border, 0, medial));
    nets[kLateral].push_back(
        block(layer, shared, border, layer.inputs - split, medial, n_out - medial));
    border = medial;
  }
  return nets;
}

DenseNetwork network(const std::vector<DenseLayer>& layers, const char* name) {
  try {
    return DenseNetwork(layers);
  } catch (const std::invalid_argument& error) {
    throw UnknownGraph(std::string(name) + ": " + error.what());
  }
}

}  // namespace

std::unique_ptr<TwoStage> match_two_stage(GraphTemplate& graph) {
  const bool stiffness = has_output(graph.file(), "stiffness");
  const std::vector<DenseLayer> first = read_network(graph, "net_I");
  const std::vector<DenseLayer> joined = read_network(graph, "net_II_III");
  const DenseLayer& entry = joined.front();
  if (first.front().inputs != kPose || first.back().outputs != kSides * kFirst ||
      entry.inputs != kPose + kSides * kFirst || joined.back().outputs != kSides * kSecond) {
    throw UnknownGraph("the networks' inputs and outputs are not those of two stages");
  }

  std::string seed;
  if (stiffness) {
    graph.expect_number("one", 1.0);
    seed = "net_I.pose_tangent";
    graph.expect_doubles(seed, {kPose, 1, first.front().outputs}, first.front().weight);
  }
  const auto [loads, d_loads] =
      expect_network(graph, "net_I", static_cast<int>(first.size()), "pose", seed);
  graph.expect("Concat", {"pose", loads}, "net_II_III.inputs",
               {GraphTemplate::integer_attribute("axis", 1)});
  if (stiffness) {
    seed = "net_II_III.seed";
    graph.expect_doubles("net_II_III.pose_tangent", {kPose, 1, entry.outputs},
                         rows_of(entry, 0, kPose));
    graph.expect_doubles("net_II_III.load_tangent", {kSides * kFirst, entry.outputs},
                         rows_of(entry, kPose, entry.inputs));
    graph.expect("MatMul", {d_loads, "net_II_III.load_tangent"}, "net_II_III.through_loads");
    graph.expect("Add", {"net_II_III.through_loads", "net_II_III.pose_tangent"}, seed);
  }
  const auto [others, d_others] = expect_network(
      graph, "net_II_III", static_cast<int>(joined.size()), "net_II_III.inputs", seed);
  expect_wrench(graph, loads, others);
  if (stiffness) expect_stiffness(graph, d_loads, d_others);

  const auto second = take_apart(joined);
  return std::make_unique<TwoStage>(
      network(first, "net_I"),
      std::array{network(second[kMedial], "net_II"), network(second[kLateral], "net_III")});
}

}  // namespace condyle::surrogate
