# SPDX-License-Identifier: Apache-2.0
"""The potential surrogate as an ONNX graph, node by node: energy's gradient and Hessian, wrench.

    N = MLP(p) + ½ p·(g_q + b) + c,   g_q = 2Ap + b      (both sides at once, block-diagonal weights)
    g = ∂N/∂p = W_1ᵀδ_1 + g_q,        δ_L = w ∘ s_L, δ_l = (W_{l+1}ᵀ δ_{l+1}) ∘ s_l, s = 1 − h²
    H = ∂²N/∂p² = Σ_l S_lᵀ diag(−2 h_l δ_l) S_l + 2A,    S_l = ∂(sums of layer l)/∂p
    Q = −f g,   ∂Q/∂p = −f H − f' g gᵀ,    f = c p N^(p−1), f' = c p (p−1) N^(p−2)

The Hessian in this form needs the tangents S_l forwards but no tangents of the way back; S_1 = W_1
is constant, so the first layer's part is one product with the constants W_1k·W_1m. S is (1, 6, N,
width): the slope (N, width) then multiplies it without a reshape.

The wrench is R·Q with R = G⁻ᵀ (condyle.training.generalised_force), whose entries are 0, ±1 and
products of one of (sin θx, cos θx) with one of (1, tan θy, 1/cos θy); its derivatives by θx and θy
add (1/cos²θy, tan θy/cos θy). Times cos²θy each of these products is a sum of sines of
a·θx + k·θy + φ, |k| ≤ 2: eleven sines and one product with constants give R and both derivatives.
Cosines are sines, for runtimes that lack Cos in float64. ∂wrench/∂p is then one product,

    [R | ∂R/∂θx | ∂R/∂θy] · [∂Q/∂p ; Q at column θx ; Q at column θy].
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from condyle.conventions import POSE_COLUMNS
from condyle.training.onnx_graph import (
    N_LOADS,
    N_POSE,
    N_SIDES,
    Array,
    GraphBuilder,
    Layers,
    add_gate,
    add_gated,
    add_slope,
    side_by_side,
)
from condyle.training.potential import PotentialSurrogate, SideEnergy

_NET = "energy"
_THETA_X, _THETA_Y = POSE_COLUMNS.index("theta_x"), POSE_COLUMNS.index("theta_y")
#: Multiples k of θy in the sines; for each the sine, then the cosine of θx + k·θy.
_MULTIPLES = (-2, -1, 0, 1, 2)
_N_SINES = 2 * len(_MULTIPLES) + 1


def add_potential(graph: GraphBuilder, surrogate: PotentialSurrogate, *, stiffness: bool) -> None:
    """Adds ``wrench`` and, if asked for, ``stiffness``, from the pose."""
    sides = [_folded(side, graph.origin) for side in surrogate.sides]
    joined = side_by_side([side.layers for side in sides], shared=N_POSE)
    hidden = _add_hidden(graph, joined[:-1])
    deltas = _add_deltas(graph, hidden, joined)
    quadratic = np.concatenate([2 * side.matrix for side in sides], axis=1)
    gradient_of_quadratic = graph.node(
        "Gemm",
        [
            graph.pose,
            graph.constant("energy.curvature", quadratic),
            graph.constant("energy.steepness", np.concatenate([side.slope for side in sides])),
        ],
        "energy.quadratic_gradient",
    )
    depth = _add_depth(graph, hidden[-1], gradient_of_quadratic, joined[-1], sides)
    # Each side's neurons lead back to six columns of their own.
    first = joined[0][0]
    own = np.zeros((first.shape[1], N_SIDES * N_POSE))
    start = 0
    for index, side in enumerate(sides):
        stop = start + side.layers[0][0].shape[1]
        own[start:stop, index * N_POSE : (index + 1) * N_POSE] = first[:, start:stop].T
        start = stop
    own_name = graph.constant("energy.back_to_pose", own)
    flat = graph.node("Gemm", [deltas[0], own_name, gradient_of_quadratic], "energy.flat_gradient")
    gradient = graph.reshape(flat, "energy.gradient", [-1, N_SIDES, N_POSE], "side_shape")
    curve, force = _add_derivatives_of_power(graph, surrogate.sides, depth, stiffness=stiffness)
    by_side = graph.reshape(force, "energy.side_force", [-1, N_SIDES, 1], "per_side")
    generalised = graph.node("Mul", [gradient, by_side], "generalised_force")
    over_cosine = _add_angles(graph)
    turn = _add_turn(graph, over_cosine, "turn", _turn().transpose(0, 2, 1), [-1, N_LOADS, N_POSE])
    ungated = graph.node("MatMul", [generalised, turn], "ungated_wrench")
    add_gated(graph, ungated, add_gate(graph, depth), "wrench")
    if curve is not None:
        hessian = _add_hessian(graph, hidden, deltas, joined, sides)
        derivative = _add_force_derivative(graph, hessian, gradient, by_side, curve)
        _add_stiffness(graph, over_cosine, generalised, derivative)


@dataclass(frozen=True)
class _Side:
    """One side's N in terms of the pose relative to the graph's origin.

    Attributes:
        layers: (Wᵀ, b) of the network; the last bias holds c too.
        matrix: A (6, 6).
        slope: b (6,).
    """

    layers: Layers
    matrix: Array
    slope: Array


def _folded(side: SideEnergy, origin: Array) -> _Side:
    pairs, matrix, slope, constant = side.network.folded()
    layers = [(weight.T.numpy(), bias.numpy()) for weight, bias in pairs]
    weight, bias = layers[0]
    layers[0] = (weight, bias + origin @ weight)
    a, b = matrix.numpy(), slope.numpy()
    weight, bias = layers[-1]
    layers[-1] = (weight, bias + (constant + b @ origin + origin @ a @ origin))
    return _Side(layers, a, b + 2 * a @ origin)


def _add_hidden(graph: GraphBuilder, layers: Layers) -> list[str]:
    """Adds the hidden layers of both sides; returns h_l (N, width)."""
    hidden, inputs = [], graph.pose
    for index, (weight, bias) in enumerate(layers, start=1):
        weight_name = graph.constant(f"{_NET}.weight_{index}", weight)
        bias_name = graph.constant(f"{_NET}.bias_{index}", bias)
        sums = graph.node("Gemm", [inputs, weight_name, bias_name], f"{_NET}.sums_{index}")
        inputs = graph.node("Tanh", [sums], f"{_NET}.hidden_{index}")
        hidden.append(inputs)
    return hidden


def _add_deltas(graph: GraphBuilder, hidden: list[str], layers: Layers) -> list[str]:
    """Adds the way back; returns δ_l (N, width)."""
    # The two sides' N do not mix, so that one seed serves both: the derivative of their sum.
    back = graph.constant(f"{_NET}.last_row", layers[-1][0].sum(axis=1))
    deltas: list[str] = []
    for index in range(len(hidden), 0, -1):
        slope = add_slope(graph, _NET, index, hidden[index - 1])
        deltas.insert(0, graph.node("Mul", [slope, back], f"{_NET}.delta_{index}"))
        if index > 1:
            weight = f"{_NET}.weight_{index}"
            back = graph.node("Gemm", [deltas[0], weight], f"{_NET}.back_{index - 1}", transB=1)
    return deltas


def _add_depth(
    graph: GraphBuilder, hidden: str, gradient: str, last: tuple[Array, Array], sides: list[_Side]
) -> str:
    """Adds N (N, 2)."""
    twice = graph.node("Concat", [graph.pose, graph.pose], "energy.pose_by_side", axis=1)
    products = graph.node("Mul", [gradient, twice], "energy.products")
    terms = graph.node("Concat", [hidden, products, graph.pose], "energy.terms", axis=1)
    half = np.kron(np.eye(N_SIDES), np.full((N_POSE, 1), 0.5))
    slopes = np.stack([0.5 * side.slope for side in sides], axis=1)
    weight = graph.constant("energy.last_weight", np.concatenate([last[0], half, slopes]))
    bias = graph.constant("energy.last_bias", last[1])
    return graph.node("Gemm", [terms, weight, bias], "energy.depth")


def _add_derivatives_of_power(
    graph: GraphBuilder, sides: tuple[SideEnergy, SideEnergy], depth: str, *, stiffness: bool
) -> tuple[str | None, str]:
    """Adds −f' (if needed) and −f, both (N, 2); not numbers where N < 0: gated later."""
    power = np.array([side.power for side in sides])
    scale = np.array([side.scale for side in sides])
    exponent = graph.constant("energy.exponent", power - 2)
    bend = graph.node("Pow", [depth, exponent], "energy.bend")
    factor = graph.constant("energy.force_factor", -scale * power)
    rise = graph.node("Mul", [bend, depth], "energy.rise")
    force = graph.node("Mul", [rise, factor], "energy.force")
    if not stiffness:
        return None, force
    factor = graph.constant("energy.curve_factor", -scale * power * (power - 1))
    return graph.node("Mul", [bend, factor], "energy.curve"), force


