# SPDX-License-Identifier: Apache-2.0
"""A scalar tanh network with a quadratic part, differentiated twice in the inputs, once in weights.

    N(u) = s·φ(u) + MLP(u),    φ(u) = (u_i; u_i u_j for i ≤ j but y),    u = (pose − centre)/half_range.

The quadratic carries most of what the surfaces' shape makes of a pose: the network need only learn
the rest. y enters φ by itself alone: since the MLP is bounded, N then falls for ever as the femur
is raised, and no contact can appear in the air.

:func:`second_order_pass` is the one place that differentiates it. Forward mode carries the tangents
∂h_l/∂u through the layers; back-propagation gives δ_l = ∂N/∂z_l; its own tangents
∂δ_l/∂u = ∂²N/∂z_l∂u give the Hessian, and with them the derivative of the gradient with respect to
the weights Θ_l = [W_l | b_l], whose input is a_l = (h_{l−1}, 1):

    ∂(∂N/∂u_k)/∂Θ_l = (∂δ_l/∂u_k) ⊗ a_l + δ_l ⊗ (∂a_l/∂u_k).

Reference: Pearlmutter (1994), Neural Computation 6(1):147-160 (the tangent of back-propagation).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import torch
from torch import Tensor

from condyle.conventions import POSE_COLUMNS
from condyle.training.networks import MinMaxMap, TanhMlp

_Y = POSE_COLUMNS.index("y")


@dataclass(frozen=True)
class SecondOrderPass:
    """What a pass over n rows of d mapped inputs leaves behind, layer by layer.

    Attributes:
        value: N (n,).
        gradient: ∂N/∂u (n, d).
        layer_inputs: a_l (n, p_l), the one of the bias included.
        input_tangents: ∂h_{l−1}/∂u (n, d, p_l − 1).
        deltas: δ_l (n, d_l).
        delta_tangents: ∂δ_l/∂u (n, d, d_l).
    """

    value: Tensor
    gradient: Tensor
    layer_inputs: list[Tensor]
    input_tangents: list[Tensor]
    deltas: list[Tensor]
    delta_tangents: list[Tensor]

    def hessian(self, first_weights: Tensor, coefficients: Tensor) -> Tensor:
        """∂²N/∂u² (n, d, d), from the first layer's weights (d_1, d) and s."""
        width = first_weights.shape[1]
        return self.delta_tangents[0] @ first_weights + quadratic_matrix(coefficients, width)


