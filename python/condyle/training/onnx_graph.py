# SPDX-License-Identifier: Apache-2.0
"""The two-stage surrogate as an ONNX graph, node by node: wrench, Jacobian, gate, trust.

Layout, chosen for few nodes, since a runtime spends more on a node than on its arithmetic when N =
1:

- SI scaling is folded into the first and last layers' weights.
- Nets II and III run as one network (``net_II_III``) of twice the width with block-diagonal
weights; the zero blocks cost less
  than a second set of nodes. Its first layer reads (pose, Fy, Mx, Fy, Mx).
- Tangents ∂h/∂pose are (6, N, width): the slope 1 − h² (N, width) then multiplies them without a
reshape, and a
  layer is one matrix product with shared weights: T_l = (1 − h_l²) · (T_{l−1} W_lᵀ).

Only standard operators of opset 17, all in float64. Initialisers are called <net>.weight_<layer>
(d_in, d_out) and <net>.bias_<layer> (d_out,), layers from 1, so that a reader can take the networks
out of the file.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import torch
from numpy.typing import NDArray
from onnx import NodeProto, TensorProto, helper, numpy_helper

from condyle.conventions import LOAD_COLUMNS, POSE_COLUMNS, SIDES
from condyle.training.input_data import FY
from condyle.training.networks import TanhMlp
from condyle.training.trust import TrustModel
from condyle.training.two_stage import FIRST_STAGE_LOADS, SECOND_STAGE_LOADS, TwoStageSurrogate

_N_POSE, _N_SIDES, _N_LOADS = len(POSE_COLUMNS), len(SIDES), len(LOAD_COLUMNS)
Array = NDArray[np.float64]
Layers = list[tuple[Array, Array]]


@dataclass
class GraphBuilder:
    """Nodes and initialisers in the order they were asked for, so equal calls give equal bytes."""

    nodes: list[NodeProto] = field(default_factory=list)
    initialisers: dict[str, TensorProto] = field(default_factory=dict)

    def constant(self, name: str, values: NDArray[np.generic]) -> str:
        """Adds an initialiser (once) and returns its name."""
        if name not in self.initialisers:
            self.initialisers[name] = numpy_helper.from_array(np.ascontiguousarray(values), name)
        return name

    def node(self, operator: str, inputs: list[str], output: str, **attributes: object) -> str:
        """Adds a node with one output and returns the output's name."""
        # Clip and Slice leave inputs out in the middle; none are empty here.
        self.nodes.append(
            helper.make_node(operator, inputs, [output], name=f"node_{output}", **attributes)
        )
        return output

    def integers(self, name: str, values: list[int]) -> str:
        """An int64 constant (shape, axes or indices)."""
        return self.constant(name, np.array(values, dtype=np.int64))


def add_two_stage(graph: GraphBuilder, surrogate: TwoStageSurrogate, *, stiffness: bool) -> None:
    """Adds ``wrench`` and, if asked for, ``stiffness``, from the input ``pose``."""
    first = _layers(surrogate.first)
    second = _side_by_side([_layers(net) for net in surrogate.second])
    seed = first[0][0][:, None, :] if stiffness else None
    tangent = None if seed is None else graph.constant("net_I.pose_tangent", seed)
    outputs, jacobian = _add_network(graph, "net_I", first, "pose", tangent)

    both = graph.node("Concat", ["pose", outputs], "net_II_III.inputs", axis=1)
    if jacobian is not None:
        # Chain rule into the first layer: the pose's own columns, and those through Fy and Mx.
        weight = second[0][0]
        own = graph.constant("net_II_III.pose_tangent", weight[:_N_POSE, None, :])
        through = graph.constant("net_II_III.load_tangent", weight[_N_POSE:])
        product = graph.node("MatMul", [jacobian, through], "net_II_III.through_loads")
        tangent = graph.node("Add", [product, own], "net_II_III.seed")
    others, other_jacobian = _add_network(graph, "net_II_III", second, both, tangent)
    _add_wrench(graph, outputs, others)
    if jacobian is not None and other_jacobian is not None:
        _add_stiffness(graph, jacobian, other_jacobian)


def add_trust(graph: GraphBuilder, trust: TrustModel) -> None:
    """Adds ``error`` (N, 2, 6) and ``trust`` (N,) from ``pose`` and the gated ``wrench``.

    See :mod:`condyle.training.trust` for the formulas.
    """
    fy = graph.node(
        "Slice",
        [
            "wrench",
            graph.integers("Fy.start", [FY]),
            graph.integers("Fy.end", [FY + 1]),
            graph.integers("Fy.axis", [2]),
        ],
        "Fy",
    )
    slope = graph.constant("error.slope", trust.error_slope)
    offset = graph.constant("error.offset", trust.error_offset)
    graph.node("Add", [graph.node("Mul", [fy, slope], "error.load_part"), offset], "error")

    _add_domains(graph, trust)