def _add_hessian(
    graph: GraphBuilder, hidden: list[str], deltas: list[str], layers: Layers, sides: list[_Side]
) -> str:
    """Adds H (N, 2, 6, 6)."""
    bends = [
        graph.node("Mul", [delta, h], f"{_NET}.bend_{index}")
        for index, (delta, h) in enumerate(zip(deltas, hidden, strict=True), start=1)
    ]
    first = layers[0][0]
    # -2 belongs to the derivative of tanh's slope.
    pairs = -2 * (first[:, None, :] * first[None, :, :])
    blocks = [side.layers[0][0].shape[1] for side in sides]
    owner = np.repeat(np.arange(N_SIDES), blocks)
    own = np.stack([pairs * (owner == side) for side in range(N_SIDES)])
    width = N_SIDES * N_POSE * N_POSE
    flat = graph.node(
        "Gemm",
        [
            bends[0],
            graph.constant("energy.first_pairs", own.reshape(width, -1).T),
            graph.constant(
                "energy.constant_pairs", np.array([2 * s.matrix for s in sides]).ravel()
            ),
        ],
        "energy.flat_hessian",
    )
    shape = [-1, N_SIDES, N_POSE, N_POSE]
    hessian = graph.reshape(flat, "energy.first_hessian", shape, "matrix_shape")
    if len(hidden) == 1:
        return hessian
    return graph.node("Add", [hessian, _add_later_layers(graph, bends, layers, sides)], "hessian")


