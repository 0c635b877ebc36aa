# SPDX-License-Identifier: Apache-2.0
"""The two-stage surrogate as an ONNX graph, node by node: wrench, Jacobian, gate.

Layout, chosen for few nodes, since a runtime spends more on a node than on its arithmetic when N =
1:

- SI scaling is folded into the first and last layers' weights.
- Nets II and III run as one network (``net_II_III``) of twice the width with block-diagonal
weights. Its first layer reads (pose, Fy, Mx, Fy, Mx).
- Tangents ∂h/∂pose are (6, N, width): the slope 1 − h² (N, width) then multiplies them without a
reshape, and a layer is one matrix product with shared weights: T_l = (1 − h_l²) · (T_{l−1} W_lᵀ).
"""

from __future__ import annotations

import torch

from condyle.training.networks import TanhMlp
from condyle.training.onnx_graph import (
    N_LOADS,
    N_POSE,
    N_SIDES,
    GraphBuilder,
    Layers,
    about_origin,
    add_gate,
    add_gated,
    add_slope,
    side_by_side,
)
from condyle.training.two_stage import FIRST_STAGE_LOADS, SECOND_STAGE_LOADS, TwoStageSurrogate


def add_two_stage(graph: GraphBuilder, surrogate: TwoStageSurrogate, *, stiffness: bool) -> None:
    """Adds ``wrench`` and, if asked for, ``stiffness``, from the pose."""
    first = about_origin(graph, _layers(surrogate.first))
    second = about_origin(
        graph, side_by_side([_layers(net) for net in surrogate.second], shared=N_POSE)
    )
    seed = first[0][0][:, None, :] if stiffness else None
    tangent = None if seed is None else graph.constant("net_I.pose_tangent", seed)
    outputs, jacobian = _add_network(graph, "net_I", first, graph.pose, tangent)

    both = graph.node("Concat", [graph.pose, outputs], "net_II_III.inputs", axis=1)
    if jacobian is not None:
        # Chain rule into the first layer: the pose's own columns, and those through Fy and Mx.
        weight = second[0][0]
        own = graph.constant("net_II_III.pose_tangent", weight[:N_POSE, None, :])
        through = graph.constant("net_II_III.load_tangent", weight[N_POSE:])
        product = graph.node("MatMul", [jacobian, through], "net_II_III.through_loads")
        tangent = graph.node("Add", [product, own], "net_II_III.seed")
    others, other_jacobian = _add_network(graph, "net_II_III", second, both, tangent)
    _add_wrench(graph, outputs, others)
    if jacobian is not None and other_jacobian is not None:
        _add_stiffness(graph, jacobian, other_jacobian)


def _add_network(
    graph: GraphBuilder, name: str, layers: Layers, inputs: str, seed: str | None
) -> tuple[str, str | None]:
    """Adds a tanh MLP; returns its outputs (N, d) and, with ``seed``, their tangent (6, N, d).

    ``seed`` is the tangent (6, N or 1, width) of the first layer's sums.
    """
    hidden, tangent = inputs, seed
    for index, (weight, bias) in enumerate(layers, start=1):
        weight_name = graph.constant(f"{name}.weight_{index}", weight)
        bias_name = graph.constant(f"{name}.bias_{index}", bias)
        sums = graph.node("Gemm", [hidden, weight_name, bias_name], f"{name}.sums_{index}")
        if tangent is not None and index > 1:
            tangent = graph.node("MatMul", [tangent, weight_name], f"{name}.sums_tangent_{index}")
        if index == len(layers):
            return sums, tangent
        hidden = graph.node("Tanh", [sums], f"{name}.hidden_{index}")
        if tangent is not None:
            slope = add_slope(graph, name, index, hidden)
            tangent = graph.node("Mul", [tangent, slope], f"{name}.tangent_{index}")
    raise AssertionError("a network has at least one layer")


def _add_wrench(graph: GraphBuilder, first: str, second: str) -> None:
    joined = graph.node("Concat", [first, second], "loads", axis=1)
    ordered = graph.node("Gather", [joined, _load_order(graph)], "ordered_loads", axis=1)
    ungated = graph.reshape(ordered, "ungated_wrench", [-1, N_SIDES, N_LOADS], "wrench.shape")
    columns = [side * len(FIRST_STAGE_LOADS) for side in range(N_SIDES)]
    fy = graph.node("Gather", [first, graph.integers("Fy.columns", columns)], "ungated_Fy", axis=1)
    add_gated(graph, ungated, add_gate(graph, fy), "wrench")


def _add_stiffness(graph: GraphBuilder, first: str, second: str) -> None:
    joined = graph.node("Concat", [first, second], "load_tangents", axis=2)
    by_row = graph.node("Transpose", [joined], "row_tangents", perm=[1, 2, 0])
    ordered = graph.node("Gather", [by_row, _load_order(graph)], "ordered_tangents", axis=1)
    shape = [-1, N_SIDES, N_LOADS, N_POSE]
    ungated = graph.reshape(ordered, "ungated_stiffness", shape, "stiffness.shape")
    lifted = graph.node("Unsqueeze", ["lifted", graph.integers("axis_3", [3])], "lifted_rows")
    add_gated(graph, ungated, lifted, "stiffness")


def _load_order(graph: GraphBuilder) -> str:
    """Where each of the 2 × 6 loads sits among the outputs of nets I, II and III."""
    n_first, n_second = len(FIRST_STAGE_LOADS), len(SECOND_STAGE_LOADS)
    order = []
    for side in range(N_SIDES):
        for load in range(N_LOADS):
            if load in FIRST_STAGE_LOADS:
                order.append(side * n_first + FIRST_STAGE_LOADS.index(load))
            else:
                start = N_SIDES * n_first + side * n_second
                order.append(start + SECOND_STAGE_LOADS.index(load))
    return graph.integers("load_order", order)


def _layers(net: TanhMlp) -> Layers:
    """(Wᵀ (d_in, d_out), b (d_out,)) of each layer, SI in and SI out."""
    with torch.no_grad():
        return [(weight.T.numpy(), bias.numpy()) for weight, bias in net.folded_layers()]
