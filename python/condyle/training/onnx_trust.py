# SPDX-License-Identifier: Apache-2.0
"""``error`` and ``trust`` as part of a surrogate's ONNX graph, whatever its architecture.

See :mod:`condyle.training.trust` and :mod:`condyle.training.sampled_domains` for the formulas.
"""

from __future__ import annotations

import numpy as np

from condyle.training.input_data import FY
from condyle.training.onnx_graph import N_LOADS, N_POSE, N_SIDES, GraphBuilder
from condyle.training.trust import TrustModel


def add_trust(graph: GraphBuilder, trust: TrustModel) -> None:
    """Adds ``error`` (N, 2, 6) and ``trust`` (N,) from the pose and the gated ``wrench``."""
    fy = graph.node(
        "Slice",
        [
            graph.output("wrench"),
            graph.integers("Fy.start", [FY]),
            graph.integers("Fy.end", [FY + 1]),
            graph.integers("Fy.axis", [2]),
        ],
        "Fy",
    )
    slope = graph.constant("error.slope", trust.error_slope)
    offset = graph.constant("error.offset", trust.error_offset)
    # An energy's gradient may pull, far from any sample: that is no load to be in proportion to.
    zero = graph.constant("error.zero", np.zeros(1))
    compression = graph.node("Max", [fy, zero], "error.compression")
    load_part = graph.node("Mul", [compression, slope], "error.load_part")
    graph.node("Add", [load_part, offset], graph.output("error"))
    _add_domains(graph, trust)


def _add_domains(graph: GraphBuilder, trust: TrustModel) -> None:
    """Adds ``trust``."""
    domains, origin = trust.domains, graph.origin
    cells, rows = domains.offset.shape
    # The height's quadratic about the origin; the cells take up the constant.
    vector = domains.height_vector + 2 * domains.height_matrix @ origin
    constant = domains.height_offset + origin @ (domains.height_vector + vector) / 2
    matrix_name = graph.constant("trust.height_matrix", domains.height_matrix)
    vector_name = graph.constant("trust.height_vector", vector)
    halfway = graph.node("Gemm", [graph.pose, matrix_name, vector_name], "trust.height_gradient")
    products = graph.node("Mul", [halfway, graph.pose], "trust.height_products")
    # The height stays a sum of six terms: the cells' weights add them up.
    flat = graph.reshape(
        graph.output("wrench"), "trust.wrench", [-1, N_SIDES * N_LOADS], "trust.wrench_shape"
    )
    joined = graph.node("Concat", [graph.pose, flat, products], "trust.features", axis=1)
    weights = domains.matrix.reshape(cells * rows, -1)
    height = weights[:, -1:]
    spread = np.concatenate([weights[:, :-1], np.repeat(height, N_POSE, axis=1)], axis=1)
    shift = domains.offset.reshape(-1) + height[:, 0] * constant + weights[:, :N_POSE] @ origin
    # Scaled by the ramp beforehand, trust is one subtraction from the excess.
    gain = 1.0 / (2.0 * trust.ramp)
    weights_name = graph.constant("trust.weights", gain * spread.T)
    shift_name = graph.constant("trust.shift", gain * shift)
    scores = graph.node("Gemm", [joined, weights_name, shift_name], "trust.scores")
    sizes = graph.node("Abs", [scores], "trust.sizes")
    by_cell = graph.reshape(sizes, "trust.by_cell", [-1, cells, rows], "trust.cells_shape")
    largest = graph.node("ReduceMax", [by_cell], "trust.largest", axes=[2], keepdims=0)
    excess = graph.node("ReduceMin", [largest], "trust.excess", axes=[1], keepdims=0)
    level = graph.number("trust.level", 0.5 + gain * trust.edge)
    ramp = graph.node("Sub", [level, excess], "trust.ramp")
    zero, one = graph.number("zero", 0.0), graph.number("one", 1.0)
    graph.node("Clip", [ramp, zero, one], graph.output("trust"))