class PotentialNetwork:
    """N(u) with its parameters in one vector: Θ_1, Θ_2, … row by row, then s.

    Args:
        input_map: Map of the six pose coordinates to about [-1, 1].
        hidden: Width of every hidden layer.
        parameters: (P,) float64; zeros if not given.
    """

    def __init__(
        self, input_map: MinMaxMap, hidden: tuple[int, ...], parameters: Tensor | None = None
    ) -> None:
        self.input_map = input_map
        self.hidden = tuple(hidden)
        widths = (input_map.centre.numel(), *self.hidden, 1)
        self._shapes = [(out, into + 1) for into, out in pairwise(widths)]
        if parameters is None:
            parameters = torch.zeros(self.n_parameters, dtype=torch.float64)
        self.parameters = parameters

    @property
    def n_parameters(self) -> int:
        """P."""
        layers = sum(rows * columns for rows, columns in self._shapes)
        return int(layers + n_terms(len(self.input_map.centre)))

    @property
    def widths(self) -> tuple[int, ...]:
        """Layer widths, inputs first, the scalar last."""
        return (self.input_map.centre.numel(), *self.hidden, 1)

    def split(self, parameters: Tensor) -> tuple[list[Tensor], Tensor]:
        """(Θ_l (d_l, p_l) of every layer, s (n_terms,)), views of ``parameters``."""
        layers, start = [], 0
        for rows, columns in self._shapes:
            layers.append(parameters[start : start + rows * columns].view(rows, columns))
            start += rows * columns
        return layers, parameters[start:]

    def value(self, pose: Tensor) -> Tensor:
        """N (n,) at poses (n, 6) [m, rad]."""
        return network_value(*self.split(self.parameters), self.input_map(pose))

    def second_order(self, pose: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """N (n,), ∂N/∂pose (n, 6) and ∂²N/∂pose² (n, 6, 6) at poses (n, 6)."""
        layers, coefficients = self.split(self.parameters)
        done = second_order_pass(layers, coefficients, self.input_map(pose))
        scale = 1.0 / self.input_map.half_range
        hessian = done.hessian(layers[0][:, :-1], coefficients) * scale[:, None] * scale
        return done.value, done.gradient * scale, hessian

    @classmethod
    def from_mlp(cls, network: TanhMlp, coefficients: Tensor, shift: float) -> PotentialNetwork:
        """s·φ(u) + shift + the network's output."""
        layers = network.affine_layers()
        # The network's own output map becomes part of its last layer.
        weight, bias = layers[-1]
        half_range, centre = network.output_map.half_range, network.output_map.centre
        layers[-1] = (half_range[:, None] * weight, half_range * bias + centre + shift)
        blocks = [torch.cat([w, b[:, None]], dim=1).reshape(-1) for w, b in layers]
        return cls(network.input_map, network.hidden, torch.cat([*blocks, coefficients]))

    def folded(self) -> tuple[list[tuple[Tensor, Tensor]], Tensor, Tensor, float]:
        """Layers (W, b), and A (6, 6) symmetric, b (6,), c of the quadratic pᵀAp + b·p + c.

        The input map is folded in: pose in SI in, N out.
        """
        layers, coefficients = self.split(self.parameters)
        centre, half_range = self.input_map.centre, self.input_map.half_range
        pairs = [(layer[:, :-1], layer[:, -1]) for layer in layers]
        weight, bias = pairs[0]
        weight = weight / half_range
        pairs[0] = (weight, bias - weight @ centre)
        matrix = quadratic_matrix(coefficients, len(centre)) / (
            2 * torch.outer(half_range, half_range)
        )
        slope = coefficients[: len(centre)] / half_range
        constant = float(centre @ matrix @ centre - slope @ centre)
        return pairs, matrix, slope - 2 * matrix @ centre, constant

    def to_dict(self) -> dict[str, Any]:
        """Plain values and tensors, for a file."""
        return {
            "hidden": list(self.hidden),
            "input_centre": self.input_map.centre,
            "input_half_range": self.input_map.half_range,
            "parameters": self.parameters.clone(),
        }

    @classmethod
    def from_dict(cls, values: dict[str, Any]) -> PotentialNetwork:
        """Inverse of :meth:`to_dict`."""
        input_map = MinMaxMap(values["input_centre"], values["input_half_range"])
        return cls(input_map, tuple(values["hidden"]), values["parameters"])


def n_terms(width: int) -> int:
    """Length of φ(u) for u of ``width`` components."""
    return width + len(_pairs(width)[0])


def _pairs(width: int) -> tuple[Tensor, Tensor]:
    """I and j of the products in φ."""
    i, j = torch.triu_indices(width, width)
    keep = (i != _Y) & (j != _Y)
    return i[keep], j[keep]


def quadratic_terms(inputs: Tensor) -> Tensor:
    """φ(u) (n, n_terms) at u (n, d)."""
    i, j = _pairs(inputs.shape[1])
    return torch.cat([inputs, inputs[:, i] * inputs[:, j]], dim=1)


def quadratic_tangents(inputs: Tensor) -> Tensor:
    """∂φ/∂u_k (n, d, n_terms) at u (n, d)."""
    rows, width = inputs.shape
    i, j = _pairs(width)
    one = torch.eye(width, dtype=inputs.dtype)
    products = inputs[:, None, j] * one[:, i] + inputs[:, None, i] * one[:, j]
    return torch.cat([one.expand(rows, width, width), products], dim=2)


def quadratic_matrix(coefficients: Tensor, width: int) -> Tensor:
    """∂²(s·φ)/∂u² (d, d) of coefficients s (n_terms,)."""
    i, j = _pairs(width)
    matrix = coefficients.new_zeros(width, width)
    matrix[i, j] = coefficients[width:]
    return matrix + matrix.T


def _quadratic_gradient(coefficients: Tensor, inputs: Tensor) -> Tensor:
    """∂(s·φ)/∂u (n, d)."""
    width = inputs.shape[1]
    return coefficients[:width] + inputs @ quadratic_matrix(coefficients, width)


def network_value(layers: list[Tensor], coefficients: Tensor, inputs: Tensor) -> Tensor:
    """N (n,) at mapped inputs (n, d)."""
    hidden = inputs
    for layer in layers[:-1]:
        hidden = torch.tanh(hidden @ layer[:, :-1].T + layer[:, -1])
    last = layers[-1]
    rest = quadratic_terms(inputs) @ coefficients
    return (hidden @ last[:, :-1].T)[:, 0] + last[0, -1] + rest


def value_and_gradient(
    layers: list[Tensor], coefficients: Tensor, inputs: Tensor
) -> tuple[Tensor, Tensor]:
    """N (n,) and ∂N/∂u (n, d) at mapped inputs (n, d), by back-propagation."""
    hidden, activations = inputs, []
    for layer in layers[:-1]:
        hidden = torch.tanh(hidden @ layer[:, :-1].T + layer[:, -1])
        activations.append(hidden)
    last = layers[-1]
    value = (hidden @ last[:, :-1].T)[:, 0] + last[0, -1]
    value = value + quadratic_terms(inputs) @ coefficients
    delta = last[:, :-1].expand(len(inputs), -1)
    for layer, hidden in zip(reversed(layers[:-1]), reversed(activations), strict=True):
        delta = (delta * (1 - hidden * hidden)) @ layer[:, :-1]
    return value, delta + _quadratic_gradient(coefficients, inputs)


def second_order_pass(
    layers: list[Tensor], coefficients: Tensor, inputs: Tensor
) -> SecondOrderPass:
    """See the module docstring; ``inputs`` (n, d) are mapped."""
    rows, width = inputs.shape
    one = inputs.new_ones(rows, 1)
    hidden = inputs
    tangent = torch.eye(width, dtype=inputs.dtype, device=inputs.device).expand(rows, width, width)
    layer_inputs, input_tangents = [], []
    bends: list[tuple[Tensor, Tensor]] = []  # 1 − h² (n, d_l), its tangent (n, d, d_l)
    for layer in layers:
        layer_inputs.append(torch.cat([hidden, one], dim=1))
        input_tangents.append(tangent)
        hidden = layer_inputs[-1] @ layer.T
        tangent = tangent @ layer[:, :-1].T
        if len(layer_inputs) < len(layers):
            hidden = torch.tanh(hidden)
            bend = 1 - hidden * hidden
            sums_tangent = tangent
            tangent = sums_tangent * bend[:, None, :]
            bends.append((bend, -2 * hidden[:, None, :] * tangent))
    deltas = [inputs.new_ones(rows, 1)]
    delta_tangents = [inputs.new_zeros(rows, width, 1)]
    for layer, (bend, bend_tangent) in zip(reversed(layers[1:]), reversed(bends), strict=True):
        weights = layer[:, :-1]
        back, back_tangent = deltas[0] @ weights, delta_tangents[0] @ weights
        deltas.insert(0, back * bend)
        delta_tangents.insert(0, back_tangent * bend[:, None, :] + back[:, None, :] * bend_tangent)
    return SecondOrderPass(
        hidden[:, 0] + quadratic_terms(inputs) @ coefficients,
        tangent[:, :, 0] + _quadratic_gradient(coefficients, inputs),
        layer_inputs,
        input_tangents,
        deltas,
        delta_tangents,
    )