def _add_later_layers(
    graph: GraphBuilder, bends: list[str], layers: Layers, sides: list[_Side]
) -> str:
    """Adds the Hessian's part (N, 2, 6, 6) of the hidden layers after the first."""
    seed = layers[0][0][None, :, None, :]
    tangent = graph.constant("energy.pose_tangent", seed)
    tangents = []
    for index in range(2, len(bends) + 1):
        slope = f"{_NET}.slope_{index - 1}"
        tangent = graph.node("Mul", [tangent, slope], f"{_NET}.tangent_{index - 1}")
        weight = f"{_NET}.weight_{index}"
        tangent = graph.node("MatMul", [tangent, weight], f"{_NET}.sums_tangent_{index}")
        tangents.append(tangent)
    weights = bends[1:]
    tangent, weight = tangents[0], weights[0]
    if len(tangents) > 1:
        tangent = graph.node("Concat", tangents, "energy.tangents", axis=3)
        weight = graph.node("Concat", weights, "energy.bends", axis=1)
    left = graph.node("Transpose", [tangent], "energy.rows", perm=[2, 0, 1, 3])
    right = graph.node("Transpose", [tangent], "energy.columns", perm=[2, 0, 3, 1])
    owner = np.concatenate(
        [
            np.repeat(np.arange(N_SIDES), [side.layers[index][0].shape[1] for side in sides])
            for index in range(1, len(bends))
        ]
    )
    mask = -2.0 * (owner == np.arange(N_SIDES)[:, None])
    row = graph.reshape(weight, "energy.bend_row", [-1, 1, 1, len(owner)], "bend_shape")
    mask_name = graph.constant("energy.bend_of_side", mask[:, None, :])
    weight = graph.node("Mul", [row, mask_name], "energy.bend_by_side")
    left = graph.node("Mul", [left, weight], "energy.weighted_rows")
    return graph.node("MatMul", [left, right], "energy.later_hessian")


