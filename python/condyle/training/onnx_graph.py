# SPDX-License-Identifier: Apache-2.0
"""Building a surrogate's ONNX graph: nodes, constants, the pose it reads and the outputs it gives.

Only standard operators of opset 17. Networks keep their weights in initialisers called
<net>.weight_<layer> (d_in, d_out) and <net>.bias_<layer> (d_out,), layers from 1, so that a reader
can take them out of the file.

A graph in float32 still reads and gives float64: poses in metres would lose 4 nm, and a first layer
with the scaling folded in multiplies that by the reciprocal of a millimetre. So the pose is taken
relative to an origin amid the training poses, in float64, and only the difference is rounded.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import DTypeLike, NDArray
from onnx import NodeProto, TensorProto, helper, numpy_helper

from condyle.conventions import LOAD_COLUMNS, POSE_COLUMNS, SIDES

N_POSE, N_SIDES, N_LOADS = len(POSE_COLUMNS), len(SIDES), len(LOAD_COLUMNS)
Array = NDArray[np.float64]
#: (W (d_in, d_out), b (d_out,)) of each layer.
Layers = list[tuple[Array, Array]]


@dataclass
class GraphBuilder:
    """Nodes and initialisers in the order they were asked for, so equal calls give equal bytes.

    Attributes:
        dtype: What the graph computes in.
        origin: (6,) the pose that ``pose`` is relative to; zeros in float64.
        pose: Name of the pose (N, 6), relative to ``origin``, that networks read.
    """

    nodes: list[NodeProto] = field(default_factory=list)
    initialisers: dict[str, TensorProto] = field(default_factory=dict)
    dtype: DTypeLike = np.float64
    origin: Array = field(default_factory=lambda: np.zeros(N_POSE))
    pose: str = "pose"

    @classmethod
    def in_float32(cls, origin: Array) -> GraphBuilder:
        """A graph in float32 about ``origin`` (6,)."""
        graph = cls(dtype=np.float32, origin=origin)
        exact = graph._add("pose.origin", np.asarray(origin, dtype=np.float64))
        difference = graph.node("Sub", ["pose", exact], "pose.difference")
        graph.pose = graph.node("Cast", [difference], "pose.relative", to=TensorProto.FLOAT)
        return graph

    @property
    def in_double(self) -> bool:
        """Whether the graph computes in float64."""
        return np.dtype(self.dtype) == np.float64

    def constant(self, name: str, values: NDArray[np.generic]) -> str:
        """Adds an initialiser (once), numbers in the graph's own type, and returns its name."""
        if np.issubdtype(values.dtype, np.floating):
            values = values.astype(self.dtype)
        return self._add(name, values)

    def node(self, operator: str, inputs: list[str], output: str, **attributes: object) -> str:
        """Adds a node with one output and returns the output's name."""
        # Clip and Slice leave inputs out in the middle; none are empty here.
        self.nodes.append(
            helper.make_node(operator, inputs, [output], name=f"node_{output}", **attributes)
        )
        return output

    def output(self, name: str) -> str:
        """What the node that makes output ``name`` must call it; others read it by this name."""
        return name if self.in_double else f"{name}.float32"

    def finish(self, outputs: tuple[str, ...]) -> None:
        """Makes the outputs float64."""
        if not self.in_double:
            for name in outputs:
                self.node("Cast", [self.output(name)], name, to=TensorProto.DOUBLE)

    def integers(self, name: str, values: list[int]) -> str:
        """An int64 constant (shape, axes or indices)."""
        return self.constant(name, np.array(values, dtype=np.int64))

    def number(self, name: str, value: float) -> str:
        """A scalar."""
        return self.constant(name, np.array(value))

    def reshape(self, value: str, output: str, shape: list[int], shape_name: str) -> str:
        """Adds a Reshape to ``shape``, a constant that equal shapes may share."""
        return self.node("Reshape", [value, self.integers(shape_name, shape)], output)

    def _add(self, name: str, values: NDArray[np.generic]) -> str:
        if name not in self.initialisers:
            self.initialisers[name] = numpy_helper.from_array(np.ascontiguousarray(values), name)
        return name


def add_slope(graph: GraphBuilder, net: str, layer: int, hidden: str) -> str:
    """Adds 1 − h², the derivative of tanh at a hidden layer's h."""
    square = graph.node("Mul", [hidden, hidden], f"{net}.square_{layer}")
    return graph.node("Sub", [graph.number("one", 1.0), square], f"{net}.slope_{layer}")


def add_gate(graph: GraphBuilder, lifting: str) -> str:
    """Adds the sides (N, 2, 1) at which ``lifting`` (N, 2) is not positive."""
    # "x <= 0", not "not (x > 0)": a pose with NaN must come out as NaN, never as no contact.
    lifted = graph.node("LessOrEqual", [lifting, graph.number("zero", 0.0)], "lifted_side")
    return graph.node("Unsqueeze", [lifted, graph.integers("axis_2", [2])], "lifted")


def add_gated(graph: GraphBuilder, ungated: str, lifted: str, output: str) -> None:
    """Adds ``output``: zero where lifted."""
    graph.node("Where", [lifted, graph.number("zero", 0.0), ungated], graph.output(output))


def side_by_side(nets: list[Layers], shared: int) -> Layers:
    """Several networks as one of block-diagonal weights, on ``shared`` inputs, then each one's own.

    The zero blocks cost less than a second set of nodes: a runtime spends more on a node than on
    its arithmetic when N = 1.
    """
    joined: Layers = []
    for index, layer in enumerate(zip(*nets, strict=True)):
        common = shared if index == 0 else 0
        rows = common + sum(weight.shape[0] - common for weight, _ in layer)
        matrix = np.zeros((rows, sum(weight.shape[1] for weight, _ in layer)))
        row, column = common, 0
        for weight, _ in layer:
            below, width = weight.shape[0] - common, weight.shape[1]
            matrix[:common, column : column + width] = weight[:common]
            matrix[row : row + below, column : column + width] = weight[common:]
            row, column = row + below, column + width
        joined.append((matrix, np.concatenate([bias for _, bias in layer])))
    return joined


def about_origin(graph: GraphBuilder, layers: Layers) -> Layers:
    """Layers whose first six inputs are the pose, for the pose relative to the graph's origin."""
    weight, bias = layers[0]
    return [(weight, bias + graph.origin @ weight[:N_POSE]), *layers[1:]]
