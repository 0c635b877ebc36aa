// SPDX-License-Identifier: Apache-2.0
// The graph that condyle.training.onnx_potential writes for a potential surrogate, recognised.
#pragma once

#include <memory>

#include "condyle/surrogate/graph_template.hpp"
#include "condyle/surrogate/potential.hpp"

namespace condyle::surrogate {

/// Whether the graph has a potential's first layer: whether match_potential() is worth trying.
bool resembles_potential(const GraphTemplate& graph);

/// Matches the nodes that lead from `pose` to `wrench` and, where the file has it, `stiffness`, and
/// takes the energies out of the constants. What else the graph has is left in graph.rest().
/// @throws UnknownGraph naming the value where the graph departs, or when a network is larger than
///   the kernels take.
std::unique_ptr<Potential> match_potential(GraphTemplate& graph);

}  // namespace condyle::surrogate