def _add_force_derivative(
    graph: GraphBuilder, hessian: str, gradient: str, force: str, curve: str
) -> str:
    """Adds ∂Q/∂p (N, 2, 6, 6); ``force`` is −f (N, 2, 1), ``curve`` −f' (N, 2)."""
    force = graph.node("Unsqueeze", [force, graph.integers("axis_3", [3])], "energy.matrix_force")
    curve = graph.reshape(curve, "energy.matrix_curve", [-1, N_SIDES, 1, 1], "per_matrix")
    column = graph.node("Unsqueeze", [gradient, "axis_3"], "energy.gradient_column")
    row = graph.node("Unsqueeze", [gradient, "axis_2"], "energy.gradient_row")
    outer = graph.node("Mul", [column, row], "energy.outer")
    bent = graph.node("Mul", [outer, curve], "energy.bent_outer")
    stretched = graph.node("Mul", [hessian, force], "energy.scaled_hessian")
    return graph.node("Add", [stretched, bent], "generalised_stiffness")


def _add_stiffness(
    graph: GraphBuilder, over_cosine: str, generalised: str, derivative: str
) -> None:
    """Adds ``stiffness`` from Q (N, 2, 6) and ∂Q/∂p (N, 2, 6, 6)."""
    spread = np.zeros((N_POSE, 2 * N_POSE, N_POSE))
    for index, angle in enumerate((_THETA_X, _THETA_Y)):
        spread[np.arange(N_POSE), index * N_POSE + np.arange(N_POSE), angle] = 1.0
    spread_name = graph.constant("energy.angle_columns", spread.reshape(N_POSE, -1))
    columns = graph.node("MatMul", [generalised, spread_name], "energy.flat_columns")
    shape = [-1, N_SIDES, 2 * N_POSE, N_POSE]
    columns = graph.reshape(columns, "energy.force_columns", shape, "column_shape")
    stacked = graph.node("Concat", [derivative, columns], "energy.stacked", axis=2)
    all_turns = np.concatenate([_turn(), _turn_by_x(), _turn_by_y()], axis=2)
    turns = _add_turn(graph, over_cosine, "turns", all_turns, [-1, 1, N_LOADS, 3 * N_POSE])
    ungated = graph.node("MatMul", [turns, stacked], "ungated_stiffness")
    lifted = graph.node("Unsqueeze", ["lifted", "axis_3"], "lifted_rows")
    add_gated(graph, ungated, lifted, "stiffness")