def _add_domains(graph: GraphBuilder, trust: TrustModel) -> None:
    """Adds ``trust`` from ``pose`` and ``wrench``, see :mod:`condyle.training.sampled_domains`."""
    domains = trust.domains
    cells, rows = domains.offset.shape
    matrix = graph.constant("trust.height_matrix", domains.height_matrix)
    vector = graph.constant("trust.height_vector", domains.height_vector)
    halfway = graph.node("Gemm", ["pose", matrix, vector], "trust.height_gradient")
    products = graph.node("Mul", [halfway, "pose"], "trust.height_products")
    # The height stays a sum of six terms: the cells' weights add them up.
    flat = graph.node(
        "Reshape",
        ["wrench", graph.integers("trust.wrench_shape", [-1, _N_SIDES * _N_LOADS])],
        "trust.wrench",
    )
    joined = graph.node("Concat", ["pose", flat, products], "trust.features", axis=1)
    weights = domains.matrix.reshape(cells * rows, -1)
    height = weights[:, -1:]
    spread = np.concatenate([weights[:, :-1], np.repeat(height, _N_POSE, axis=1)], axis=1)
    shift = domains.offset.reshape(-1) + height[:, 0] * domains.height_offset
    # Scaled by the ramp beforehand, trust is one subtraction from the excess.
    gain = 1.0 / (2.0 * trust.ramp)
    weights_name = graph.constant("trust.weights", gain * spread.T)
    shift_name = graph.constant("trust.shift", gain * shift)
    scores = graph.node("Gemm", [joined, weights_name, shift_name], "trust.scores")
    sizes = graph.node("Abs", [scores], "trust.sizes")
    shape = graph.integers("trust.cells_shape", [-1, cells, rows])
    by_cell = graph.node("Reshape", [sizes, shape], "trust.by_cell")
    largest = graph.node("ReduceMax", [by_cell], "trust.largest", axes=[2], keepdims=0)
    excess = graph.node("ReduceMin", [largest], "trust.excess", axes=[1], keepdims=0)
    level = graph.constant("trust.level", np.array(0.5 + gain * trust.edge))
    ramp = graph.node("Sub", [level, excess], "trust.ramp")
    zero, one = graph.constant("zero", np.array(0.0)), graph.constant("one", np.array(1.0))
    graph.node("Clip", [ramp, zero, one], "trust")


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
            square = graph.node("Mul", [hidden, hidden], f"{name}.square_{index}")
            one = graph.constant("one", np.array(1.0))
            slope = graph.node("Sub", [one, square], f"{name}.slope_{index}")
            tangent = graph.node("Mul", [tangent, slope], f"{name}.tangent_{index}")
    raise AssertionError("a network has at least one layer")


def _add_wrench(graph: GraphBuilder, first: str, second: str) -> None:
    joined = graph.node("Concat", [first, second], "loads", axis=1)
    ordered = graph.node("Gather", [joined, _load_order(graph)], "ordered_loads", axis=1)
    shape = graph.integers("wrench.shape", [-1, _N_SIDES, _N_LOADS])
    ungated = graph.node("Reshape", [ordered, shape], "ungated_wrench")
    columns = [side * len(FIRST_STAGE_LOADS) for side in range(_N_SIDES)]
    fy = graph.node("Gather", [first, graph.integers("Fy.columns", columns)], "ungated_Fy", axis=1)
    # "Fy <= 0", not "not (Fy > 0)": a pose with NaN must come out as NaN, never as no contact.
    zero = graph.constant("zero", np.array(0.0))
    lifted = graph.node("LessOrEqual", [fy, zero], "lifted_side")
    lifted = graph.node("Unsqueeze", [lifted, graph.integers("axis_2", [2])], "lifted")
    graph.node("Where", [lifted, zero, ungated], "wrench")


def _add_stiffness(graph: GraphBuilder, first: str, second: str) -> None:
    joined = graph.node("Concat", [first, second], "load_tangents", axis=2)
    by_row = graph.node("Transpose", [joined], "row_tangents", perm=[1, 2, 0])
    ordered = graph.node("Gather", [by_row, _load_order(graph)], "ordered_tangents", axis=1)
    shape = graph.integers("stiffness.shape", [-1, _N_SIDES, _N_LOADS, _N_POSE])
    ungated = graph.node("Reshape", [ordered, shape], "ungated_stiffness")
    lifted = graph.node("Unsqueeze", ["lifted", graph.integers("axis_3", [3])], "lifted_rows")
    zero = graph.constant("zero", np.array(0.0))
    graph.node("Where", [lifted, zero, ungated], "stiffness")


def _load_order(graph: GraphBuilder) -> str:
    """Where each of the 2 × 6 loads sits among the outputs of nets I, II and III."""
    n_first, n_second = len(FIRST_STAGE_LOADS), len(SECOND_STAGE_LOADS)
    order = []
    for side in range(_N_SIDES):
        for load in range(_N_LOADS):
            if load in FIRST_STAGE_LOADS:
                order.append(side * n_first + FIRST_STAGE_LOADS.index(load))
            else:
                start = _N_SIDES * n_first + side * n_second
                order.append(start + SECOND_STAGE_LOADS.index(load))
    return graph.integers("load_order", order)


def _layers(net: TanhMlp) -> Layers:
    """(Wᵀ (d_in, d_out), b (d_out,)) of each layer, SI in and SI out."""
    with torch.no_grad():
        return [(weight.T.numpy(), bias.numpy()) for weight, bias in net.folded_layers()]


def _side_by_side(nets: list[Layers]) -> Layers:
    """Nets II and III as one network on (pose, Fy, Mx medial, Fy, Mx lateral)."""
    joined: Layers = []
    for index, layer in enumerate(zip(*nets, strict=True)):
        shared = _N_POSE if index == 0 else 0
        rows = shared + sum(weight.shape[0] - shared for weight, _ in layer)
        matrix = np.zeros((rows, sum(weight.shape[1] for weight, _ in layer)))
        row, column = shared, 0
        for weight, _ in layer:
            below, width = weight.shape[0] - shared, weight.shape[1]
            matrix[:shared, column : column + width] = weight[:shared]
            matrix[row : row + below, column : column + width] = weight[shared:]
            row, column = row + below, column + width
        joined.append((matrix, np.concatenate([bias for _, bias in layer])))
    return joined
