// SPDX-License-Identifier: Apache-2.0
// The counterpart of add_potential() in python/condyle/training/onnx_potential.py, node by node.
// Both sides stand there as one network of block-diagonal weights: they are taken apart here, and
// what the constants say twice has to agree.
#include "condyle/surrogate/potential_graph.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "condyle/surrogate/network_blocks.hpp"
#include "condyle/surrogate/potential_turn.hpp"

namespace condyle::surrogate {
namespace {

constexpr int kPose = 6;
constexpr std::size_t kColumns = kSides * kPose;
const std::string kNet = "energy";

using Attributes = std::vector<OnnxAttribute>;

Attributes integer(const char* name, std::int64_t value) {
  return {GraphTemplate::integer_attribute(name, value)};
}

std::string named(const char* what, int layer) { return numbered(kNet, what, layer); }

/// All that the networks' constants say.
struct Constants {
  std::vector<DenseLayer> hidden;  // both sides' neurons
  std::vector<int> border;         // of each layer: the medial side's neurons
  DenseLayer last;                 // hidden, products, pose → N
  std::vector<double> curvature;   // (6, 12)
  std::vector<double> steepness;   // (12)
  int width(std::size_t layer) const { return hidden[layer].outputs; }
};

[[noreturn]] void refuse_sides() { throw UnknownGraph("energy is not two networks side by side"); }

const std::vector<double>& vector_of(const GraphTemplate& graph, const std::string& name,
                                     const std::vector<std::int64_t>& shape) {
  const OnnxTensor& tensor = graph.doubles(name);
  if (tensor.shape != shape) throw UnknownGraph("constant " + name + " has another shape");
  return tensor.doubles;
}

/// Where each layer's medial neurons end. The first layer's are those that lead back to the medial
/// columns; a later layer's, those that read some medial neuron.
std::vector<int> find_borders(const GraphTemplate& graph, const std::vector<DenseLayer>& hidden) {
  const int first = hidden.front().outputs;
  const auto& back =
      vector_of(graph, "energy.back_to_pose", {first, static_cast<std::int64_t>(kColumns)});
  const DenseLayer to_pose{first, static_cast<int>(kColumns), back, {}};
  int border = 1;
  while (border < first && is_zero(to_pose, border, border + 1, kPose, kColumns)) ++border;
  std::vector<int> borders{border};
  for (std::size_t l = 1; l < hidden.size(); ++l) {
    const DenseLayer& layer = hidden[l];
    int medial = layer.outputs - 1;
    while (medial > 1 && is_zero(layer, 0, border, medial - 1, medial)) --medial;
    if (layer.inputs != hidden[l - 1].outputs || layer.inputs <= border ||
        !is_zero(layer, 0, border, medial, layer.outputs) ||
        !is_zero(layer, border, layer.inputs, 0, medial)) {
      refuse_sides();
    }
    borders.push_back(border = medial);
  }
  return borders;
}

Constants read_constants(const GraphTemplate& graph) {
  Constants c;
  c.hidden = read_layers(graph, kNet);
  if (c.hidden.empty() || c.hidden.front().inputs != kPose || c.hidden.front().outputs < kSides) {
    throw UnknownGraph("there is no network energy of a pose");
  }
  c.border = find_borders(graph, c.hidden);
  const int inputs = c.hidden.back().outputs + static_cast<int>(kColumns) + kPose;
  c.last = {inputs, kSides, vector_of(graph, "energy.last_weight", {inputs, kSides}),
            vector_of(graph, "energy.last_bias", {kSides})};
  c.curvature = vector_of(graph, "energy.curvature", {kPose, kColumns});
  c.steepness = vector_of(graph, "energy.steepness", {kColumns});
  return c;
}

/// The constants that follow from others: last_weight's lower part, last_row and back_to_pose.
void expect_repeated(const GraphTemplate& graph, const Constants& c) {
  const int width = c.hidden.back().outputs, border = c.border.back();
  std::vector<double> lower;
  for (std::size_t column = 0; column < kColumns; ++column) {
    lower.insert(lower.end(), {column < kPose ? 0.5 : 0.0, column < kPose ? 0.0 : 0.5});
  }
  for (std::size_t k = 0; k < kPose; ++k) {
    lower.insert(lower.end(), {0.5 * c.steepness[k], 0.5 * c.steepness[kPose + k]});
  }
  if (rows_of(c.last, width, c.last.inputs) != lower || !is_zero(c.last, 0, border, 1, 2) ||
      !is_zero(c.last, border, width, 0, 1)) {
    throw UnknownGraph("constant energy.last_weight is not what it has to be");
  }
  std::vector<double> row, back;
  for (int j = 0; j < width; ++j) {
    row.push_back(c.last.weight[static_cast<std::size_t>(kSides * j + (j < border ? 0 : 1))]);
  }
  graph.expect_doubles("energy.last_row", {width}, row);
  const DenseLayer& first = c.hidden.front();
  for (int j = 0; j < first.outputs; ++j) {
    const int side = j < c.border.front() ? 0 : 1;
    for (int column = 0; column < static_cast<int>(kColumns); ++column) {
      const bool own = column / kPose == side;
      back.push_back(
          own ? first.weight[static_cast<std::size_t>(column % kPose * first.outputs + j)] : 0.0);
    }
  }
  graph.expect_doubles("energy.back_to_pose", {first.outputs, kColumns}, back);
}

/// h_l, s_l, δ_l of every hidden layer.
void expect_layers(GraphTemplate& graph, int layers) {
  graph.expect_number("one", 1.0);
  std::string inputs = "pose", back = "energy.last_row";
  for (int l = 1; l <= layers; ++l) {
    graph.expect("Gemm", {inputs, named("weight", l), named("bias", l)}, named("sums", l));
    graph.expect("Tanh", {named("sums", l)}, named("hidden", l));
    inputs = named("hidden", l);
    graph.expect("Mul", {inputs, inputs}, named("square", l));
    graph.expect("Sub", {"one", named("square", l)}, named("slope", l));
  }
  for (int l = layers; l >= 1; --l) {
    graph.expect("Mul", {named("slope", l), back}, named("delta", l));
    if (l == 1) break;
    back = named("back", l - 1);
    graph.expect("Gemm", {named("delta", l), named("weight", l)}, back, integer("transB", 1));
  }
}

/// N, ∂N/∂p and −f from there.
void expect_gradient(GraphTemplate& graph, const std::string& last_hidden) {
  graph.expect("Gemm", {"pose", "energy.curvature", "energy.steepness"},
               "energy.quadratic_gradient");
  graph.expect("Concat", {"pose", "pose"}, "energy.pose_by_side", integer("axis", 1));
  graph.expect("Mul", {"energy.quadratic_gradient", "energy.pose_by_side"}, "energy.products");
  graph.expect("Concat", {last_hidden, "energy.products", "pose"}, "energy.terms",
               integer("axis", 1));
  graph.expect("Gemm", {"energy.terms", "energy.last_weight", "energy.last_bias"}, "energy.depth");
  graph.expect("Gemm", {"energy.delta_1", "energy.back_to_pose", "energy.quadratic_gradient"},
               "energy.flat_gradient");
  graph.expect_integers("side_shape", {-1, kSides, kPose});
  graph.expect("Reshape", {"energy.flat_gradient", "side_shape"}, "energy.gradient");
  graph.expect("Pow", {"energy.depth", "energy.exponent"}, "energy.bend");
  graph.expect("Mul", {"energy.bend", "energy.depth"}, "energy.rise");
  graph.expect("Mul", {"energy.rise", "energy.force_factor"}, "energy.force");
}

std::vector<double> flat(const std::vector<const TurnMatrix*>& matrices, bool transposed,
                         std::size_t first, std::size_t last) {
  std::vector<double> values;
  for (std::size_t term = first; term < last; ++term) {
    for (std::size_t i = 0; i < kPose; ++i) {
      for (const TurnMatrix* matrix : matrices) {
        for (std::size_t j = 0; j < kPose; ++j) {
          values.push_back(transposed ? (*matrix)[j][i][term] : (*matrix)[i][j][term]);
        }
      }
    }
  }
  return values;
}

void expect_turn(GraphTemplate& graph, const std::string& name,
                 const std::vector<const TurnMatrix*>& matrices, bool transposed,
                 const std::vector<std::int64_t>& shape) {
  const auto size = static_cast<std::int64_t>(kPose * kPose * matrices.size());
  graph.expect_doubles(name + ".bias", {size}, flat(matrices, transposed, 0, 1));
  graph.expect_doubles(name + ".weight", {kTurnSines, size},
                       flat(matrices, transposed, 1, 1 + kTurnSines));
  graph.expect_integers(name + ".shape", shape);
  graph.expect("Gemm", {"sines_over_cosine", name + ".weight", name + ".bias"}, name + ".flat");
  graph.expect("Reshape", {name + ".flat", name + ".shape"}, name);
}

void expect_wrench(GraphTemplate& graph) {
  graph.expect_integers("per_side", {-1, kSides, 1});
  graph.expect("Reshape", {"energy.force", "per_side"}, "energy.side_force");
  graph.expect("Mul", {"energy.gradient", "energy.side_force"}, "generalised_force");
  graph.expect_doubles("angle.multiples", {kPose, kTurnSines}, turn_multiples());
  graph.expect_doubles("angle.phases", {kTurnSines}, turn_phases());
  graph.expect_integers("angle.last", {kTurnSines - 1});
  graph.expect_integers("angle.end", {kTurnSines});
  graph.expect_integers("axis_1", {1});
  graph.expect("Gemm", {"pose", "angle.multiples", "angle.phases"}, "angles");
  graph.expect("Sin", {"angles"}, "sines");
  graph.expect("Slice", {"sines", "angle.last", "angle.end", "axis_1"}, "cosine_theta_y");
  graph.expect("Mul", {"cosine_theta_y", "cosine_theta_y"}, "cosine_squared");
  graph.expect("Div", {"sines", "cosine_squared"}, "sines_over_cosine");
  const auto matrices = turn_matrices();
  expect_turn(graph, "turn", {&matrices[0]}, true, {-1, kPose, kPose});
  graph.expect("MatMul", {"generalised_force", "turn"}, "ungated_wrench");
  graph.expect_number("zero", 0.0);
  graph.expect_integers("axis_2", {2});
  graph.expect("LessOrEqual", {"energy.depth", "zero"}, "lifted_side");
  graph.expect("Unsqueeze", {"lifted_side", "axis_2"}, "lifted");
  graph.expect("Where", {"lifted", "zero", "ungated_wrench"}, "wrench");
}

/// The first layer's and the quadratic's part of ∂²N/∂p².
void expect_first_hessian(GraphTemplate& graph, const Constants& c) {
  const DenseLayer& first = c.hidden.front();
  std::vector<double> pairs, constant;
  for (int j = 0; j < first.outputs; ++j) {
    const auto w = [&](int k) {
      return first.weight[static_cast<std::size_t>(k * first.outputs + j)];
    };
    for (int side = 0; side < kSides; ++side) {
      const bool own = (j < c.border.front()) == (side == 0);
      for (int k = 0; k < kPose; ++k) {
        for (int m = 0; m < kPose; ++m) pairs.push_back(own ? -2.0 * (w(k) * w(m)) : 0.0);
      }
    }
  }
  for (std::size_t column = 0; column < kColumns; column += kPose) {
    for (std::size_t k = 0; k < kPose; ++k) {
      for (std::size_t m = 0; m < kPose; ++m) {
        constant.push_back(c.curvature[k * kColumns + column + m]);
      }
    }
  }
  constexpr std::int64_t kMatrices = kSides * kPose * kPose;
  graph.expect_doubles("energy.first_pairs", {first.outputs, kMatrices}, pairs);
  graph.expect_doubles("energy.constant_pairs", {kMatrices}, constant);
  graph.expect_integers("matrix_shape", {-1, kSides, kPose, kPose});
  graph.expect("Gemm", {"energy.bend_1", "energy.first_pairs", "energy.constant_pairs"},
               "energy.flat_hessian");
  graph.expect("Reshape", {"energy.flat_hessian", "matrix_shape"}, "energy.first_hessian");
}

/// That of the layers after the first.
void expect_later_hessian(GraphTemplate& graph, const Constants& c) {
  const int layers = static_cast<int>(c.hidden.size());
  const DenseLayer& first = c.hidden.front();
  graph.expect_doubles("energy.pose_tangent", {1, kPose, 1, first.outputs}, first.weight);
  std::string tangent = "energy.pose_tangent";
  std::vector<std::string> tangents, bends;
  std::vector<double> of_side[kSides];
  for (int l = 2; l <= layers; ++l) {
    graph.expect("Mul", {tangent, named("slope", l - 1)}, named("tangent", l - 1));
    tangent = named("sums_tangent", l);
    graph.expect("MatMul", {named("tangent", l - 1), named("weight", l)}, tangent);
    tangents.push_back(tangent);
    bends.push_back(named("bend", l));
    const auto layer = static_cast<std::size_t>(l - 1);
    for (int j = 0; j < c.width(layer); ++j) {
      for (int side = 0; side < kSides; ++side) {
        of_side[side].push_back((j < c.border[layer]) == (side == 0) ? -2.0 : 0.0);
      }
    }
  }
  std::string bend = bends.front();
  if (tangents.size() > 1) {
    graph.expect("Concat", tangents, "energy.tangents", integer("axis", 3));
    graph.expect("Concat", bends, "energy.bends", integer("axis", 1));
    tangent = "energy.tangents";
    bend = "energy.bends";
  }
  const auto perm = [](std::vector<std::int64_t> order) {
    return Attributes{GraphTemplate::integers_attribute("perm", order)};
  };
  const auto width = static_cast<std::int64_t>(of_side[0].size());
  std::vector<double> mask = of_side[0];
  mask.insert(mask.end(), of_side[1].begin(), of_side[1].end());
  graph.expect_doubles("energy.bend_of_side", {kSides, 1, width}, mask);
  graph.expect_integers("bend_shape", {-1, 1, 1, width});
  graph.expect("Transpose", {tangent}, "energy.rows", perm({2, 0, 1, 3}));
  graph.expect("Transpose", {tangent}, "energy.columns", perm({2, 0, 3, 1}));
  graph.expect("Reshape", {bend, "bend_shape"}, "energy.bend_row");
  graph.expect("Mul", {"energy.bend_row", "energy.bend_of_side"}, "energy.bend_by_side");
  graph.expect("Mul", {"energy.rows", "energy.bend_by_side"}, "energy.weighted_rows");
  graph.expect("MatMul", {"energy.weighted_rows", "energy.columns"}, "energy.later_hessian");
  graph.expect("Add", {"energy.first_hessian", "energy.later_hessian"}, "hessian");
}

/// From ∂²N/∂p² to the stiffness.
void expect_stiffness(GraphTemplate& graph, const std::string& hessian) {
  graph.expect("Mul", {"energy.bend", "energy.curve_factor"}, "energy.curve");
  graph.expect_integers("axis_3", {3});
  graph.expect_integers("per_matrix", {-1, kSides, 1, 1});
  graph.expect("Unsqueeze", {"energy.side_force", "axis_3"}, "energy.matrix_force");
  graph.expect("Reshape", {"energy.curve", "per_matrix"}, "energy.matrix_curve");
  graph.expect("Unsqueeze", {"energy.gradient", "axis_3"}, "energy.gradient_column");
  graph.expect("Unsqueeze", {"energy.gradient", "axis_2"}, "energy.gradient_row");
  graph.expect("Mul", {"energy.gradient_column", "energy.gradient_row"}, "energy.outer");
  graph.expect("Mul", {"energy.outer", "energy.matrix_curve"}, "energy.bent_outer");
  graph.expect("Mul", {hessian, "energy.matrix_force"}, "energy.scaled_hessian");
  graph.expect("Add", {"energy.scaled_hessian", "energy.bent_outer"}, "generalised_stiffness");
  // Q_m at column θx of row m, and at column θy of row 6 + m.
  constexpr std::size_t kThetaX = 3;
  std::vector<double> spread(kPose * 2 * kPose * kPose);
  for (std::size_t m = 0; m < kPose; ++m) {
    for (std::size_t angle = 0; angle < 2; ++angle) {
      spread[((m * 2 + angle) * kPose + m) * kPose + kThetaX + angle] = 1.0;
    }
  }
  graph.expect_doubles("energy.angle_columns", {kPose, 2 * kPose * kPose}, spread);
  graph.expect_integers("column_shape", {-1, kSides, 2 * kPose, kPose});
  graph.expect("MatMul", {"generalised_force", "energy.angle_columns"}, "energy.flat_columns");
  graph.expect("Reshape", {"energy.flat_columns", "column_shape"}, "energy.force_columns");
  graph.expect("Concat", {"generalised_stiffness", "energy.force_columns"}, "energy.stacked",
               integer("axis", 2));
  const auto matrices = turn_matrices();
  expect_turn(graph, "turns", {&matrices[0], &matrices[1], &matrices[2]}, false,
              {-1, 1, kPose, 3 * kPose});
  graph.expect("MatMul", {"turns", "energy.stacked"}, "ungated_stiffness");
  graph.expect("Unsqueeze", {"lifted", "axis_3"}, "lifted_rows");
  graph.expect("Where", {"lifted_rows", "zero", "ungated_stiffness"}, "stiffness");
}

PotentialSide take_side(const GraphTemplate& graph, const Constants& c, int side) {
  PotentialSide taken;
  for (std::size_t l = 0; l < c.hidden.size(); ++l) {
    const DenseLayer& layer = c.hidden[l];
    const int shared = l == 0 ? kPose : 0, above = l == 0 ? 0 : c.border[l - 1];
    const int own_inputs = side == 0 ? above : layer.inputs - shared - above;
    const int outputs = side == 0 ? c.border[l] : layer.outputs - c.border[l];
    taken.layers.push_back(block(layer, shared, side == 0 ? 0 : above, own_inputs,
                                 side == 0 ? 0 : c.border[l], outputs));
  }
  const int width = c.hidden.back().outputs, border = c.border.back();
  taken.layers.push_back(
      block(c.last, 0, side == 0 ? 0 : border, side == 0 ? border : width - border, side, 1));
  for (std::size_t k = 0; k < kPose; ++k) {
    const std::size_t first = static_cast<std::size_t>(side) * kPose;
    taken.steepness[k] = c.steepness[first + k];
    for (std::size_t m = 0; m < kPose; ++m) {
      taken.curvature[k * kPose + m] = c.curvature[k * kColumns + first + m];
    }
  }
  const auto number = [&](const char* name) {
    return vector_of(graph, name, {kSides})[static_cast<std::size_t>(side)];
  };
  taken.exponent = number("energy.exponent");
  taken.force_factor = number("energy.force_factor");
  const double curve = taken.force_factor * (taken.exponent + 1.0);
  taken.curve_factor = curve;
  if (has_output(graph.file(), "stiffness")) {
    taken.curve_factor = number("energy.curve_factor");
    // q − 2 + 1 and q − 1 may round differently.
    if (!(std::abs(taken.curve_factor - curve) <= 1e-14 * std::abs(curve))) {
      throw UnknownGraph("constant energy.curve_factor is not what it has to be");
    }
  }
  for (std::size_t k = 0; k < kPose; ++k) {
    for (std::size_t m = 0; m < k; ++m) {
      if (taken.curvature[k * kPose + m] != taken.curvature[m * kPose + k]) {
        throw UnknownGraph("constant energy.curvature is not symmetric");
      }
    }
  }
  return taken;
}

}  // namespace

bool resembles_potential(const GraphTemplate& graph) {
  return graph.has_constant(named("weight", 1));
}

std::unique_ptr<Potential> match_potential(GraphTemplate& graph) {
  const Constants c = read_constants(graph);
  const int layers = static_cast<int>(c.hidden.size());
  expect_repeated(graph, c);
  expect_layers(graph, layers);
  expect_gradient(graph, named("hidden", layers));
  expect_wrench(graph);
  if (has_output(graph.file(), "stiffness")) {
    for (int l = 1; l <= layers; ++l) {
      graph.expect("Mul", {named("delta", l), named("hidden", l)}, named("bend", l));
    }
    expect_first_hessian(graph, c);
    if (layers > 1) expect_later_hessian(graph, c);
    expect_stiffness(graph, layers > 1 ? "hessian" : "energy.first_hessian");
  }
  try {
    return std::make_unique<Potential>(std::array{take_side(graph, c, 0), take_side(graph, c, 1)});
  } catch (const std::invalid_argument& error) {
    throw UnknownGraph(error.what());
  }
}

}  // namespace condyle::surrogate
