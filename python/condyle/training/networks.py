# SPDX-License-Identifier: Apache-2.0
"""Tanh multilayer perceptron whose input and output scaling is part of the network: SI in, SI out.

    y = centre_y + halfrange_y · N((x − centre_x) / halfrange_x),   N: tanh hidden layers, linear
    output,

with centre and half range such that the training data map to [-1, 1] (MATLAB ``mapminmax``).
Everything is float64, since the derivative of the network goes into a Newton solver.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import torch
from torch import Tensor, nn


class MinMaxMap(nn.Module):  # type: ignore[misc]
    """The affine map of each column's [min, max] to [-1, 1]; a constant column maps to 0.

    Args:
        centre: (d,) float64.
        half_range: (d,) float64, positive.
    """

    centre: Tensor
    half_range: Tensor

    def __init__(self, centre: Tensor, half_range: Tensor) -> None:
        super().__init__()
        self.register_buffer("centre", centre.to(torch.float64).clone())
        self.register_buffer("half_range", half_range.to(torch.float64).clone())

    @classmethod
    def from_data(cls, values: Tensor) -> MinMaxMap:
        """The map for data (n, d)."""
        low, high = values.min(dim=0).values, values.max(dim=0).values
        half_range = (high - low) / 2
        # A constant column carries no information; 1 keeps it finite and its units.
        half_range = torch.where(half_range > 0, half_range, torch.ones_like(half_range))
        return cls((high + low) / 2, half_range)

    def forward(self, values: Tensor) -> Tensor:
        """Mapped values (n, d)."""
        return (values - self.centre) / self.half_range

    def inverse(self, mapped: Tensor) -> Tensor:
        """Values in SI units (n, d)."""
        return self.centre + self.half_range * mapped


class TanhMlp(nn.Module):  # type: ignore[misc]
    """See the module docstring.

    Args:
        input_map: Map of the inputs (d_in columns).
        output_map: Map of the outputs (d_out columns).
        hidden: Width of every hidden layer, e.g. (30, 30, 30).
    """

    def __init__(
        self, input_map: MinMaxMap, output_map: MinMaxMap, hidden: tuple[int, ...]
    ) -> None:
        super().__init__()
        if not hidden or min(hidden) < 1:
            raise ValueError(
                f"hidden is {hidden}; at least one layer of at least one neuron is needed"
            )
        self.input_map = input_map
        self.output_map = output_map
        self.hidden = tuple(hidden)
        widths = self.widths
        self.layers = nn.ModuleList(
            nn.Linear(into, out, dtype=torch.float64) for into, out in pairwise(widths)
        )

    @property
    def widths(self) -> tuple[int, ...]:
        """Layer widths, inputs first, outputs last."""
        return (self.input_map.centre.numel(), *self.hidden, self.output_map.centre.numel())

    @property
    def n_parameters(self) -> int:
        """Number of weights and biases P."""
        return sum((into + 1) * out for into, out in pairwise(self.widths))

    def affine_layers(self) -> list[tuple[Tensor, Tensor]]:
        """(W (d_out, d_in), b (d_out,)) of each layer, in mapped units, detached."""
        pairs = []
        for layer in self.layers:
            assert isinstance(layer, nn.Linear)
            pairs.append((layer.weight.detach(), layer.bias.detach()))
        return pairs

    def folded_layers(self) -> list[tuple[Tensor, Tensor]]:
        """As :meth:`affine_layers`, with both maps folded in: SI in, SI out."""
        pairs = self.affine_layers()
        weight, bias = pairs[0]
        weight = weight / self.input_map.half_range
        pairs[0] = (weight, bias - weight @ self.input_map.centre)
        weight, bias = pairs[-1]
        half_range = self.output_map.half_range
        pairs[-1] = (half_range[:, None] * weight, half_range * bias + self.output_map.centre)
        return pairs

    def get_parameters(self) -> Tensor:
        """All parameters (P,), layer by layer, each [W | b] row by row; a copy."""
        return torch.cat(
            [torch.cat([w, b[:, None]], dim=1).reshape(-1) for w, b in self.affine_layers()]
        )

    def set_parameters(self, parameters: Tensor) -> None:
        """Inverse of :meth:`get_parameters`."""
        start = 0
        for layer in self.layers:
            assert isinstance(layer, nn.Linear)
            rows, columns = layer.out_features, layer.in_features + 1
            block = parameters[start : start + rows * columns].view(rows, columns)
            with torch.no_grad():
                layer.weight.copy_(block[:, :-1])
                layer.bias.copy_(block[:, -1])
            start += rows * columns

    def initialise(self, seed: int) -> None:
        """Seeded Nguyen-Widrow initialisation; small uniform weights for the output layer.

        A hidden neuron's active region is a slab of the inputs' cube [-1, 1]^d; magnitude
        0.7·n^(1/d) and evenly spread biases tile the cube with the n slabs of a layer (Nguyen &
        Widrow 1990, IJCNN 3:21-26).
        """
        generator = torch.Generator().manual_seed(seed)
        blocks = []
        for index, (weight, bias) in enumerate(self.affine_layers()):
            out, into = weight.shape
            draws = 2 * torch.rand(out, into, dtype=torch.float64, generator=generator) - 1
            if index + 1 < len(self.layers):
                magnitude = 0.7 * out ** (1 / into)
                weight = magnitude * draws / draws.norm(dim=1, keepdim=True)
                spread = torch.linspace(-1, 1, out, dtype=torch.float64) if out > 1 else bias * 0
                bias = magnitude * spread * torch.where(draws[:, 0] < 0, -1.0, 1.0).to(bias)
            else:
                weight, bias = draws / math.sqrt(into), torch.zeros_like(bias)
            blocks.append(torch.cat([weight, bias[:, None]], dim=1).reshape(-1))
        self.set_parameters(torch.cat(blocks))

    def forward(self, inputs: Tensor) -> Tensor:
        """Outputs (n, d_out) in SI units from inputs (n, d_in) in SI units."""
        hidden = self.input_map(inputs)
        for layer in self.layers[:-1]:
            hidden = torch.tanh(layer(hidden))
        outputs: Tensor = self.output_map.inverse(self.layers[-1](hidden))
        return outputs

    def forward_and_jacobian(self, inputs: Tensor) -> tuple[Tensor, Tensor]:
        """Outputs (n, d_out) and ∂outputs/∂inputs (n, d_out, d_in), SI, analytic (forward mode)."""
        *hidden_layers, (weight, bias) = self.folded_layers()
        hidden = inputs
        tangent: Tensor | None = None
        for layer_weight, layer_bias in hidden_layers:
            hidden = torch.tanh(hidden @ layer_weight.T + layer_bias)
            slope = (1 - hidden * hidden)[:, :, None]
            tangent = slope * (layer_weight if tangent is None else layer_weight @ tangent)
        assert tangent is not None
        return hidden @ weight.T + bias, weight @ tangent

    def to_dict(self) -> dict[str, Any]:
        """Plain values and tensors, for a file."""
        return {
            "hidden": list(self.hidden),
            "input_centre": self.input_map.centre,
            "input_half_range": self.input_map.half_range,
            "output_centre": self.output_map.centre,
            "output_half_range": self.output_map.half_range,
            "parameters": self.get_parameters(),
        }

    @classmethod
    def from_dict(cls, values: dict[str, Any]) -> TanhMlp:
        """Inverse of :meth:`to_dict`."""
        network = cls(
            MinMaxMap(values["input_centre"], values["input_half_range"]),
            MinMaxMap(values["output_centre"], values["output_half_range"]),
            tuple(values["hidden"]),
        )
        network.set_parameters(values["parameters"])
        return network