def _add_angles(graph: GraphBuilder) -> str:
    """Adds sin and cos of θx + k·θy, over cos²θy (N, 11); the last is 1/cos θy."""
    matrix, phase = np.zeros((N_POSE, _N_SINES)), np.zeros(_N_SINES)
    for index, k in enumerate(_MULTIPLES):
        matrix[_THETA_X, 2 * index : 2 * index + 2] = 1.0
        matrix[_THETA_Y, 2 * index : 2 * index + 2] = k
        phase[2 * index + 1] = np.pi / 2
    matrix[_THETA_Y, -1], phase[-1] = 1.0, np.pi / 2
    phase += graph.origin @ matrix
    names = [graph.constant("angle.multiples", matrix), graph.constant("angle.phases", phase)]
    sines = graph.node("Sin", [graph.node("Gemm", [graph.pose, *names], "angles")], "sines")
    last = [
        graph.integers("angle.last", [_N_SINES - 1]),
        graph.integers("angle.end", [_N_SINES]),
        graph.integers("axis_1", [1]),
    ]
    cosine = graph.node("Slice", [sines, *last], "cosine_theta_y")
    square = graph.node("Mul", [cosine, cosine], "cosine_squared")
    return graph.node("Div", [sines, square], "sines_over_cosine")


def _add_turn(
    graph: GraphBuilder, over_cosine: str, name: str, matrix: Array, shape: list[int]
) -> str:
    """Adds a matrix that is linear in the sines; ``matrix`` (1 + 11, rows, columns), constant first."""
    weight = graph.constant(f"{name}.weight", matrix[1:].reshape(_N_SINES, -1))
    bias = graph.constant(f"{name}.bias", matrix[0].reshape(-1))
    flat = graph.node("Gemm", [over_cosine, weight, bias], f"{name}.flat")
    return graph.reshape(flat, name, shape, f"{name}.shape")


def _sine(k: int) -> Array:
    """sin(θx + k·θy) in terms of [1, sines]."""
    return _unit(1 + 2 * _MULTIPLES.index(k))


def _cosine(k: int) -> Array:
    return _unit(2 + 2 * _MULTIPLES.index(k))


def _unit(index: int) -> Array:
    unit: Array = np.eye(1 + _N_SINES)[index]
    return unit


#: sin θx and cos θx times a power of cos θy or sin θy, in terms of [1, sines], where the sines are
#: over cos²θy: what remains is named.
_S = _sine(0) / 2 + (_sine(2) + _sine(-2)) / 4
_C = _cosine(0) / 2 + (_cosine(2) + _cosine(-2)) / 4
_S_TAN = (_cosine(-2) - _cosine(2)) / 4
_C_TAN = (_sine(2) - _sine(-2)) / 4
_S_SEC = (_sine(1) + _sine(-1)) / 2
_C_SEC = (_cosine(1) + _cosine(-1)) / 2
_S_SEC_SEC, _C_SEC_SEC = _sine(0), _cosine(0)
_S_TAN_SEC = (_cosine(-1) - _cosine(1)) / 2
_C_TAN_SEC = (_sine(1) - _sine(-1)) / 2


def _matrix(moments: list[list[Array]]) -> Array:
    """(1 + 11, 6, 6) of the moments' (My, Mz) rows by (Qθx, Qθy, Qθz); the rest zero."""
    matrix = np.zeros((1 + _N_SINES, N_LOADS, N_POSE))
    for row, entries in enumerate(moments, start=4):
        for column, entry in enumerate(entries, start=3):
            matrix[:, row, column] = entry
    return matrix


def _turn() -> Array:
    """R: Mx = −Qθx, My = −s·t·Qθx − c·Qθy − s·i·Qθz, Mz = −c·t·Qθx + s·Qθy − c·i·Qθz."""
    matrix = _matrix([[-_S_TAN, -_C, -_S_SEC], [-_C_TAN, _S, -_C_SEC]])
    matrix[0, [0, 1, 2], [0, 1, 2]] = 1.0
    matrix[0, 3, 3] = -1.0
    return matrix


def _turn_by_x() -> Array:
    return _matrix([[-_C_TAN, _S, -_C_SEC], [_S_TAN, _C, _S_SEC]])


def _turn_by_y() -> Array:
    zero = np.zeros(1 + _N_SINES)
    return _matrix([[-_S_SEC_SEC, zero, -_S_TAN_SEC], [-_C_SEC_SEC, zero, -_C_TAN_SEC]])
