// SPDX-License-Identifier: Apache-2.0
// Networks among the constants of a graph: <net>.weight_<l> (inputs, outputs) and <net>.bias_<l>,
// layers from 1; and what stands side by side in one of block-diagonal weights.
#pragma once

#include <string>
#include <vector>

#include "condyle/surrogate/dense_network.hpp"
#include "condyle/surrogate/graph_template.hpp"

namespace condyle::surrogate {

/// "<net>.<what>_<layer>", the name of a value.
std::string numbered(const std::string& net, const char* what, int layer);

/// The layers that the graph has of a network. @throws UnknownGraph on one that is none.
std::vector<DenseLayer> read_layers(const GraphTemplate& graph, const std::string& net);

/// The block of a layer from inputs [row, row + inputs) to outputs [column, column + outputs),
/// after `shared` inputs that all blocks read.
DenseLayer block(const DenseLayer& layer, int shared, int row, int inputs, int column, int outputs);

/// Whether all weights from inputs [row, row_end) to outputs [column, column_end) are zero.
bool is_zero(const DenseLayer& layer, int row, int row_end, int column, int column_end);

/// The weights of inputs [first, last).
std::vector<double> rows_of(const DenseLayer& layer, int first, int last);

/// Whether the file promises such an output.
bool has_output(const OnnxFile& file, const char* name);

}  // namespace condyle::surrogate
