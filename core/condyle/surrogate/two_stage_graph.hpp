// SPDX-License-Identifier: Apache-2.0
// The graph that condyle.training.onnx_two_stage writes for a two-stage surrogate, recognised.
#pragma once

#include <memory>

#include "condyle/surrogate/graph_template.hpp"
#include "condyle/surrogate/two_stage.hpp"

namespace condyle::surrogate {

/// Matches the nodes that lead from `pose` to `wrench` and, where the file has it, `stiffness`, and
/// takes the networks out of the constants. What else the graph has is left in graph.rest().
/// @throws UnknownGraph naming the value where the graph departs, or when a network is wider than
///   the kernels take.
std::unique_ptr<TwoStage> match_two_stage(GraphTemplate& graph);

}  // namespace condyle::surrogate
